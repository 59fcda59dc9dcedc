//! Whether two triangles meet.
//!
//! The decision is that of Guigue and Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using Orientation
//! Predicates*, Journal of Graphics Tools 8(1), 2003, extended to triangles without area. Let `side_a[i]` be the side of
//! B's plane that corner i of A is on, and `side_b[j]` likewise.
//!
//! 1. All of one triangle strictly on one side of the other's plane: apart.
//! 2. Both triangles have corners off the other's plane, so both have area, and the planes meet in a line. Each meets
//!    this line in an interval, bounded by the two edges that leave its [`Apex`]. Where an edge of A and one of B cross
//!    the line is compared by the orientation of the two edges; two comparisons decide.
//! 3. The corners of A are off B's plane but not those of B off A's: were A to have area, B would lie in its plane, and
//!    both would be one; so A is a segment. It crosses B's plane in a point, which is in B where it passes
//!    the three edges on one side. Likewise with A and B swapped.
//! 4. All sides zero. If a triangle has area, both lie in its plane, and a projection along an axis is one-to-one there.
//!    Otherwise both are segments or points: skew, or in one plane, where some projection shows whether they are apart,
//!    or in one line, where the intervals along the axes do.

use super::corners::{PairCorners, Tier};
use super::exact_points::Corners;
use super::placement::Placement;
use crate::math::Sign::{self, Negative, Positive, Zero};

/// Whether two triangles meet, and what it took to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Whether they have a point in common.
    pub intersects: bool,
    /// The dearest arithmetic used.
    pub tier: Tier,
}

/// Whether triangle `a` of mesh A and triangle `b` of mesh B have a point in common, touching included.
///
/// Decided exactly for the images of the corners under the poses, whatever their size, for every finite coordinate
/// below 2^128 in magnitude.
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

/// [`triangles_intersect`], telling also which arithmetic decided.
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
        Position::Flat => flat_meet(&mut corners),
    };
    Decision { intersects, tier: corners.tier() }
}

/// How two triangles lie to the planes of each other.
pub(super) enum Position {
    /// One is strictly on one side of the other.
    Apart,
    /// Both have area, and each has corners off the other's plane and does not stay on one side of it.
    Crossing(CommonLine),
    /// A is a segment that meets the plane of B, which has area, in one point.
    SegmentOfA(Transversal),
    /// B is a segment that meets the plane of A, which has area, in one point.
    SegmentOfB(Transversal),
    /// All in one plane, or both without area.
    Flat,
}

/// The line that two planes have in common, with the corners that bound the interval of each triangle on it.
///
/// A meets the line between the edges from `a[0]` to `a[1]` and to `a[2]`, B likewise, and the corners are named such
/// that along one direction of the line A's interval is from edge `a[0] a[2]` to edge `a[0] a[1]` and B's from edge
/// `b[0] b[1]` to edge `b[0] b[2]`.
pub(super) struct CommonLine {
    pub(super) a: [usize; 3],
    pub(super) b: [usize; 3],
    pub(super) side_a: [Sign; 3],
    pub(super) side_b: [Sign; 3],
    /// Whether that direction is opposite to `normal_a × normal_b` in A's frame.
    pub(super) against_normals: bool,
}

/// An edge with its ends on different sides of a plane, or one of them on it.
pub(super) struct Transversal {
    pub(super) edge: [usize; 2],
    pub(super) sides: [Sign; 3],
}

/// A corner that is further up, or further down, than both others by the sign of its side. Where the sides are not all
/// equal there is one, and both edges that leave it cross the plane.
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
    /// Let the planes of A and B be y = 0 and z = 0, with the sides of positive sign towards +y and +z, and A's apex
    /// up. From `side_b > 0` where y > 0 it follows that A's corners, seen in its plane, turn such that the edge to
    /// `a[1]` crosses the line y = z = 0 at the larger x; with B's apex up, the edge to `b[2]` does. An apex that is
    /// down is up once the other triangle's corners turn the other way round. The x axis is along the product of
    /// both normals, as they are after such turns.
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

    /// How the crossing of edge `b[0] b[end_b]` with the line compares to that of edge `a[0] a[end_a]`: with the planes
    /// as in `new` and both edges leaving their apex downwards, the orientation of the edges is the difference of the
    /// two x times a positive number.
    pub(super) fn compare(&self, corners: &mut PairCorners, end_b: usize, end_a: usize) -> Sign {
        corners.edges([self.a[0], self.a[end_a]], [self.b[0], self.b[end_b]])
    }

    fn overlap(&self, corners: &mut PairCorners) -> bool {
        self.compare(corners, 1, 1) <= Zero && self.compare(corners, 2, 2) >= Zero
    }

    /// Whether the intervals have more than a point in common.
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

    /// On which side this edge of A passes each edge of B, the edge k being from corner k to the next.
    pub(super) fn pass_edges_of_b(&self, corners: &mut PairCorners) -> [Sign; 3] {
        std::array::from_fn(|k| corners.edges(self.edge, [k, (k + 1) % 3]))
    }

    /// On which side this edge of B passes each edge of A.
    pub(super) fn pass_edges_of_a(&self, corners: &mut PairCorners) -> [Sign; 3] {
        std::array::from_fn(|k| corners.edges([k, (k + 1) % 3], self.edge))
    }
}

/// Whether a line that passes the edges of a triangle on these sides, and crosses its plane, does so within it.
pub(super) fn on_one_side(passes: [Sign; 3]) -> bool {
    !(passes.contains(&Negative) && passes.contains(&Positive))
}

/// Whether triangles meet whose corners are all on the other's plane, or that have no planes.
pub(super) fn flat_meet(corners: &mut PairCorners) -> bool {
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

/// Whether the ranges of the two along an axis are disjoint.
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

/// Whether an edge of one, in the projection along an axis, has all of the other strictly on one side and its own third
/// corner not there. Convex sets in a plane that are apart have such an edge unless all is in one line: the origin is
/// outside an edge of their Minkowski difference, and each of its edges is parallel to one of theirs.
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

/// Whether two sets without area span space: some corners, two of each, are not in one plane.
fn skew(corners: &mut PairCorners) -> bool {
    let edges = [[0, 1], [1, 2], [2, 0]];
    edges.into_iter().any(|edge_a| edges.into_iter().any(|edge_b| corners.edges(edge_a, edge_b) != Zero))
}

fn all_strictly(sides: [Sign; 3]) -> bool {
    sides[0] != Zero && sides[0] == sides[1] && sides[0] == sides[2]
}
