//! In what two triangles meet: the piece of an intersection curve that one pair contributes.
//!
//! The decision is that of `triangles`, asked for all four comparisons on the common line instead of
//! two. Where the piece ends is said combinatorially, by the corner, edge or face of each triangle that it ends on, so
//! the pieces of neighbouring pairs link up without comparing coordinates, in touching and degenerate positions too.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::feature::Feature;
use super::joint::{Joint, Side};
use super::placement::Placement;
use super::triangles::{CommonLine, Position, Transversal, flat_meet, on_one_side};
use crate::math::Sign::{self, Negative, Positive, Zero};

/// What two triangles have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossing<E = Endpoint> {
    /// Nothing.
    Apart,
    /// A point, the triangles being in different planes or one of them having no area.
    Point(E),
    /// A segment, the triangles being in different planes. It runs along `normal_a × normal_b` in the world frame, each
    /// normal being that of the corners in their order by the right-hand rule.
    Segment(E, E),
    /// Some set of points within one plane that holds both triangles, or the common points of two triangles that both
    /// have no area.
    Coplanar,
}

/// A point where a piece of an intersection curve ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Endpoint {
    /// The corner or edge of A that the point is on, or A's face where it is on neither.
    pub on_a: Feature,
    /// The corner or edge of B that the point is on, or B's face where it is on neither.
    pub on_b: Feature,
    /// The point in the world frame, each coordinate rounded to the nearest float. It has the same bits for every pair
    /// of triangles that meets there.
    pub point: [f64; 3],
}

/// In what triangle `a` of mesh A and triangle `b` of mesh B meet; `Apart` exactly where
/// [`triangles_intersect`](super::triangles_intersect) is false.
///
/// # Accuracy
/// Everything but the coordinates of the points is exact; those are the exact ones, rounded to the nearest float.
#[must_use]
pub fn crossing(placement: &Placement, a: &Corners, b: &Corners) -> Crossing {
    let end = |joint: Joint| Endpoint { on_a: joint.on_a, on_b: joint.on_b, point: joint.point(placement, a, b) };
    joints(placement, a, b).map(end)
}

impl<E> Crossing<E> {
    /// Where it begins and ends, of a segment, or the only point.
    pub(crate) fn ends(&self) -> impl Iterator<Item = &E> {
        let ends = match self {
            Self::Apart | Self::Coplanar => [None, None],
            Self::Point(only) => [Some(only), None],
            Self::Segment(from, to) => [Some(from), Some(to)],
        };
        ends.into_iter().flatten()
    }

    /// The same with other ends.
    pub(crate) fn map<F>(self, mut end: impl FnMut(E) -> F) -> Crossing<F> {
        match self {
            Self::Apart => Crossing::Apart,
            Self::Point(only) => Crossing::Point(end(only)),
            Self::Segment(from, to) => Crossing::Segment(end(from), end(to)),
            Self::Coplanar => Crossing::Coplanar,
        }
    }
}

/// [`crossing`], with names for points: who has many pairs computes each point once, which takes longer than the decision.
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
        Position::Flat if flat_meet(&mut corners) => Crossing::Coplanar,
        Position::Flat => Crossing::Apart,
    }
}

/// The common part of the intervals `[a2, a1]` and `[b1, b2]` that both triangles have on their common line.
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

    // The larger of a2 and b1, and which part of the other triangle it is on.
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
    // The smaller of a1 and b2. Were it the other end of the other triangle too, the piece would be a point.
    let finish = match line.compare(corners, 2, 1) {
        Positive => edge_of_a(1, between_b),
        Zero => edge_of_a(1, on_b(2)),
        Negative => edge_of_b(2, between_a),
    };
    if line.against_normals != mirrors_a { Crossing::Segment(finish, start) } else { Crossing::Segment(start, finish) }
}

/// What an edge of a triangle meets the other's plane in: the edge, or an end that is on the plane.
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

/// What a triangle without area meets the other's plane in: any of its corners may be on the plane.
fn segment_feature(segment: &Transversal) -> Feature {
    let on_plane = segment.sides.iter().position(|&side| side == Zero);
    on_plane.map_or_else(|| end_feature(segment), |corner| Feature::Vertex(corner as u8))
}

/// What a triangle meets the common line in between its two ends: its face, or the edge that is on the line.
fn between_feature([_, p, q]: [usize; 3], sides: [Sign; 3]) -> Feature {
    if sides[p] == Zero && sides[q] == Zero { edge_feature(p, q) } else { Feature::Face }
}

/// What a line meets a triangle in that passes its edges on these sides, or nothing where it misses.
fn passed(passes: [Sign; 3]) -> Option<Feature> {
    if !on_one_side(passes) {
        return None;
    }
    let on_edge = |k: usize| passes[k] == Zero;
    Some(match (0..3).find(|&k| on_edge(k)) {
        None => Feature::Face,
        // Edges 0 and 2 share corner 0; others share the corner after the first.
        Some(0) if on_edge(2) => Feature::Vertex(0),
        Some(k) if k < 2 && on_edge(k + 1) => Feature::Vertex(k as u8 + 1),
        Some(k) => Feature::Edge(k as u8),
    })
}

fn edge_feature(p: usize, q: usize) -> Feature {
    Feature::Edge(if (p + 1) % 3 == q { p } else { q } as u8)
}
