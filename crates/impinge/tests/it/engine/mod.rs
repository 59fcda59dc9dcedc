//! The whole engine against known answers, independent oracles and laws: every vector unit that this processor has,
//! either mesh as the host, one thread and two.

mod animations;
mod cases;
mod curves;
mod digits;
mod interrupted;
mod judged;
mod laws;
mod moving;
mod parts;
mod real;
mod triangle_pairs;
mod ways;
