//! Realigned boxes: every tight method against exact integers, bit for bit. Boxes of the loose
//! methods must contain the tight box.

mod real;
mod small;
mod ways;
