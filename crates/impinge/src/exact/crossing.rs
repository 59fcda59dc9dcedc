//! The common points of two triangles: the piece of an intersection curve that one pair
//! contributes.
//!
//! The decision is the one of `triangles`, but with all four comparisons on the common line instead
//! of two. Each end of the piece is described by the corner, edge or face of each triangle that it
//! lies on. So pieces of neighboring pairs link up without comparing coordinates, in touching and
//! degenerate positions too.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::feature::Feature;
use super::joint::{Joint, Side};
use super::placement::Placement;
use super::triangles::{CommonLine, Position, Transversal, flat_intersect, on_one_side};
use crate::math::Sign::{self, Negative, Positive, Zero};

/// The common points of two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossing<E = Endpoint> {
    /// The triangles are disjoint.
    Apart,
    /// The triangles share one point, and they lie in different planes or one of them has no area.
    Point(E),
    /// The triangles lie in different planes and share a segment. It runs along
    /// `normal_a × normal_b` in the world frame. Each normal follows from the order of the corners
    /// by the right-hand rule.
    Segment(E, E),
    /// The triangles share at least one point, and they lie in one plane or both have no area. The
    /// shared set is not computed.
    Coplanar,
}

/// End of a piece of an intersection curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Endpoint {
    /// Corner or edge of A that the point lies on, or A's face if it lies on neither.
    pub on_a: Feature,
    /// Corner or edge of B that the point lies on, or B's face if it lies on neither.
    pub on_b: Feature,
    /// Point in the world frame, each coordinate rounded to the nearest float. It has the same bits
    /// for every pair of triangles that intersects there.
    pub point: [f64; 3],
}

/// Returns the common points of triangle `a` of mesh A and triangle `b` of mesh B, in the world
/// frame. The corners of each triangle are in the frame of its mesh. Returns `Apart` if and only if
/// [`triangles_intersect`](super::triangles_intersect) is `false`.
///
/// # Accuracy
/// The variant, the features and the order of the ends are exact. The coordinates of the points are
/// the exact ones, rounded to the nearest float.
#[must_use]
pub fn crossing(placement: &Placement, a: &Corners, b: &Corners) -> Crossing {
    let end = |joint: Joint| Endpoint { on_a: joint.on_a, on_b: joint.on_b, point: joint.point(placement, a, b) };
    joints(placement, a, b).map(end)
}

impl<E> Crossing<E> {
    /// Iterates over the ends: two for a segment, one for a point, none otherwise.
    pub(crate) fn ends(&self) -> impl Iterator<Item = &E> {
        let ends = match self {
            Self::Apart | Self::Coplanar => [None, None],
            Self::Point(only) => [Some(only), None],
            Self::Segment(from, to) => [Some(from), Some(to)],
        };
        ends.into_iter().flatten()
    }

    /// Returns this crossing with `end` applied to each of its ends.
    pub(crate) fn map<F>(self, mut end: impl FnMut(E) -> F) -> Crossing<F> {
        match self {
            Self::Apart => Crossing::Apart,
            Self::Point(only) => Crossing::Point(end(only)),
            Self::Segment(from, to) => Crossing::Segment(end(from), end(to)),
            Self::Coplanar => Crossing::Coplanar,
        }
    }
}

/// Returns the same as [`crossing`], with names for the points instead of coordinates. A caller
/// with many pairs can then compute each point once, which takes longer than the decision.
pub(crate) fn joints(placement: &Placement, a: &Corners, b: &Corners) -> Crossing<Joint> {
    let mut corners = PairCorners::new(placement, a, b);
    match Position::of(&mut corners) {
        Position::Apart => Crossing::Apart,
        Position::Crossing(line) => joints_on(&line, &mut corners, placement.world_from_a().mirrors()),
        Position::SegmentOfA(segment) => match passed(segment.pass_edges_of_b(&mut corners)) {
            Some(on_b) => Crossing::Point(Joint { on_a: segment_feature(&segment), on_b, edge_of: Side::A }),
            None => Crossing::Apart,
        },
        Position::SegmentOfB(segment) => match passed(segment.pass_edges_of_a(&mut corners)) {
            Some(on_a) => Crossing::Point(Joint { on_a, on_b: segment_feature(&segment), edge_of: Side::B }),
            None => Crossing::Apart,
        },
        Position::Flat if flat_intersect(&mut corners) => Crossing::Coplanar,
        Position::Flat => Crossing::Apart,
    }
}

/// Returns the common part of the intervals `[a2, a1]` and `[b1, b2]` of the two triangles on their
/// common line.
fn joints_on(line: &CommonLine, corners: &mut PairCorners, mirrors_a: bool) -> Crossing<Joint> {
    let b1_to_a1 = line.compare(corners, 1, 1);
    let b2_to_a2 = line.compare(corners, 2, 2);
    if b1_to_a1 == Positive || b2_to_a2 == Negative {
        return Crossing::Apart;
    }
    let on_a = |end: usize| end_feature(&Transversal { edge: [line.a[0], line.a[end]], sides: line.side_a });
    let on_b = |end: usize| end_feature(&Transversal { edge: [line.b[0], line.b[end]], sides: line.side_b });
    let edge_of_a = |end: usize, on_b: Feature| Joint { on_a: on_a(end), on_b, edge_of: Side::A };
    let edge_of_b = |end: usize, on_a: Feature| Joint { on_a, on_b: on_b(end), edge_of: Side::B };
    let between_a = between_feature(line.a, line.side_a);
    let between_b = between_feature(line.b, line.side_b);

    // The larger of a2 and b1, and the feature of the other triangle that it lies on.
    let start = match line.compare(corners, 1, 2) {
        Negative => edge_of_a(2, if b2_to_a2 == Zero { on_b(2) } else { between_b }),
        Zero => edge_of_a(2, on_b(1)),
        Positive => edge_of_b(1, if b1_to_a1 == Zero { on_a(1) } else { between_a }),
    };
    let is_point =
        b1_to_a1 == Zero || b2_to_a2 == Zero || line.side_a[line.a[0]] == Zero || line.side_b[line.b[0]] == Zero;
    if is_point {
        return Crossing::Point(start);
    }
    // The smaller of a1 and b2. It is not the other end of the other triangle: the piece would then
    // be a point, which was returned above.
    let finish = match line.compare(corners, 2, 1) {
        Positive => edge_of_a(1, between_b),
        Zero => edge_of_a(1, on_b(2)),
        Negative => edge_of_b(2, between_a),
    };
    if line.against_normals != mirrors_a { Crossing::Segment(finish, start) } else { Crossing::Segment(start, finish) }
}

/// Returns the feature at which an edge of a triangle intersects the other's plane: the edge, or
/// its end if that lies on the plane.
fn end_feature(edge: &Transversal) -> Feature {
    let [from, to] = edge.edge;
    if edge.sides[from] == Zero {
        Feature::Vertex(from as u8)
    } else if edge.sides[to] == Zero {
        Feature::Vertex(to as u8)
    } else {
        edge_feature(from, to)
    }
}

/// Returns the feature at which a triangle without area intersects the other's plane. Any of its
/// corners may lie on the plane.
fn segment_feature(segment: &Transversal) -> Feature {
    let on_plane = segment.sides.iter().position(|&side| side == Zero);
    on_plane.map_or_else(|| end_feature(segment), |corner| Feature::Vertex(corner as u8))
}

/// Returns the feature of a triangle that holds the inside of its interval on the common line: its
/// face, or the edge that lies on the line.
fn between_feature([_, p, q]: [usize; 3], sides: [Sign; 3]) -> Feature {
    if sides[p] == Zero && sides[q] == Zero { edge_feature(p, q) } else { Feature::Face }
}

/// Returns the feature of a triangle that a line passes through, or `None` if it misses the
/// triangle. `passes` holds the sides on which the line passes the three edges.
fn passed(passes: [Sign; 3]) -> Option<Feature> {
    if !on_one_side(passes) {
        return None;
    }
    let on_edge = |k: usize| passes[k] == Zero;
    Some(match (0..3).find(|&k| on_edge(k)) {
        None => Feature::Face,
        // Edges 0 and 2 share corner 0. Edges k and k + 1 share corner k + 1.
        Some(0) if on_edge(2) => Feature::Vertex(0),
        Some(k) if k < 2 && on_edge(k + 1) => Feature::Vertex(k as u8 + 1),
        Some(k) => Feature::Edge(k as u8),
    })
}

fn edge_feature(p: usize, q: usize) -> Feature {
    Feature::Edge(if (p + 1) % 3 == q { p } else { q } as u8)
}
