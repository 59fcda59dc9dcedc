//! When moving things first touch.

mod deforming;
mod exact;
mod floats;
mod impact;
mod linear;
mod motion;
mod polynomials;
mod rigid;
mod shapes;
mod solids;
mod span;

pub use deforming::{Deforming, Features, SweptContact};
pub use impact::Impact;
pub use linear::{edge_edge, vertex_face};
pub use motion::Motion;
pub use rigid::time_of_impact;
pub use shapes::time_of_impact_of_shapes;
pub use solids::time_of_impact_of_solids;
