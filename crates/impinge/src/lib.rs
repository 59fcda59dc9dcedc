//! Exact, fast collision detection for triangle meshes.

pub mod exact;
pub mod input;
pub mod math;
pub mod mesh;

pub use input::{InputError, InputErrorKind};
pub use math::Pose;
pub use mesh::Positions;
