//! Generators and oracles that the tests and benchmarks of impinge share.
//!
//! Nothing here uses the library that it judges: a mesh is two plain arrays, a pose is nine and three numbers, and every
//! decision is made in exact integers by methods that the library does not use. What is generated is the same, byte for
//! byte, on every machine: no platform mathematics library and no thread takes part.
//!
//! - [`generate`] makes meshes and tie-heavy pairs of triangles.
//! - [`oracle`](mod@oracle) answers which triangles intersect, slowly and exactly (feature `oracles`, on by default).

#[cfg(feature = "oracles")]
pub mod animation;
#[cfg(feature = "oracles")]
pub mod cases;
#[cfg(feature = "oracles")]
pub mod ccd;
#[cfg(feature = "oracles")]
pub mod env_rob;
pub mod generate;
#[cfg(feature = "oracles")]
pub mod oracle;

#[cfg(feature = "oracles")]
mod read_error;
mod scene;
mod thorough;

#[cfg(feature = "oracles")]
pub use read_error::ReadError;
pub use scene::{Affine, Mesh, Posed};
pub use thorough::rounds;
