//! Volumes fitted to points: every one holds all of them *by construction*, its size being rounded up last of all, from
//! the points themselves.
//!
//! Points are taken in single or double precision, with coordinates below 2^128 in magnitude, as those of a mesh. Any set
//! but the empty one has a volume of every kind: one point, duplicates, points on a line, in a plane or on a sphere.

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
