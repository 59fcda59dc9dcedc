//! Fits volumes to points. Every volume encloses all points *by construction*, because its size is
//! computed last, from the points themselves, and rounded up.
//!
//! Points are in single or double precision, with coordinates below 2^128 in magnitude, like those
//! of a mesh. Every non-empty set has a volume of every kind: one point, duplicates, points on a
//! line, in a plane or on a sphere.
//!
//! Tests: `tests/it/volumes/fitted.rs`, `tests/it/volumes/spheres.rs`,
//! `tests/it/volumes/minimal.rs`. Benchmark: `volumes`.

mod capsule;
mod enclosing;
mod lozenge;
mod minimal;
mod moments;
mod obb;
mod spheres;

pub use super::points::Coordinate;
pub use capsule::capsule;
pub use lozenge::lozenge;
pub use minimal::minimal_sphere;
pub use obb::{FittedObb, obb, principal_obb};
pub use spheres::{FittedSphere, box_sphere, mean_sphere, principal_sphere, refined_sphere, ritter_sphere};
