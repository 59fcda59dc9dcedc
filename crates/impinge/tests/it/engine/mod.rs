//! The whole engine against known answers, independent oracles and invariants.
//!
//! Queries run at every vector level of this processor, with either mesh as the host, on one thread
//! and on two.

mod animations;
mod budgets;
mod canceled;
mod cases;
mod common_points;
mod curves;
mod digits;
mod laws;
mod moving;
mod parts;
mod piles;
mod real;
mod shares;
mod triangle_pairs;
mod validation;
mod ways;
