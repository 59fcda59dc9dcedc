//! Bounding volumes: simple shapes that enclose geometry and are faster to test than the geometry
//! itself (*Notes on Real Time Collision Detection*, chapter 2; Ericson, chapter 4).
//!
//! | volume | bytes | shape |
//! |---|---|---|
//! | [`Aabb`] | 24 | axis-aligned box in single precision, for trees |
//! | [`MinMax`], [`MinWidths`], [`CenterRadius`] | 48 | the three forms of an axis-aligned box |
//! | [`PackedMinWidths`], [`PackedCenterRadius`] | 20, 16 | the last two with integer extents |
//! | [`BoundingSphere`] | 32 | center and radius |
//! | [`Capsule`] | 56 | a segment swept by a sphere |
//! | [`Lozenge`] | 80 | a rectangle swept by a sphere |
//! | [`Obb`] | 120 | oriented box |
//! | [`Kdop14`], [`Kdop18`], [`Kdop26`] | 112 to 208 | polytope with 7, 9 or 13 face pairs |
//!
//! Each volume is the set of *real* points that its numbers define, and rounding errs in one
//! direction only. Every conversion, union or moved copy encloses the exact result. A test reports
//! *apart* only if that is proved. [`fit`] builds volumes from points; [`Proxies`] holds one volume
//! of each kind around a convex hull.

mod aabb;
mod batch;
mod bounding;
mod capsule;
mod center_radius;
mod core;
pub mod fit;
mod implementations;
mod kdop;
mod lozenge;
mod min_max;
mod min_widths;
mod obb;
mod packed;
mod points;
mod proxies;
pub mod realign;
mod rigid;
mod round;
mod rounding;
mod sphere;

pub use aabb::Aabb;
pub use batch::AabbBatch;
pub use bounding::BoundingVolume;
pub use capsule::Capsule;
pub use center_radius::CenterRadius;
pub use kdop::{Kdop, Kdop14, Kdop18, Kdop26};
pub use lozenge::Lozenge;
pub use min_max::MinMax;
pub use min_widths::MinWidths;
pub use obb::Obb;
pub use packed::{PackedCenterRadius, PackedMinWidths, Steps};
pub use proxies::{Proxies, ProxyFlaw};
pub(crate) use rigid::stretch;
pub use round::{DistanceBounds, Proximity, Round};
pub use sphere::BoundingSphere;
