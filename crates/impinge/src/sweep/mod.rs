//! When moving things first touch.

mod exact;
mod floats;
mod impact;
mod linear;
mod polynomials;

pub use impact::Impact;
pub use linear::{edge_edge, vertex_face};
