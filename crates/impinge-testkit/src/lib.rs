//! Generators and oracles that the tests and benchmarks of impinge share.
//!
//! Nothing here uses the library that it judges: a mesh is two plain arrays, a pose is nine and three numbers, and every
//! decision is made in exact integers by methods that the library does not use. What is generated is the same, byte for
//! byte, on every machine: no platform mathematics library and no thread takes part.
//!
//! - [`generate`] makes meshes and tie-heavy pairs of triangles.
//! - [`oracle`] answers which triangles meet, slowly and exactly.

pub mod animation;
pub mod cases;
pub mod ccd;
pub mod env_rob;
pub mod generate;
pub mod oracle;

mod read_error;
mod scene;

pub use read_error::ReadError;
pub use scene::{Affine, Mesh, Posed};
