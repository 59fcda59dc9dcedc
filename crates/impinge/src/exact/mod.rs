//! Exact decisions about closed triangles that two poses place in the world.
//!
//! A corner is the real number triple that its floats are, and its image under a pose is taken over the reals; a
//! triangle is the convex hull of its three images, be that a triangle, a segment or a point. What is decided is the
//! truth about these sets. Every decision is a tree over signs of determinants (no constructed point, no division, no
//! tolerance), so it cannot depend on the order of corners or triangles. A sign comes from the first of four tiers
//! that is certain of it:
//!
//! - `filter`: floats in A's frame, with a bound of the error that holds whatever the poses are;
//! - `fixed`: integers of one machine word, where both poses keep a common grid: equal poses, translations, quarter
//!   turns, mirrors;
//! - `wide`: integers of three machine words, which hold most posed corners in single precision;
//! - `unbounded`: integers of any size.

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
pub(crate) use shared::meet_beyond_shared;
pub(crate) use supports::Supports;
pub use triangles::{Decision, decide_triangles, triangles_intersect};
