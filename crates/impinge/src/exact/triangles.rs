//! Exact decision whether two triangles intersect.
//!
//! The algorithm is Guigue and Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using
//! Orientation Predicates*, Journal of Graphics Tools 8(1), 2003, extended to triangles without
//! area. Let `side_a[i]` be the side of B's plane on which corner i of A lies, and `side_b[j]` the
//! side of A's plane on which corner j of B lies.
//!
//! 1. All corners of one triangle are strictly on one side of the other's plane: the triangles are
//!    disjoint.
//! 2. Both triangles have corners off the other's plane. So both have area, and the planes
//!    intersect in a line. Each triangle intersects this line in an interval, bounded by the two
//!    edges that leave its [`Apex`]. The crossings of an edge of A and an edge of B compare by the
//!    orientation of the two edges. Two comparisons decide.
//! 3. A has corners off B's plane, but B has none off A's. If A had area, B would lie in its plane
//!    and both planes would be one; so A is a segment. It crosses B's plane in a point. The point
//!    is in B if the segment passes the three edges on one side. The case with A and B swapped is
//!    the same.
//! 4. All sides are zero. If a triangle has area, both lie in its plane, and a projection along
//!    some axis is one-to-one there. Otherwise both are segments or points. They are skew, or in
//!    one plane, in which some projection shows whether they are disjoint, or in one line, on which
//!    the intervals along the axes do.
//!
//! The proof is docs/notes/proof.md, L7, and the tests are `tests/it/exact_triangles.rs`.

use super::corners::{PairCorners, Tier};
use super::exact_points::Corners;
use super::placement::Placement;
use crate::math::Sign::{self, Negative, Positive, Zero};

/// Result of the decision whether two triangles intersect, and the arithmetic that it needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Whether the triangles have a point in common.
    pub intersects: bool,
    /// Slowest arithmetic used.
    pub tier: Tier,
}

/// Reports whether triangle `a` of mesh A and triangle `b` of mesh B have a point in common.
/// Touching triangles intersect. Each triangle is given in the frame of its mesh.
///
/// The answer is exact for the images of the corners under the poses, whatever their size, for all
/// finite coordinates below 2^128 in magnitude.
///
/// ```
/// use impinge::Pose;
/// use impinge::exact::{Placement, triangles_intersect};
///
/// let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let spike = [[0.25, 0.25, 0.0], [0.25, 0.25, 1.0], [0.5, 0.25, 1.0]];
/// let lifted = Pose::from_translation([0.0, 0.0, 1e-300])?;
/// assert!(triangles_intersect(&Placement::new(&Pose::IDENTITY, &Pose::IDENTITY), &floor, &spike));
/// assert!(!triangles_intersect(&Placement::new(&Pose::IDENTITY, &lifted), &floor, &spike));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn triangles_intersect(placement: &Placement, a: &Corners, b: &Corners) -> bool {
    decide_triangles(placement, a, b).intersects
}

/// Returns the answer of [`triangles_intersect`] and the arithmetic that decided it.
#[must_use]
pub fn decide_triangles(placement: &Placement, a: &Corners, b: &Corners) -> Decision {
    if placement.is_shared() && a.iter().any(|corner| b.contains(corner)) {
        return Decision { intersects: true, tier: Tier::Filter };
    }
    let mut corners = PairCorners::new(placement, a, b);
    let intersects = match Position::of(&mut corners) {
        Position::Apart => false,
        Position::Crossing(line) => line.overlap(&mut corners),
        Position::SegmentOfA(segment) => on_one_side(segment.pass_edges_of_b(&mut corners)),
        Position::SegmentOfB(segment) => on_one_side(segment.pass_edges_of_a(&mut corners)),
        Position::Flat => flat_intersect(&mut corners),
    };
    Decision { intersects, tier: corners.tier() }
}

/// Position of two triangles relative to each other's planes.
pub(super) enum Position {
    /// One triangle is strictly on one side of the other's plane.
    Apart,
    /// Both triangles have area, and each has corners off the other's plane without staying on one
    /// side of it.
    Crossing(CommonLine),
    /// A is a segment that intersects the plane of B, which has area, in one point.
    SegmentOfA(Transversal),
    /// B is a segment that intersects the plane of A, which has area, in one point.
    SegmentOfB(Transversal),
    /// All corners are in one plane, or both triangles have no area.
    Flat,
}

/// The common line of two planes, with the corners that bound each triangle's interval on it.
///
/// A intersects the line between its edges from `a[0]` to `a[1]` and from `a[0]` to `a[2]`. B does
/// so between its edges from `b[0]` to `b[1]` and from `b[0]` to `b[2]`. The corners are ordered
/// along one direction of the line: A's interval goes from edge `a[0] a[2]` to edge `a[0] a[1]`,
/// and B's interval goes from edge `b[0] b[1]` to edge `b[0] b[2]`.
pub(super) struct CommonLine {
    pub(super) a: [usize; 3],
    pub(super) b: [usize; 3],
    pub(super) side_a: [Sign; 3],
    pub(super) side_b: [Sign; 3],
    /// Whether the direction that orders the corners is opposite to `normal_a × normal_b` in A's
    /// frame.
    pub(super) against_normals: bool,
}

/// An edge with its ends on different sides of a plane, or with one end on it.
pub(super) struct Transversal {
    pub(super) edge: [usize; 2],
    pub(super) sides: [Sign; 3],
}

/// A corner that is above both others, or below both, by the sign of its side. A triangle has an
/// apex unless all sides are equal. Both edges that leave the apex cross or touch the plane.
struct Apex {
    corner: usize,
    up: bool,
}

impl Position {
    pub(super) fn of(corners: &mut PairCorners) -> Self {
        let side_b = corners.sides_of_a();
        if all_strictly(side_b) {
            return Self::Apart;
        }
        let side_a = corners.sides_of_b();
        if all_strictly(side_a) {
            return Self::Apart;
        }
        match (Apex::of(side_a), Apex::of(side_b)) {
            (Some(apex_a), Some(apex_b)) => Self::Crossing(CommonLine::new(apex_a, apex_b, side_a, side_b)),
            (Some(apex), None) => Self::SegmentOfA(Transversal::from_apex(apex, side_a)),
            (None, Some(apex)) => Self::SegmentOfB(Transversal::from_apex(apex, side_b)),
            (None, None) => Self::Flat,
        }
    }
}

impl Apex {
    fn of(sides: [Sign; 3]) -> Option<Self> {
        (0..3).find_map(|corner| {
            let (side, next, last) = (sides[corner], sides[(corner + 1) % 3], sides[(corner + 2) % 3]);
            let up = side > next && side > last;
            let down = side < next && side < last;
            (up || down).then_some(Self { corner, up })
        })
    }

    fn cycle(&self) -> [usize; 3] {
        [self.corner, (self.corner + 1) % 3, (self.corner + 2) % 3]
    }
}

impl CommonLine {
    /// Let the planes of A and B be y = 0 and z = 0, with positive sides towards +y and +z, and let
    /// A's apex be up. From `side_b > 0` at y > 0 it follows how A's corners turn, seen in its
    /// plane: the edge to `a[1]` crosses the line y = z = 0 at the larger x. If B's apex is up, the
    /// edge to `b[2]` does. An apex that is down becomes one that is up if the other triangle's
    /// corners turn the other way. The x axis points along the product of both normals after such
    /// turns.
    fn new(apex_a: Apex, apex_b: Apex, side_a: [Sign; 3], side_b: [Sign; 3]) -> Self {
        let (mut a, mut b) = (apex_a.cycle(), apex_b.cycle());
        if !apex_a.up {
            b.swap(1, 2);
        }
        if !apex_b.up {
            a.swap(1, 2);
        }
        Self { a, b, side_a, side_b, against_normals: apex_a.up != apex_b.up }
    }

    /// Compares the crossing of edge `b[0] b[end_b]` with the line to that of edge `a[0] a[end_a]`.
    /// With the planes as in `new` and both edges leaving their apex downwards, the orientation of
    /// the edges is the difference of the two x times a positive number.
    pub(super) fn compare(&self, corners: &mut PairCorners, end_b: usize, end_a: usize) -> Sign {
        corners.edges([self.a[0], self.a[end_a]], [self.b[0], self.b[end_b]])
    }

    fn overlap(&self, corners: &mut PairCorners) -> bool {
        self.compare(corners, 1, 1) <= Zero && self.compare(corners, 2, 2) >= Zero
    }

    /// Reports whether the intervals have more than a point in common.
    pub(super) fn overlap_at_length(&self, corners: &mut PairCorners) -> bool {
        self.side_a[self.a[0]] != Zero
            && self.side_b[self.b[0]] != Zero
            && self.compare(corners, 1, 1) == Negative
            && self.compare(corners, 2, 2) == Positive
    }
}

impl Transversal {
    fn from_apex(apex: Apex, sides: [Sign; 3]) -> Self {
        let [from, to, _] = apex.cycle();
        Self { edge: [from, to], sides }
    }

    /// Returns the side on which this edge of A passes each edge of B. Edge k goes from corner k to
    /// the next corner.
    pub(super) fn pass_edges_of_b(&self, corners: &mut PairCorners) -> [Sign; 3] {
        std::array::from_fn(|k| corners.edges(self.edge, [k, (k + 1) % 3]))
    }

    /// Returns the side on which this edge of B passes each edge of A. Edge k goes from corner k to
    /// the next corner.
    pub(super) fn pass_edges_of_a(&self, corners: &mut PairCorners) -> [Sign; 3] {
        std::array::from_fn(|k| corners.edges([k, (k + 1) % 3], self.edge))
    }
}

/// Reports whether a line that crosses a triangle's plane does so within the triangle. `passes`
/// holds the sides on which it passes the three edges.
pub(super) fn on_one_side(passes: [Sign; 3]) -> bool {
    !(passes.contains(&Negative) && passes.contains(&Positive))
}

/// Reports whether two triangles intersect if all their corners are on each other's planes, or if
/// both have no area.
pub(super) fn flat_intersect(corners: &mut PairCorners) -> bool {
    if (0..3).any(|axis| ranges_apart(corners, axis)) {
        return false;
    }
    for axis in 0..3 {
        if corners.orient2d(axis, 0, 1, 2) != Zero || corners.orient2d(axis, 3, 4, 5) != Zero {
            return !separated(corners, axis);
        }
    }
    !skew(corners) && !(0..3).any(|axis| separated(corners, axis))
}

/// Reports whether the ranges of the two triangles along an axis are disjoint.
fn ranges_apart(corners: &mut PairCorners, axis: usize) -> bool {
    let mut a_below_b = true;
    let mut b_below_a = true;
    for i in 0..3 {
        for j in 3..6 {
            let order = corners.compare(axis, i, j);
            a_below_b &= order == Negative;
            b_below_a &= order == Positive;
        }
    }
    a_below_b || b_below_a
}

/// Reports whether some edge of one triangle separates the two in the projection along an axis: all
/// corners of the other are strictly on one side, and its own third corner is not there. Disjoint
/// convex sets in a plane have such an edge unless they are in one line: the origin is outside an
/// edge of their Minkowski difference, whose edges are all parallel to edges of the two sets.
fn separated(corners: &mut PairCorners, axis: usize) -> bool {
    let (a, b) = ([0, 1, 2], [3, 4, 5]);
    [(a, b), (b, a)].into_iter().any(|(own, other)| {
        (0..3).any(|k| {
            let (p, q, r) = (own[k], own[(k + 1) % 3], own[(k + 2) % 3]);
            let sides = other.map(|corner| corners.orient2d(axis, p, q, corner));
            all_strictly(sides) && corners.orient2d(axis, p, q, r) != sides[0]
        })
    })
}

/// Reports whether two sets without area span space: two corners of each are not in one plane.
fn skew(corners: &mut PairCorners) -> bool {
    let edges = [[0, 1], [1, 2], [2, 0]];
    edges.into_iter().any(|edge_a| edges.into_iter().any(|edge_b| corners.edges(edge_a, edge_b) != Zero))
}

fn all_strictly(sides: [Sign; 3]) -> bool {
    sides[0] != Zero && sides[0] == sides[1] && sides[0] == sides[2]
}
