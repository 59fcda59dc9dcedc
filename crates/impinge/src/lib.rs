//! Exact, fast collision detection for triangle meshes.
//!
//! # Features
//! - `all-levels` (default) compiles kernels for SSE4.2 and AVX-512 too.
//! - `mmap` (default) keeps large arrays in pages that the system is asked to make large.
//! - `glam`, `nalgebra`: `TryFrom` and `From` convert [`Pose`] and [`Positions`] from the types of that crate, and [`Pose`] to them.
//! - `serde`: a [`Pose`] is stored as the four rows of its matrix, and validated when it is read.
//! - `scalar` compiles every kernel without vectors too, for tests.

pub mod character;
pub mod convex;
pub mod exact;
pub mod hierarchy;
pub mod hull;
pub mod input;
mod interop;
pub mod math;
pub mod mesh;
pub mod partition;
pub mod primitive;
pub mod query;
pub mod shape;
pub mod simd;
pub mod storage;
pub mod sweep;
pub mod volume;
pub mod world;

pub use input::{InputError, InputErrorKind};
pub use math::Pose;
pub use mesh::{Mesh, Positions};
