//! Exact, fast collision detection for triangle meshes and the shapes that stand in for them.
//!
//! The verbs are in [`query`]: whether two things intersect, where, how far apart they are, how deep they are in each other. Each takes
//! any two of meshes, solids, shapes and compounds, with a [`Pose`] each. [`query::batch`] asks them over many poses, [`scene`] about
//! many parts, [`sweep`] about things that move, and [`world`] about bodies from step to step.
//!
//! ```
//! use impinge::{Mesh, Pose, Shape, query};
//!
//! let triangle = Mesh::new([[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]])?;
//! let ball = Shape::sphere([0.0; 3], 0.5)?;
//! let above = Pose::from_translation([0.25, 0.25, 0.75])?;
//! assert!(!query::intersects(&triangle, ball.at(above)?));
//! let distance = query::distance(&triangle, ball.at(above)?);
//! assert!(distance.lower <= 0.25 && 0.25 <= distance.upper);
//! # Ok::<(), impinge::InputError>(())
//! ```
//!
//! # Features
//! - `all-levels` (default) compiles kernels for SSE4.2 and AVX-512 too.
//! - `mmap` (default) keeps large arrays in pages that the system is asked to make large.
//! - `glam`, `nalgebra`: `TryFrom` and `From` convert [`Pose`] and [`Positions`] from the types of that crate, and [`Pose`] to them.
//! - `serde`: a [`Pose`] is stored as the four rows of its matrix, and validated when it is read.
//! - `scalar` compiles every kernel without vectors too, for tests.

#![cfg_attr(docsrs, feature(doc_cfg))]

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
pub mod scene;
pub mod shape;
#[doc(hidden)]
pub mod simd;
#[doc(hidden)]
pub mod storage;
pub mod sweep;
pub mod volume;
pub mod world;

pub use input::{InputError, InputErrorKind};
pub use math::Pose;
pub use mesh::{Mesh, Positions};
pub use shape::Shape;
