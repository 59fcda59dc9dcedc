//! Second method to decide whether two triangles intersect: clip the edges of each against the
//! other.
//!
//! Two closed triangles intersect exactly if an edge of one intersects the other. Their
//! intersection is convex and closed. If the triangles lie in one plane, a corner of the
//! intersection lies on the boundary of one of them. If they lie in two planes, the intersection is
//! a point or a segment whose ends do. A triangle without area is its own boundary.
//!
//! An edge p + t (q - p), 0 ≤ t ≤ 1, intersects a triangle if some t satisfies the linear
//! conditions for points of the triangle (Cyrus and Beck, 1978). Each condition cuts the interval
//! of t at a rational number.

use super::integers::{Vector, corners, cross, dot, is_zero, subtract};
use crate::Affine;
use dashu_int::IBig;

/// Reports whether two closed triangles have a point in common. It shares only the integer
/// coordinates with [`triangles_meet`](super::triangles_meet), which it checks.
///
/// # Panics
/// Panics if a number is not finite.
pub fn triangles_meet_by_clipping(
    a: &[[f64; 3]; 3],
    world_from_a: &Affine,
    b: &[[f64; 3]; 3],
    world_from_b: &Affine,
) -> bool {
    let (a, b) = corners(a, world_from_a, b, world_from_b);
    let an_edge_meets = |edges: &[Vector; 3], triangle: &[Vector; 3]| {
        (0..3).any(|i| edge_meets(&edges[i], &edges[(i + 1) % 3], triangle))
    };
    an_edge_meets(&a, &b) || an_edge_meets(&b, &a)
}

fn edge_meets(p: &Vector, q: &Vector, triangle: &[Vector; 3]) -> bool {
    let mut clip = Clip::new(p, q);
    let normal = cross(&subtract(&triangle[1], &triangle[0]), &subtract(&triangle[2], &triangle[0]));
    if !is_zero(&normal) {
        return clip.keep_plane(&normal, &triangle[0])
            && (0..3).all(|i| {
                let inward = cross(&normal, &subtract(&triangle[(i + 1) % 3], &triangle[i]));
                clip.keep_side(&inward, &triangle[i])
            });
    }
    // The corners lie in a line, and the segment is the longest of the three edges. If all corners
    // are equal, its direction is zero, and the coordinates must be equal.
    let length_squared = |i: usize| {
        let edge = subtract(&triangle[(i + 1) % 3], &triangle[i]);
        dot(&edge, &edge)
    };
    let longest = (0..3).max_by_key(|&i| length_squared(i)).expect("three edges");
    let (start, end) = (&triangle[longest], &triangle[(longest + 1) % 3]);
    let direction = subtract(end, start);
    let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|axis| axis.map(IBig::from));
    if is_zero(&direction) {
        return axes.iter().all(|axis| clip.keep_plane(axis, start));
    }
    // The planes through the segment and parallel to one axis each intersect in its line.
    axes.iter().all(|axis| clip.keep_plane(&cross(&direction, axis), start))
        && clip.keep_side(&direction, start)
        && clip.keep_side(&direction.map(|x| -x), end)
}

/// Part of an edge that satisfies the conditions so far: `low ≤ t ≤ high`, as fractions with
/// positive denominators.
struct Clip<'a> {
    start: &'a Vector,
    along: Vector,
    low: (IBig, IBig),
    high: (IBig, IBig),
}

impl<'a> Clip<'a> {
    fn new(start: &'a Vector, end: &Vector) -> Self {
        let along = subtract(end, start);
        Self { start, along, low: (IBig::ZERO, IBig::ONE), high: (IBig::ONE, IBig::ONE) }
    }

    /// Keeps the points x with `normal · (x - origin) ≥ 0`, and reports whether any are left.
    fn keep_side(&mut self, normal: &Vector, origin: &Vector) -> bool {
        self.keep(dot(normal, &subtract(self.start, origin)), dot(normal, &self.along))
    }

    /// Keeps the points x with `normal · (x - origin) = 0`, and reports whether any are left.
    fn keep_plane(&mut self, normal: &Vector, origin: &Vector) -> bool {
        let height = dot(normal, &subtract(self.start, origin));
        let slope = dot(normal, &self.along);
        self.keep(height.clone(), slope.clone()) && self.keep(-height, -slope)
    }

    /// Keeps the t with `height + slope t ≥ 0`, and reports whether any are left.
    fn keep(&mut self, height: IBig, slope: IBig) -> bool {
        if slope == IBig::ZERO {
            return height >= IBig::ZERO;
        }
        if slope > IBig::ZERO {
            let bound = (-height, slope);
            if less(&self.low, &bound) {
                self.low = bound;
            }
        } else {
            let bound = (height, -slope);
            if less(&bound, &self.high) {
                self.high = bound;
            }
        }
        !less(&self.high, &self.low)
    }
}

fn less(a: &(IBig, IBig), b: &(IBig, IBig)) -> bool {
    &a.0 * &b.1 < &b.0 * &a.1
}
