//! Exact decision whether two triangles are within a distance of each other.
//!
//! The squared distance of triangles with rational corners is rational, so it compares exactly to
//! the square of a float (docs/notes/proof.md, L13). Nothing is divided. Triangles without a common
//! point are nearest at a corner and an edge, at two edges, or at a corner and a face. For each of
//! these parts, the side of a foot point and the comparison are signs of polynomials in the
//! corners. All parts are tried, so it does not matter which is nearest.

use super::exact_points::Corners;
use super::placement::{Placement, world_point};
use super::triangles::triangles_intersect;
use crate::math::Sign::{Negative, Positive, Zero};
use crate::math::dyadic::{self, Dyadic};

/// Reports whether triangle `a` of mesh A and triangle `b` of mesh B have points no farther apart
/// than `clearance`, in world units. Each triangle is given in the frame of its mesh. The answer is
/// exact. Returns `false` if `clearance` is negative or NaN.
///
/// # Complexity
/// 33 comparisons of integers of about 20 words each, and of 700 words in the worst case.
#[must_use]
pub fn triangles_within(placement: &Placement, a: &Corners, b: &Corners, clearance: f64) -> bool {
    parts_within(placement, a, b, clearance, &NearParts { edges: [[true; 3]; 3], feet: [[true; 3]; 2] })
}

/// The pairs of parts of two triangles that may be within a distance of each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearParts {
    /// Whether to compare edge `i` of the first triangle with edge `j` of the second, at `[i][j]`.
    /// Edge `i` starts at corner `i`.
    pub(crate) edges: [[bool; 3]; 3],
    /// Whether to compare each corner of one triangle with the face of the other: first the corners
    /// of the first triangle, then the corners of the second.
    pub(crate) feet: [[bool; 3]; 2],
}

/// Returns the same as [`triangles_within`], if the parts that are not selected are known to be
/// farther apart than `clearance`.
pub(crate) fn parts_within(placement: &Placement, a: &Corners, b: &Corners, clearance: f64, parts: &NearParts) -> bool {
    if clearance.is_nan() || clearance < 0.0 {
        return false;
    }
    if clearance == f64::INFINITY || triangles_intersect(placement, a, b) {
        return true;
    }
    let a = a.map(|corner| world_point(placement.world_from_a(), &corner));
    let b = b.map(|corner| world_point(placement.world_from_b(), &corner));
    let limit = Dyadic::product(clearance, clearance);
    let edge = |i: usize| [i, (i + 1) % 3];
    for i in 0..3 {
        for j in (0..3).filter(|&j| parts.edges[i][j]) {
            let ([a0, a1], [b0, b1]) = (edge(i), edge(j));
            let near = point_near_segment(&a[i], &b[b0], &b[b1], &limit)
                || point_near_segment(&b[j], &a[a0], &a[a1], &limit)
                || inner_points_near([&a[a0], &a[a1]], [&b[b0], &b[b1]], &limit);
            if near {
                return true;
            }
        }
    }
    (0..3).any(|i| {
        (parts.feet[0][i] && foot_near(&a[i], &b, &limit)) || (parts.feet[1][i] && foot_near(&b[i], &a, &limit))
    })
}

type Point = [Dyadic; 3];

fn difference(p: &Point, q: &Point) -> Point {
    [0, 1, 2].map(|k| &p[k] - &q[k])
}

fn at_most(value: &Dyadic, limit: &Dyadic) -> bool {
    (value - limit).sign() != Positive
}

fn point_near_segment(point: &Point, from: &Point, to: &Point, limit: &Dyadic) -> bool {
    let (w, edge) = (difference(point, from), difference(to, from));
    let along = dyadic::dot(&w, &edge);
    let squared = dyadic::dot(&edge, &edge);
    if along.sign() != Positive {
        return at_most(&dyadic::dot(&w, &w), limit);
    }
    if at_most(&squared, &along) {
        let w = difference(point, to);
        return at_most(&dyadic::dot(&w, &w), limit);
    }
    let rest = &(&dyadic::dot(&w, &w) * &squared) - &(&along * &along);
    at_most(&rest, &(limit * &squared))
}

/// Reports whether the nearest points of two lines are inside their segments and within the limit.
fn inner_points_near([p, q]: [&Point; 2], [r, s]: [&Point; 2], limit: &Dyadic) -> bool {
    let (u, v, w) = (difference(q, p), difference(s, r), difference(r, p));
    let normal = dyadic::cross(&u, &v);
    let squared = dyadic::dot(&normal, &normal);
    if squared.sign() == Zero {
        return false;
    }
    let is_inside = |t: &Dyadic| t.sign() != Negative && at_most(t, &squared);
    if !is_inside(&dyadic::dot(&dyadic::cross(&w, &v), &normal))
        || !is_inside(&dyadic::dot(&dyadic::cross(&w, &u), &normal))
    {
        return false;
    }
    let across = dyadic::dot(&w, &normal);
    at_most(&(&across * &across), &(limit * &squared))
}

/// Reports whether the foot of a point on a plane is inside the triangle and within the limit.
fn foot_near(point: &Point, [a, b, c]: &[Point; 3], limit: &Dyadic) -> bool {
    let (u, v, w) = (difference(b, a), difference(c, a), difference(point, a));
    let normal = dyadic::cross(&u, &v);
    let squared = dyadic::dot(&normal, &normal);
    if squared.sign() == Zero {
        return false;
    }
    let s = dyadic::dot(&dyadic::cross(&w, &v), &normal);
    let t = dyadic::dot(&dyadic::cross(&u, &w), &normal);
    if s.sign() == Negative || t.sign() == Negative || !at_most(&(&s + &t), &squared) {
        return false;
    }
    let across = dyadic::dot(&w, &normal);
    at_most(&(&across * &across), &(limit * &squared))
}
