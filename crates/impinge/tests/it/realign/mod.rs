//! Realigned boxes: all tight ways against exact integers, bit for bit; the others hold what the tight ones hold.

mod real;
mod small;
mod ways;
