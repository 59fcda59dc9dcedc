//! Closed forms between points, segments, triangles and rays, in double precision with a proved bound of their error.
//!
//! A closed form returns witnesses: points of the two sets, and their distance. Three facts make the distance right
//! for every input, needles and points among them, where the formulas of textbooks lose half of the digits:
//!
//! - The value is that of points in the sets, so it is never below the truth by more than its own rounding.
//! - Where a plane or a pair of lines is ill-conditioned, so is only the place along the flat direction. One parameter
//!   comes from cross products, the other from a projection at the first, which leaves an error *across* the flat
//!   direction of a few units of 2^-53 of the sizes, whatever the angle. The one cross product that is divided by is
//!   computed with twice the digits.
//! - Where the parameters fall outside, a part of the boundary is nearer than the error, and parts of the boundary are
//!   always tried. So no parameter is ever clamped to where it does not belong.

mod closest;
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
pub(crate) use points::point_triangle;
pub(crate) use products::accurate_sum_of_products;
pub(crate) use triangles::{Witness, common_point, separation, triangle_triangle};
