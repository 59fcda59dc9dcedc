//! The nearest points of two triangles.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 5.1.10: triangles without a common point are
//! nearest at two edges, or at a corner and a face. `exact` decides whether they have a common
//! point. It is called only if the direction between the witnesses does not prove that they have
//! none.

use super::closest::{ClosestPoints, Scaled};
use super::points::{PreparedTriangle, along, point_segment};
use super::segments::inner_points;
use crate::exact::{Crossing, Placement, crossing, triangles_intersect};
use crate::math::Pose;
use crate::math::vec3::{Vector, dot, length, sub};

/// Returns the nearest points of two triangles. Either triangle may degenerate to a segment or a
/// point.
///
/// Swapping the triangles changes no bit of the distance and swaps the points. One exception: the
/// common point of intersecting triangles may be another one.
///
/// # Accuracy
/// As for [`ClosestPoints`]. The distance is zero exactly if the triangles intersect. Both points
/// are then the same common point, rounded.
///
/// ```
/// use impinge::primitive::closest_on_triangles;
///
/// let floor = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let above = floor.map(|[x, y, _]| [x - 1.0, y - 1.0, 2.0]);
/// assert_eq!(closest_on_triangles(&floor, &above).distance, 2.0);
/// assert_eq!(closest_on_triangles(&floor, &floor).distance, 0.0);
/// ```
#[must_use]
pub fn closest_on_triangles(a: &[Vector; 3], b: &[Vector; 3]) -> ClosestPoints {
    let scaled = Scaled::new([a[0], a[1], a[2], b[0], b[1], b[2]]);
    let [p, q, r, s, t, u] = scaled.points;
    let (a_scaled, b_scaled) = ([p, q, r], [s, t, u]);
    let witness = triangle_triangle(&a_scaled, &b_scaled);
    let closest = scaled.back(witness.squared, witness.on_a, witness.on_b);
    let error_bound = scaled.error();
    if separation(&a_scaled, &b_scaled, &witness) > error_bound {
        return closest;
    }
    let placement = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
    if !triangles_intersect(&placement, a, b) {
        // Rounding may make the points equal although the triangles are apart.
        return ClosestPoints { distance: closest.distance.max(f64::MIN_POSITIVE), ..closest };
    }
    let common = common_point(&placement, a, b).unwrap_or(closest.point_a);
    ClosestPoints { distance: 0.0, error: 0.0, point_a: common, point_b: common }
}

/// Returns a common point of two intersecting triangles, in the world frame, rounded. Returns
/// `None` if the triangles overlap in one plane or have no area; closed forms find a common point
/// of such triangles.
pub(crate) fn common_point(placement: &Placement, a: &[Vector; 3], b: &[Vector; 3]) -> Option<Vector> {
    match crossing(placement, a, b) {
        Crossing::Point(end) | Crossing::Segment(end, _) => Some(end.point),
        Crossing::Apart | Crossing::Coplanar => None,
    }
}

/// The nearest points among the edges, corners and faces of two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Witness {
    /// Squared distance of the two points.
    pub(crate) squared: f64,
    pub(crate) on_a: Vector,
    pub(crate) on_b: Vector,
}

/// Returns the nearest points of two triangles' edges, corners and faces. They are the nearest
/// points of the triangles if these do not intersect. The fourth powers of the coordinates must not
/// overflow. Swapping the triangles swaps the points and changes no bit.
pub(crate) fn triangle_triangle(a: &[Vector; 3], b: &[Vector; 3]) -> Witness {
    // The features are tried in an order that depends on the first triangle.
    if a.as_flattened() <= b.as_flattened() {
        ordered(a, b)
    } else {
        let Witness { squared, on_a, on_b } = ordered(b, a);
        Witness { squared, on_a: on_b, on_b: on_a }
    }
}

/// The features of the triangles that hold the nearest points, with the parameters to compute the
/// points.
#[derive(Clone, Copy)]
enum Parts {
    CornerOfA { corner: usize, edge: usize, t: f64 },
    CornerOfB { corner: usize, edge: usize, t: f64 },
    Edges { a: usize, b: usize, s: f64, t: f64 },
    FaceOfA { corner: usize, foot: Vector },
    FaceOfB { corner: usize, foot: Vector },
}

fn ordered(a: &[Vector; 3], b: &[Vector; 3]) -> Witness {
    nearest_corners(a, b).unwrap_or_else(|| nearest_of_all(a, b))
}

/// Returns the nearest pair of corners if no other points of the triangles are nearer. That is
/// certain if both triangles lie behind the two planes through these corners, perpendicular to the
/// line between them. It holds for all the faces around two vertices, and takes 10 % of the work of
/// [`nearest_of_all`].
///
/// # Accuracy
/// An edge that rounding puts on the wrong side leans over its plane by at most 4 units of 2^-53,
/// and comes nearer by at most that part of its length.
fn nearest_corners(a: &[Vector; 3], b: &[Vector; 3]) -> Option<Witness> {
    let mut least = (f64::INFINITY, 0, 0);
    for i in 0..3 {
        for j in 0..3 {
            let between = sub(&b[j], &a[i]);
            let squared = dot(&between, &between);
            if squared < least.0 {
                least = (squared, i, j);
            }
        }
    }
    let (squared, i, j) = least;
    let (on_a, on_b) = (a[i], b[j]);
    let between = sub(&on_b, &on_a);
    let is_behind =
        |corner: usize| dot(&sub(&a[corner], &on_a), &between) <= 0.0 && dot(&sub(&b[corner], &on_b), &between) >= 0.0;
    (is_behind(0) && is_behind(1) && is_behind(2)).then_some(Witness { squared, on_a, on_b })
}

/// Returns the nearest points among all edges, corners and faces.
fn nearest_of_all(a: &[Vector; 3], b: &[Vector; 3]) -> Witness {
    let edges = |corners: &[Vector; 3]| [0, 1, 2].map(|i| sub(&corners[(i + 1) % 3], &corners[i]));
    let (edges_a, edges_b) = (edges(a), edges(b));
    let (squares_a, squares_b) = (edges_a.each_ref().map(|u| dot(u, u)), edges_b.each_ref().map(|v| dot(v, v)));
    let mut least = f64::INFINITY;
    let mut parts = Parts::CornerOfA { corner: 0, edge: 0, t: 0.0 };
    let mut offer = |squared: f64, found: Parts| {
        if squared < least {
            (least, parts) = (squared, found);
        }
    };
    for i in 0..3 {
        for j in 0..3 {
            let w = sub(&b[j], &a[i]);
            let (squared, t) = point_segment(&w, &edges_a[i]);
            offer(squared, Parts::CornerOfB { corner: j, edge: i, t });
            let (squared, t) = point_segment(&[-w[0], -w[1], -w[2]], &edges_b[j]);
            offer(squared, Parts::CornerOfA { corner: i, edge: j, t });
            if let Some((squared, s, t)) = inner_points((&edges_a[i], squares_a[i]), (&edges_b[j], squares_b[j]), &w) {
                offer(squared, Parts::Edges { a: i, b: j, s, t });
            }
        }
    }
    let (face_a, face_b) = (PreparedTriangle::new(a), PreparedTriangle::new(b));
    for corner in 0..3 {
        if let Some((squared, foot)) = face_a.foot(&b[corner]) {
            offer(squared, Parts::FaceOfA { corner, foot });
        }
        if let Some((squared, foot)) = face_b.foot(&a[corner]) {
            offer(squared, Parts::FaceOfB { corner, foot });
        }
    }
    let (on_a, on_b) = match parts {
        Parts::CornerOfA { corner, edge, t } => (a[corner], along(&b[edge], &edges_b[edge], t)),
        Parts::CornerOfB { corner, edge, t } => (along(&a[edge], &edges_a[edge], t), b[corner]),
        Parts::Edges { a: i, b: j, s, t } => (along(&a[i], &edges_a[i], s), along(&b[j], &edges_b[j], t)),
        Parts::FaceOfA { corner, foot } => (foot, b[corner]),
        Parts::FaceOfB { corner, foot } => (a[corner], foot),
    };
    Witness { squared: least, on_a, on_b }
}

/// Returns a lower bound, before rounding, of the distance of the triangles along the line through
/// the witnesses. Returns -1 if that line does not separate them, or if the witnesses are equal.
///
/// # Accuracy
/// Within 12 units of 2^-53 of the diagonal of the box that holds both triangles. Differences of
/// corners are rounded once, products and sums three times, the length and the quotient twice more.
pub(crate) fn separation(a: &[Vector; 3], b: &[Vector; 3], witness: &Witness) -> f64 {
    let direction = sub(&witness.on_b, &witness.on_a);
    let size = length(&direction);
    let mut gap = f64::INFINITY;
    for p in a {
        for q in b {
            gap = gap.min(dot(&direction, &sub(q, p)));
        }
    }
    // Equal witnesses give NaN. The comparison is written so that NaN separates nothing.
    let separation = gap / size;
    if separation > 0.0 { separation } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::primitive::CLOSED_FORM_ERROR;

    #[test]
    fn corners_that_are_nearest_are_nearest_of_all() {
        let mut rng = Rng::new(1122);
        let mut found = [0; 2];
        for round in 0..100_000 {
            let is_on_grid = round % 2 == 0;
            let mut triangle = |reach: f64| -> [Vector; 3] {
                [0; 3].map(|_| {
                    [0; 3].map(|axis: usize| {
                        let x = if is_on_grid { rng.integer(-2, 2) as f64 } else { rng.uniform(-1.0, 1.0) };
                        if axis == 0 { x + reach } else { x }
                    })
                })
            };
            let (a, b) = (triangle(0.0), triangle(3.0));
            let Some(nearest) = nearest_corners(&a, &b) else { continue };
            found[usize::from(is_on_grid)] += 1;
            let all = nearest_of_all(&a, &b);
            let error_bound = Scaled::new([a[0], a[1], a[2], b[0], b[1], b[2]]).diagonal * CLOSED_FORM_ERROR;
            let off = nearest.squared.sqrt() - all.squared.sqrt();
            assert!(off.abs() <= 4.0 * error_bound, "{a:?} {b:?}: {off:e}");
        }
        assert!(found.iter().all(|&found| found > 5_000), "{found:?}");
    }
}
