//! Closed forms for points, segments, triangles and rays, in double precision with a proved error
//! bound.
//!
//! A closed form returns witnesses: one point of each set, and their distance. Three facts keep the
//! distance accurate for every input, including needles and points, for which textbook formulas
//! lose half of the digits:
//!
//! - The result is the distance of points in the sets, so it is never below the truth by more than
//!   its own rounding error.
//! - If a plane or a pair of lines is ill-conditioned, only the position along the flat direction
//!   is uncertain. One parameter comes from cross products, the other from a projection at the
//!   first. So the error *across* the flat direction is a few units of 2^-53 of the sizes, whatever
//!   the angle. The one cross product that is used as a divisor is computed with twice the digits.
//! - If the parameters fall outside their ranges, a part of the boundary is as near within the
//!   error bound. All parts of the boundary are always tried. So no parameter is ever clamped to a
//!   wrong place.
//!
//! Tests: `tests/it/distance/primitives.rs` and `rays.rs`. Benchmarks: `distance` and `rays`.

mod closest;
mod facing;
mod points;
mod products;
mod ray;
mod segments;
mod triangles;

pub use closest::ClosestPoints;
pub use points::{closest_on_segment, closest_on_triangle};
pub use ray::{RayCrossing, ray_triangle};
pub use segments::closest_on_segments;
pub use triangles::closest_on_triangles;

pub(crate) use closest::CLOSED_FORM_ERROR;
pub(crate) use facing::{side_along, unit_normal};
pub(crate) use points::{PreparedTriangle, point_segment, point_triangle};
pub(crate) use products::{accurate_cross, accurate_sum_of_products};
pub(crate) use triangles::{Witness, common_point, separation, triangle_triangle};
