//! Decides whether two faces of one mesh intersect beyond the hull of the positions that they
//! share.
//!
//! Neighbors always intersect at their common corner or edge. The hull of zero, one, two or three
//! distinct shared positions is empty, a point, a segment, or the triangle that both faces are.
//! Both triangles are convex, so:
//! - with one shared corner, they share more if the two cones at this corner share more than the
//!   corner;
//! - with two shared corners, they share more than the edge if they lie in one plane on one side of
//!   it, or, without area, in one line beyond the same end;
//! - with three shared corners, they never share more.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::filter::{self, Errors};
use super::placement::Placement;
use super::triangles::{Position, triangles_intersect};
use crate::math::Sign::{self, Zero};
use crate::math::vec3::sub;

/// Reports whether two faces of one mesh with one pose intersect beyond the hull of their shared
/// positions. Equal coordinates are one position, and zeros of either sign are equal.
pub(crate) fn intersect_beyond_shared(one_place: &Placement, a: &Corners, b: &Corners) -> bool {
    debug_assert!(one_place.is_shared(), "both faces are in one frame");
    let mut shared: [Option<[f64; 3]>; 3] = [None; 3];
    let mut count = 0;
    for corner in a {
        if b.contains(corner) && !shared.contains(&Some(*corner)) {
            shared[count] = Some(*corner);
            count += 1;
        }
    }
    match shared {
        [None, ..] => triangles_intersect(one_place, a, b),
        [Some(v), None, _] => beyond_corner(one_place, a, b, v),
        [Some(v), Some(w), None] => beyond_edge(one_place, a, b, [v, w]),
        [Some(_), Some(_), Some(_)] => false,
    }
}

/// Reports whether two triangles that share only the position `v` share more than that point.
fn beyond_corner(one_place: &Placement, a: &Corners, b: &Corners, v: [f64; 3]) -> bool {
    if stays_to_one_side(a, b, &v) || stays_to_one_side(b, a, &v) {
        return false;
    }
    let mut corners = PairCorners::new(one_place, a, b);
    match Position::of(&mut corners) {
        // Two segments of one line that hold `v`.
        Position::Crossing(line) => line.overlap_at_length(&mut corners),
        // A segment that crosses the other's plane does so in `v`.
        Position::Apart | Position::SegmentOfA(_) | Position::SegmentOfB(_) => false,
        Position::Flat => {
            let cone = |own: &Corners, from: usize| Cone {
                apex: from + own.iter().position(|corner| *corner == v).unwrap_or_default(),
                rays: std::array::from_fn(|i| (own[i] != v).then_some(from + i)),
            };
            let (cone_a, cone_b) = (cone(a, 0), cone(b, 3));
            cone_a.rays.into_iter().flatten().any(|corner| cone_b.holds(&mut corners, corner))
                || cone_b.rays.into_iter().flatten().any(|corner| cone_a.holds(&mut corners, corner))
        }
    }
}

/// Reports whether the corners of `other` except `v` are certainly all on one side of the plane of
/// `triangle`.
fn stays_to_one_side(triangle: &Corners, other: &Corners, v: &[f64; 3]) -> bool {
    let Some(apart) = other.iter().find(|corner| *corner != v) else { return true };
    let (u, w) = (sub(&triangle[1], &triangle[0]), sub(&triangle[2], &triangle[0]));
    // The plane holds `v`, so another corner takes its place: no filter proves a zero as quickly.
    let sides = signs(&u, &w, &other.map(|corner| sub(if corner == *v { apart } else { &corner }, v)));
    sides[0].is_some_and(|side| side != Zero) && sides.iter().all(|side| *side == sides[0])
}

/// Reports whether two triangles that share only these two positions share more than the edge
/// between them.
fn beyond_edge(one_place: &Placement, a: &Corners, b: &Corners, ends: [[f64; 3]; 2]) -> bool {
    let third = |own: &Corners| (0..3).find(|&i| !ends.contains(&own[i]));
    // A face without a third position is the shared edge.
    let (Some(third_a), Some(third_b)) = (third(a), third(b)) else { return false };
    let from_end = |corner: &[f64; 3]| sub(corner, &ends[0]);
    let [certain] = signs(&from_end(&ends[1]), &from_end(&a[third_a]), &[from_end(&b[third_b])]);
    if certain.is_some_and(|side| side != Zero) {
        return false;
    }
    let mut corners = PairCorners::new(one_place, a, b);
    let [v, w] = ends.map(|end| a.iter().position(|corner| *corner == end).unwrap_or_default());
    let (r, s) = (third_a, 3 + third_b);
    if certain.is_none() && corners.exact_orient3d(v, w, r, s) != Zero {
        return false;
    }
    for axis in 0..3 {
        let sides = [r, s].map(|corner| corners.orient2d(axis, v, w, corner));
        if sides != [Zero; 2] {
            // All corners lie in one plane, and at least one third corner is off the line of the
            // edge in this view. The other is too, or its triangle has no area.
            return sides[0] == sides[1];
        }
    }
    // All corners are in one line. The faces share more if both go beyond the same end. Otherwise
    // the shared edge is all of one face, or the faces go beyond different ends.
    let Some(axis) = (0..3).find(|&axis| corners.compare(axis, v, w) != Zero) else { return false };
    let order = corners.compare(axis, v, w);
    let [beyond_r, beyond_s] =
        [r, s].map(|corner| [corners.compare(axis, corner, v) == order, corners.compare(axis, w, corner) == order]);
    beyond_r == beyond_s && beyond_r != [false; 2]
}

fn signs<const N: usize>(u: &[f64; 3], v: &[f64; 3], ws: &[[f64; 3]; N]) -> [Option<Sign>; N] {
    const NONE: [f64; 3] = [0.0; 3];
    filter::signs(u, v, ws, &Errors { u: &NONE, v: &NONE, w: &NONE })
}

/// The directions of a triangle at one of its corners: all directions between the rays to its other
/// corners. A corner that coincides with the apex has no ray.
struct Cone {
    apex: usize,
    rays: [Option<usize>; 3],
}

impl Cone {
    /// Reports whether the direction to a corner, which is not at the apex, belongs to the cone.
    /// All points must lie in one plane, or the cone and the direction in two lines through the
    /// apex.
    fn holds(&self, corners: &mut PairCorners, corner: usize) -> bool {
        let mut rays = self.rays.into_iter().flatten();
        if let (Some(p), Some(q)) = (rays.next(), rays.next()) {
            for axis in 0..3 {
                let turn = corners.orient2d(axis, self.apex, p, q);
                if turn != Zero {
                    let after_p = corners.orient2d(axis, self.apex, p, corner);
                    let before_q = corners.orient2d(axis, self.apex, corner, q);
                    return after_p != -turn && before_q != -turn;
                }
            }
        }
        self.rays.into_iter().flatten().any(|ray| self.along(corners, ray, corner))
    }

    /// Reports whether a corner is in the same direction from the apex as the end of a ray.
    fn along(&self, corners: &mut PairCorners, ray: usize, corner: usize) -> bool {
        (0..3).all(|axis| corners.orient2d(axis, self.apex, ray, corner) == Zero)
            && (0..3).all(|axis| corners.compare(axis, self.apex, ray) == corners.compare(axis, self.apex, corner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;

    fn intersect(a: [[i32; 3]; 3], b: [[i32; 3]; 3]) -> bool {
        let place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let [a, b] = [a, b].map(|corners| corners.map(|corner| corner.map(f64::from)));
        let mut answers = Vec::new();
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            let turned = order.map(|i| a[i]);
            answers.push(intersect_beyond_shared(&place, &turned, &b));
            answers.push(intersect_beyond_shared(&place, &b, &turned));
        }
        assert!(
            answers.iter().all(|&answer| answer == answers[0]),
            "the answer depends on the order of corners or faces"
        );
        answers[0]
    }

    const FLOOR: [[i32; 3]; 3] = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];

    #[test]
    fn one_shared_corner() {
        assert!(!intersect(FLOOR, [[0, 0, 0], [1, 1, 1], [1, 2, 1]]), "to one side");
        assert!(!intersect(FLOOR, [[0, 0, 0], [-1, -1, 1], [-1, -2, -1]]), "crosses the plane elsewhere");
        assert!(intersect(FLOOR, [[0, 0, 0], [1, 1, 1], [1, 1, -1]]), "through the face");
        assert!(intersect(FLOOR, [[0, 0, 0], [1, 1, 0], [1, 1, -1]]), "an edge in the face");
        assert!(intersect(FLOOR, [[0, 0, 0], [9, 0, 0], [1, 1, -1]]), "along an edge");
        assert!(intersect(FLOOR, [[0, 0, 0], [9, 1, 0], [1, 9, 0]]), "in its plane");
        assert!(intersect(FLOOR, [[0, 0, 0], [4, -1, 0], [-1, 4, 0]]), "in its plane, all round it");
        assert!(!intersect(FLOOR, [[0, 0, 0], [-4, 0, 0], [0, -4, 0]]), "in its plane, opposite");
        assert!(!intersect(FLOOR, [[0, 0, 0], [-1, 1, 0], [-2, 1, 0]]), "in its plane, beside");
    }

    #[test]
    fn two_shared_corners() {
        assert!(!intersect(FLOOR, [[0, 0, 0], [4, 0, 0], [0, 0, 4]]), "a wall on it");
        assert!(!intersect(FLOOR, [[0, 0, 0], [4, 0, 0], [0, -4, 0]]), "beside it");
        assert!(intersect(FLOOR, [[0, 0, 0], [4, 0, 0], [9, 1, 0]]), "folded over it");
        assert!(!intersect(FLOOR, FLOOR), "the same");
    }

    #[test]
    fn faces_without_area() {
        assert!(!intersect(FLOOR, [[0, 0, 0], [4, 0, 0], [2, 0, 0]]), "the edge, split");
        assert!(!intersect(FLOOR, [[0, 0, 0], [4, 0, 0], [0, 0, 0]]), "the edge");
        assert!(!intersect(FLOOR, [[0, 0, 0], [4, 0, 0], [9, 0, 0]]), "beyond the edge");
        assert!(intersect(FLOOR, [[0, 0, 0], [2, 0, 0], [2, 0, 0]]), "half of the edge");
        assert!(intersect(FLOOR, [[0, 0, 0], [1, 1, 0], [2, 2, 0]]), "into the face");
        assert!(intersect(FLOOR, [[0, 0, 0], [1, 1, 0], [-1, -1, 0]]), "through the corner into the face");
        assert!(!intersect(FLOOR, [[0, 0, 0], [-1, 1, 0], [1, -1, 0]]), "through the corner, outside");
        assert!(!intersect(FLOOR, [[0, 0, 0], [0, 0, 1], [0, 0, -1]]), "through the corner, across");
        assert!(!intersect(FLOOR, [[0, 0, 0], [0, 0, 0], [0, 0, 0]]), "the corner");
        assert!(intersect(FLOOR, [[1, 1, 0], [1, 1, 0], [1, 1, 0]]), "a point of the face");
        let segment = [[0, 0, 0], [4, 0, 0], [8, 0, 0]];
        assert!(intersect(segment, [[0, 0, 0], [2, 0, 0], [1, 0, 0]]), "part of a segment");
        assert!(intersect(segment, [[0, 0, 0], [4, 0, 0], [9, 0, 0]]), "both beyond one end");
        assert!(!intersect(segment, [[0, 0, 0], [4, 0, 0], [-1, 0, 0]]), "beyond either end");
        assert!(!intersect(segment, [[0, 0, 0], [-4, 0, 0], [-1, 0, 0]]), "opposite");
        assert!(!intersect(segment, [[0, 0, 0], [0, 4, 0], [0, 1, 0]]), "across");
    }
}
