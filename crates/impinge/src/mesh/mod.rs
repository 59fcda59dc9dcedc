//! Triangle meshes.

mod positions;

pub use positions::Positions;
