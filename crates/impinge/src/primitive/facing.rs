//! The side to which a triangle turns its front, from which its corners are in counterclockwise
//! order.
//!
//! Tests: `tests/it/worlds/surfaces.rs`.

use super::ray::{ROUNDING, UNDERFLOW, certain_sign, permanent};
use crate::math::Sign;
use crate::math::direction::rounded_direction;
use crate::math::dyadic::{self, Dyadic};
use crate::math::vec3::{Vector, cross, dot, normalized, sub};

/// Maximum relative error of a normal that floats compute: 2^-40. Normals of thinner triangles are
/// computed exactly and rounded.
const MAX_ERROR: f64 = 1.0 / (1_u64 << 40) as f64;

/// Returns the unit normal of a triangle on its front side, or `None` if the triangle has no area.
///
/// # Accuracy
/// The direction is within 2^-38 of the exact one. The computed cross product of the edges is
/// wrong by at most [`ROUNDING`] times the sizes of its products in each component.
pub(crate) fn unit_normal(triangle: &[Vector; 3]) -> Option<Vector> {
    let [u, v] = [sub(&triangle[1], &triangle[0]), sub(&triangle[2], &triangle[0])];
    let normal = cross(&u, &v);
    let size = (0..3).fold(0.0_f64, |most, k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        most.max((u[i] * v[j]).abs() + (u[j] * v[i]).abs())
    });
    let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if ROUNDING * size + UNDERFLOW <= MAX_ERROR * largest {
        return normalized(&normal);
    }
    let edges = ExactEdges::of(triangle);
    normalized(&rounded_direction(&dyadic::cross(&edges.0, &edges.1))?)
}

/// Returns the sign of the inner product of a direction and the normal of a triangle's front side:
/// negative if the front faces against the direction, zero if the direction is in the plane or the
/// triangle has no area. Exact.
pub(crate) fn side_along(direction: &Vector, triangle: &[Vector; 3]) -> Sign {
    let [u, v] = [sub(&triangle[1], &triangle[0]), sub(&triangle[2], &triangle[0])];
    certain_sign(dot(&cross(&u, &v), direction), permanent(&u, &v, direction)).unwrap_or_else(|| {
        let edges = ExactEdges::of(triangle);
        dyadic::dot(&dyadic::cross(&edges.0, &edges.1), &direction.map(Dyadic::from_f64)).sign()
    })
}

/// The two edges of a triangle at its first corner, in exact numbers.
struct ExactEdges([Dyadic; 3], [Dyadic; 3]);

impl ExactEdges {
    fn of(triangle: &[Vector; 3]) -> Self {
        let [a, b, c] = triangle.each_ref().map(|corner| corner.map(Dyadic::from_f64));
        let edge = |to: &[Dyadic; 3]| std::array::from_fn(|k| &to[k] - &a[k]);
        Self(edge(&b), edge(&c))
    }
}
