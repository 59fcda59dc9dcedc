//! Generators and oracles for the tests and benchmarks of impinge.
//!
//! Nothing here uses the library under test: a mesh is two plain arrays, a pose is 9 + 3 numbers,
//! and every decision is made in exact integers by methods that the library does not use. Generated
//! data is the same, byte for byte, on every machine: neither the platform's mathematics library
//! nor threads are involved.
//!
//! - [`generate`] makes meshes and pairs of triangles with many ties.
//! - [`oracle`](mod@oracle) decides which triangles intersect, slowly and exactly (feature
//!   `oracles`, on by default).

#[cfg(feature = "oracles")]
pub mod animation;
#[cfg(feature = "oracles")]
mod baked;
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
pub use baked::correct_checksums;
#[cfg(feature = "oracles")]
pub use read_error::ReadError;
pub use scene::{Affine, Mesh, Posed};
pub use thorough::rounds;
