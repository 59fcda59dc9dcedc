//! The nearest point of a segment or a triangle to a point.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 5.1.2 and 5.1.5. Ours differs in two ways: in
//! how the foot within a face is found (see the head of `primitive`), and in that edges are always
//! tried.

use super::closest::{ClosestPoints, Scaled};
use super::products::accurate_cross;
use crate::math::vec3::{Vector, cross, dot, sub};

/// Returns the point of the segment from `segment[0]` to `segment[1]` that is nearest to `point`.
/// The segment may have length zero. In the result, A is the point and B the segment.
///
/// # Accuracy
/// As for [`ClosestPoints`].
///
/// ```
/// use impinge::primitive::closest_on_segment;
///
/// let nearest = closest_on_segment(&[1.0, 2.0, 0.0], &[[0.0; 3], [4.0, 0.0, 0.0]]);
/// assert_eq!((nearest.point_b, nearest.distance), ([1.0, 0.0, 0.0], 2.0));
/// ```
#[must_use]
pub fn closest_on_segment(point: &Vector, segment: &[Vector; 2]) -> ClosestPoints {
    let scaled = Scaled::new([*point, segment[0], segment[1]]);
    let [p, a, b] = scaled.points;
    let (squared, t) = point_segment(&sub(&p, &a), &sub(&b, &a));
    scaled.back(squared, p, along(&a, &sub(&b, &a), t))
}

/// Returns the point of a triangle that is nearest to `point`. The triangle may degenerate to a
/// segment or a point. In the result, A is the point and B the triangle.
///
/// # Accuracy
/// As for [`ClosestPoints`].
///
/// ```
/// use impinge::primitive::closest_on_triangle;
///
/// let triangle = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let nearest = closest_on_triangle(&[1.0, 1.0, 3.0], &triangle);
/// assert_eq!((nearest.point_b, nearest.distance), ([1.0, 1.0, 0.0], 3.0));
/// ```
#[must_use]
pub fn closest_on_triangle(point: &Vector, triangle: &[Vector; 3]) -> ClosestPoints {
    let scaled = Scaled::new([*point, triangle[0], triangle[1], triangle[2]]);
    let [p, a, b, c] = scaled.points;
    let (squared, foot) = point_triangle(&p, &[a, b, c]);
    scaled.back(squared, p, foot)
}

/// Returns the squared distance of a point from a segment, and the parameter of the nearest point,
/// from 0 to 1. `point` and `edge` are the point and the far end, both relative to the near end.
#[inline(always)]
pub(crate) fn point_segment(point: &Vector, edge: &Vector) -> (f64, f64) {
    let squared = dot(edge, edge);
    let along = dot(point, edge);
    // Written so that 0 / 0, which is NaN, gives zero.
    let t = if along > 0.0 && squared > 0.0 { (along / squared).min(1.0) } else { 0.0 };
    let rest: Vector = std::array::from_fn(|k| point[k] - t * edge[k]);
    (dot(&rest, &rest), t)
}

/// Returns `from + t edge`.
#[inline(always)]
pub(super) fn along(from: &Vector, edge: &Vector, t: f64) -> Vector {
    std::array::from_fn(|k| from[k] + t * edge[k])
}

/// A triangle with the quantities needed to find the feet of points on it.
pub(crate) struct PreparedTriangle {
    corner: Vector,
    edges: [Vector; 2],
    normal: Vector,
    /// Squared length of the normal. If it is zero, the face has no area within rounding.
    squared: f64,
    second_squared: f64,
}

impl PreparedTriangle {
    #[inline(always)]
    pub(crate) fn new([a, b, c]: &[Vector; 3]) -> Self {
        let edges = [sub(b, a), sub(c, a)];
        let normal = accurate_cross(&edges[0], &edges[1]);
        let squared = dot(&normal, &normal);
        Self { corner: *a, edges, normal, squared, second_squared: dot(&edges[1], &edges[1]) }
    }

    /// Returns the squared distance of a point from the face with these corners, and the nearest
    /// point, as [`point_triangle`] does.
    #[inline(always)]
    pub(crate) fn nearest(&self, point: &Vector, triangle: &[Vector; 3]) -> (f64, Vector) {
        let mut nearest = self.foot(point).unwrap_or((f64::INFINITY, triangle[0]));
        for i in 0..3 {
            let (from, to) = (&triangle[i], &triangle[(i + 1) % 3]);
            let edge = sub(to, from);
            let (squared, t) = point_segment(&sub(point, from), &edge);
            if squared < nearest.0 {
                nearest = (squared, along(from, &edge, t));
            }
        }
        nearest
    }

    /// Returns the squared distance of a point from the plane, and its foot. Returns `None` if the
    /// foot is outside the face.
    #[inline(always)]
    pub(super) fn foot(&self, point: &Vector) -> Option<(f64, Vector)> {
        let from = sub(point, &self.corner);
        let [u, v] = &self.edges;
        let s = dot(&cross(&from, v), &self.normal) / self.squared;
        let rest: Vector = std::array::from_fn(|k| from[k] - s * u[k]);
        let t = dot(&rest, v) / self.second_squared;
        // A face without area gives NaN, which fails the comparison.
        if !(s >= 0.0 && t >= 0.0 && s + t <= 1.0) {
            return None;
        }
        let rest: Vector = std::array::from_fn(|k| rest[k] - t * v[k]);
        Some((dot(&rest, &rest), std::array::from_fn(|k| self.corner[k] + (s * u[k] + t * v[k]))))
    }
}

/// Returns the squared distance of a point from a triangle, and the nearest point. The fourth
/// powers of the coordinates must neither overflow nor underflow.
#[inline]
pub(crate) fn point_triangle(point: &Vector, triangle: &[Vector; 3]) -> (f64, Vector) {
    PreparedTriangle::new(triangle).nearest(point, triangle)
}
