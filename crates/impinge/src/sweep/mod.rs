//! When moving things first touch.

mod batch;
mod deforming;
mod exact;
mod floats;
mod impact;
mod linear;
mod motion;
mod polynomials;
mod rigid;
mod span;
mod time_of_impact;

pub use batch::times_of_impact;
pub use deforming::{Deforming, Features, SweptContact};
pub use impact::Impact;
pub use linear::{edge_edge, vertex_face};
pub use motion::Motion;
pub use time_of_impact::time_of_impact;
