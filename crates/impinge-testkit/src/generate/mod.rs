//! Generators of meshes and pairs of triangles, the same bytes on every machine.

pub mod bricks;
pub mod knots;
pub mod pairs;
pub mod poses;
pub mod solids;

mod rng;
mod trigonometry;

pub use rng::Rng;
pub use trigonometry::{cos, sin};
