//! Exact, fast collision detection for triangle meshes.
//!
//! With the feature `glam` or `nalgebra` a [`Pose`] and [`Positions`] are made of the types of that crate by `TryFrom` and `From`, and
//! turned into them.

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
pub mod simd;
pub mod storage;
pub mod sweep;
pub mod volume;
pub mod world;

pub use input::{InputError, InputErrorKind};
pub use math::Pose;
pub use mesh::{Mesh, Positions};
pub use shape::Shape;
