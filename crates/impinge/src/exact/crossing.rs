//! In what two triangles meet: the piece of an intersection curve that one pair contributes.
//!
//! The decision is that of `triangles`, asked for all four comparisons on the common line instead of
//! two. Where the piece ends is said combinatorially, by the corner, edge or face of each triangle that it ends on, so
//! the pieces of neighbouring pairs link up without comparing coordinates, in touching and degenerate positions too.

use super::corners::{Corners, PairCorners};
use super::double_double::{self, DoubleDouble};
use super::placement::{Placement, world_point};
use super::triangles::{CommonLine, Position, Transversal, flat_meet, on_one_side};
use crate::math::Pose;
use crate::math::Sign::{self, Negative, Positive, Zero};
use crate::math::dyadic::{self, Dyadic};

/// What two triangles have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossing {
    /// Nothing.
    Apart,
    /// A point, the triangles being in different planes or one of them having no area.
    Point(Endpoint),
    /// A segment, the triangles being in different planes. It runs along `normal_a × normal_b` in the world frame, each
    /// normal being that of the corners in their order by the right-hand rule.
    Segment(Endpoint, Endpoint),
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

/// A part of a triangle. Where a triangle has no area, the names of its parts are not unique: a point that is on two
/// overlapping edges is said to be on one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// The corner of this number.
    Vertex(u8),
    /// The edge from the corner of this number to the next, without its ends.
    Edge(u8),
    /// The triangle without its edges.
    Face,
}

/// In what triangle `a` of mesh A and triangle `b` of mesh B meet; `Apart` exactly where
/// [`triangles_intersect`](super::triangles_intersect) is false.
///
/// # Accuracy
/// Everything but the coordinates of the points is exact; those are the exact ones, rounded to the nearest float.
#[must_use]
pub fn crossing(placement: &Placement, a: &Corners, b: &Corners) -> Crossing {
    let mut corners = PairCorners::new(placement, a, b);
    let world = || World::new(placement, a, b);
    match Position::of(&mut corners) {
        Position::Apart => Crossing::Apart,
        Position::Crossing(line) => crossing_on(&line, &mut corners, world),
        Position::SegmentOfA(segment) => match passed(segment.pass_edges_of_b(&mut corners)) {
            Some(on_b) => Crossing::Point(world().endpoint_on_edge_of_a(segment_feature(&segment), on_b, segment.edge)),
            None => Crossing::Apart,
        },
        Position::SegmentOfB(segment) => match passed(segment.pass_edges_of_a(&mut corners)) {
            Some(on_a) => Crossing::Point(world().endpoint_on_edge_of_b(on_a, segment_feature(&segment), segment.edge)),
            None => Crossing::Apart,
        },
        Position::Flat if flat_meet(&mut corners) => Crossing::Coplanar,
        Position::Flat => Crossing::Apart,
    }
}

/// The common part of the intervals `[a2, a1]` and `[b1, b2]` that both triangles have on their common line.
fn crossing_on<'p>(line: &CommonLine, corners: &mut PairCorners, world: impl Fn() -> World<'p>) -> Crossing {
    let b1_to_a1 = line.compare(corners, 1, 1);
    let b2_to_a2 = line.compare(corners, 2, 2);
    if b1_to_a1 == Positive || b2_to_a2 == Negative {
        return Crossing::Apart;
    }
    let world = world();
    let end_a = |end: usize| Transversal { edge: [line.a[0], line.a[end]], sides: line.side_a };
    let end_b = |end: usize| Transversal { edge: [line.b[0], line.b[end]], sides: line.side_b };
    let on_a = |end: usize| end_feature(&end_a(end));
    let on_b = |end: usize| end_feature(&end_b(end));
    let between_a = between_feature(line.a, line.side_a);
    let between_b = between_feature(line.b, line.side_b);

    // The larger of a2 and b1, and which part of the other triangle it is on.
    let start = match line.compare(corners, 1, 2) {
        Negative => {
            let other = if b2_to_a2 == Zero { on_b(2) } else { between_b };
            world.endpoint_on_edge_of_a(on_a(2), other, end_a(2).edge)
        }
        Zero => world.endpoint_on_edge_of_a(on_a(2), on_b(1), end_a(2).edge),
        Positive => {
            let other = if b1_to_a1 == Zero { on_a(1) } else { between_a };
            world.endpoint_on_edge_of_b(other, on_b(1), end_b(1).edge)
        }
    };
    let is_point =
        b1_to_a1 == Zero || b2_to_a2 == Zero || line.side_a[line.a[0]] == Zero || line.side_b[line.b[0]] == Zero;
    if is_point {
        return Crossing::Point(start);
    }
    // The smaller of a1 and b2. Were it the other end of the other triangle too, the piece would be a point.
    let finish = match line.compare(corners, 2, 1) {
        Positive => world.endpoint_on_edge_of_a(on_a(1), between_b, end_a(1).edge),
        Zero => world.endpoint_on_edge_of_a(on_a(1), on_b(2), end_a(1).edge),
        Negative => world.endpoint_on_edge_of_b(between_a, on_b(2), end_b(2).edge),
    };
    if line.against_normals != world.mirrors_a {
        Crossing::Segment(finish, start)
    } else {
        Crossing::Segment(start, finish)
    }
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

/// The two triangles as they are in the world.
struct World<'p> {
    poses: [&'p Pose; 2],
    /// The corners of A and of B, each in its own frame.
    corners: [&'p Corners; 2],
    mirrors_a: bool,
}

impl<'p> World<'p> {
    fn new(placement: &'p Placement, a: &'p Corners, b: &'p Corners) -> Self {
        let poses = [placement.world_from_a(), placement.world_from_b()];
        Self { poses, corners: [a, b], mirrors_a: poses[0].mirrors() }
    }

    /// The end where this edge of A meets B's plane.
    fn endpoint_on_edge_of_a(&self, on_a: Feature, on_b: Feature, edge: [usize; 2]) -> Endpoint {
        Endpoint { on_a, on_b, point: self.vertex_point(on_a, on_b).unwrap_or_else(|| self.nearest_on_plane(0, edge)) }
    }

    /// The end where this edge of B meets A's plane.
    fn endpoint_on_edge_of_b(&self, on_a: Feature, on_b: Feature, edge: [usize; 2]) -> Endpoint {
        Endpoint { on_a, on_b, point: self.vertex_point(on_a, on_b).unwrap_or_else(|| self.nearest_on_plane(1, edge)) }
    }

    fn vertex_point(&self, on_a: Feature, on_b: Feature) -> Option<[f64; 3]> {
        let (side, corner) = match (on_a, on_b) {
            (Feature::Vertex(i), _) => (0, usize::from(i)),
            (_, Feature::Vertex(j)) => (1, usize::from(j)),
            _ => return None,
        };
        let (pose, corner) = (self.poses[side], &self.corners[side][corner]);
        Some(settled(&DoubleDouble::world_point(pose, corner)).unwrap_or_else(|| {
            let one = Dyadic::from_f64(1.0);
            world_point(pose, corner).each_ref().map(|x| Dyadic::nearest_quotient(x, &one))
        }))
    }

    /// The point where an edge of A (`side` 0) or of B (1), whose ends are on different sides, meets the plane of the other triangle,
    /// rounded. With the heights `h` of its ends p and q it is `(h_p q - h_q p) / (h_p - h_q)`.
    fn nearest_on_plane(&self, side: usize, edge: [usize; 2]) -> [f64; 3] {
        let ends = edge.map(|corner| &self.corners[side][corner]);
        let (pose, pose_of_plane) = (self.poses[side], self.poses[1 - side]);
        let rough = || {
            let [p, q] = ends.map(|end| DoubleDouble::world_point(pose, end));
            let plane =
                self.corners[1 - side].each_ref().map(|corner| DoubleDouble::world_point(pose_of_plane, corner));
            let from_first = |x: &[DoubleDouble; 3]| double_double::difference(x, &plane[0]);
            let normal = double_double::cross(&from_first(&plane[1]), &from_first(&plane[2]));
            let [h_p, h_q] = [&p, &q].map(|end| double_double::dot(&normal, &from_first(end)));
            let denominator = h_p.minus(&h_q);
            let numerator = |k: usize| h_p.times(&q[k]).minus(&h_q.times(&p[k]));
            settled(&[0, 1, 2].map(|k| numerator(k).over(&denominator)))
        };
        rough().unwrap_or_else(|| {
            let [p, q] = ends.map(|end| world_point(pose, end));
            let plane = self.corners[1 - side].each_ref().map(|corner| world_point(pose_of_plane, corner));
            exactly_nearest_on_plane(&p, &q, &plane)
        })
    }
}

/// A point rounded to nearest, where that is settled.
fn settled([x, y, z]: &[DoubleDouble; 3]) -> Option<[f64; 3]> {
    Some([x.nearest()?, y.nearest()?, z.nearest()?])
}

#[cold]
fn exactly_nearest_on_plane(p: &[Dyadic; 3], q: &[Dyadic; 3], plane: &[[Dyadic; 3]; 3]) -> [f64; 3] {
    let from_first = |x: &[Dyadic; 3]| [&x[0] - &plane[0][0], &x[1] - &plane[0][1], &x[2] - &plane[0][2]];
    let normal = dyadic::cross(&from_first(&plane[1]), &from_first(&plane[2]));
    let (h_p, h_q) = (dyadic::dot(&normal, &from_first(p)), dyadic::dot(&normal, &from_first(q)));
    let denominator = &h_p - &h_q;
    std::array::from_fn(|k| {
        let numerator = &(&h_p * &q[k]) - &(&h_q * &p[k]);
        Dyadic::nearest_quotient(&numerator, &denominator)
    })
}
