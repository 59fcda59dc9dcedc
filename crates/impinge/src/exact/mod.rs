//! Exact decisions about closed triangles that two poses place in the world.
//!
//! The coordinates of a corner are the real numbers that its floats represent. Its image under a
//! pose is computed over the reals. A triangle is the convex hull of the images of its three
//! corners: a triangle, a segment or a point. Every decision is true of these sets. It is a
//! decision tree over signs of determinants, without constructed points, divisions or tolerances.
//! So the result depends neither on the order of the corners nor on the order of the triangles.
//! Each sign comes from the first of four tiers that is certain of it:
//!
//! - `filter`: floats in A's frame, with an error bound that holds for all poses;
//! - `fixed`: integers of one machine word, if both poses keep a common grid (equal poses,
//!   translations, quarter turns, mirrors);
//! - `wide`: integers of three machine words, which hold most posed corners in single precision;
//! - `unbounded`: integers of any size.
//!
//! The tests are `tests/it/exact_triangles.rs` and `tests/it/exact_crossing.rs`; the proofs are in
//! docs/notes/proof.md, L5 to L8.

mod contact;
mod corners;
mod crossing;
pub(crate) mod double_double;
mod exact_points;
mod fan;
mod feature;
mod filter;
mod fixed;
mod joint;
mod nearness;
mod placement;
mod point;
mod points;
mod shared;
mod supports;
mod triangles;
mod unbounded;
mod wide;

pub(crate) use contact::{Contact, contact};
pub use corners::Tier;
pub(crate) use crossing::joints;
pub use crossing::{Crossing, Endpoint, crossing};
pub use exact_points::Corners;
pub(crate) use fan::{EdgeLine, Fan};
pub use feature::Feature;
pub(crate) use joint::Joint;
pub use nearness::triangles_within;
pub(crate) use nearness::{NearParts, parts_within};
pub use placement::Placement;
pub(crate) use placement::world_point;
pub(crate) use point::{AxisRay, PosedPoint, Spot};
pub(crate) use points::{Plane, WidePlane, collinear, compare_along, image_down, image_up, orient2d, orient3d};
pub(crate) use shared::intersect_beyond_shared;
pub(crate) use supports::Supports;
pub use triangles::{Decision, decide_triangles, triangles_intersect};
