//! The points of two segments that are nearest to each other.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 5.1.9; ours departs as the head of `primitive` says. Let `u` and `v`
//! be the segments, at an angle θ, `w` from the start of the first to that of the second, and `n = u × v`. The first
//! parameter is `(w × v) · n / n²`, which rounding puts off by at most 8 units of 2^-53 of `|w| / (|u| sin θ)` and of
//! itself. Then the second is that of the nearest point of the second line, so that what is left of the first error
//! is its part across `v`, which is `sin θ` of it: 8 units of `|w|` and `|u|`, whatever θ is. Below 2^-50 the normal is
//! noise; the ends, which are tried in any case, are then within `|u| sin θ` of the nearest points.

use super::Vector;
use super::points::{along, point_segment};
use super::products::{accurate_cross, cross, dot, sub};
use super::triangles::{ClosestPoints, Scaled};

/// The points of two segments that are nearest to each other; either may be a point.
///
/// # Accuracy
/// As [`ClosestPoints`] says, parallel and nearly parallel segments included.
///
/// ```
/// use impinge::primitive::closest_on_segments;
///
/// let nearest = closest_on_segments(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &[[0.0, -1.0, 2.0], [0.0, 3.0, 2.0]]);
/// assert_eq!((nearest.point_a, nearest.point_b, nearest.distance), ([0.0; 3], [0.0, 0.0, 2.0], 2.0));
/// ```
#[must_use]
pub fn closest_on_segments(a: &[Vector; 2], b: &[Vector; 2]) -> ClosestPoints {
    let scaled = Scaled::new([a[0], a[1], b[0], b[1]]);
    let [p, q, r, s] = scaled.points;
    let (u, v) = (sub(&q, &p), sub(&s, &r));
    let (squared, t) = point_segment(&sub(&p, &r), &v);
    let mut nearest = (squared, p, along(&r, &v, t));
    let mut offer = |squared: f64, on_a: Vector, on_b: Vector| {
        if squared < nearest.0 {
            nearest = (squared, on_a, on_b);
        }
    };
    let (squared, t) = point_segment(&sub(&q, &r), &v);
    offer(squared, q, along(&r, &v, t));
    for end in [r, s] {
        let (squared, t) = point_segment(&sub(&end, &p), &u);
        offer(squared, along(&p, &u, t), end);
    }
    if let Some((squared, s, t)) = inner_points(&u, &v, dot(&v, &v), &sub(&r, &p)) {
        offer(squared, along(&p, &u, s), along(&r, &v, t));
    }
    let (squared, on_a, on_b) = nearest;
    scaled.back(squared, on_a, on_b)
}

/// The nearest points of two lines, where both are inside of their segments: the square of their distance and their
/// parameters. The segments are `u`, and `v` at `w` from it; `v_squared` is `v · v`.
#[inline(always)]
pub(super) fn inner_points(u: &Vector, v: &Vector, v_squared: f64, w: &Vector) -> Option<(f64, f64, f64)> {
    let normal = accurate_cross(u, v);
    let s = dot(&cross(w, v), &normal) / dot(&normal, &normal);
    let t = (s * dot(u, v) - dot(w, v)) / v_squared;
    // NaN, of parallel segments, is not inside.
    if !((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)) {
        return None;
    }
    let between: Vector = std::array::from_fn(|k| (w[k] - s * u[k]) + t * v[k]);
    Some((dot(&between, &between), s, t))
}
