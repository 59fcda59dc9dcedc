//! Of what kind the contact of two faces is, as far as it matters to the solids behind them: only where they meet at
//! length or in an area can interiors meet there and nowhere near.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::placement::Placement;
use super::triangles::Position;
use crate::math::Sign::{self, Zero};

/// How two triangles meet; edges are named by the numbers of their corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contact {
    /// Not at all, in a point, or with a triangle without area.
    Slight,
    /// In a segment that runs within both, off their edges.
    Across,
    /// In a segment of this edge of A, within B.
    EdgeOfA([usize; 2]),
    /// In a segment of this edge of B, within A.
    EdgeOfB([usize; 2]),
    /// In a segment of these edges of both.
    Edges([usize; 2], [usize; 2]),
    /// In an area.
    Area {
        /// Whether the corners of both turn the same way there, in the world.
        same_turn: bool,
    },
}

/// How triangle `a` of mesh A and triangle `b` of mesh B meet, exactly.
pub(crate) fn contact(placement: &Placement, a: &Corners, b: &Corners) -> Contact {
    let mut corners = PairCorners::new(placement, a, b);
    match Position::of(&mut corners) {
        Position::Apart | Position::SegmentOfA(_) | Position::SegmentOfB(_) => Contact::Slight,
        Position::Crossing(line) => {
            if !line.overlap_at_length(&mut corners) {
                return Contact::Slight;
            }
            // Each meets the common line in an edge, or in a segment between its apex's edges.
            let edge =
                |[_, p, q]: [usize; 3], sides: [Sign; 3]| (sides[p] == Zero && sides[q] == Zero).then_some([p, q]);
            match (edge(line.a, line.side_a), edge(line.b, line.side_b)) {
                (None, None) => Contact::Across,
                (Some(edge_a), None) => Contact::EdgeOfA(edge_a),
                (None, Some(edge_b)) => Contact::EdgeOfB(edge_b),
                (Some(edge_a), Some(edge_b)) => Contact::Edges(edge_a, edge_b),
            }
        }
        Position::Flat => in_one_plane(&mut corners),
    }
}

fn in_one_plane(corners: &mut PairCorners) -> Contact {
    for axis in 0..3 {
        let turns = [corners.orient2d(axis, 0, 1, 2), corners.orient2d(axis, 3, 4, 5)];
        if turns != [Zero; 2] {
            let has_area = !turns.contains(&Zero) && !separated_weakly(corners, axis, turns);
            return if has_area { Contact::Area { same_turn: turns[0] == turns[1] } } else { Contact::Slight };
        }
    }
    Contact::Slight
}

/// Whether an edge of one has none of the other strictly on the inner side: the interiors of convex polygons are apart
/// exactly then.
fn separated_weakly(corners: &mut PairCorners, axis: usize, turns: [Sign; 2]) -> bool {
    let sets = [[0, 1, 2], [3, 4, 5]];
    (0..2).any(|own| {
        (0..3).any(|k| {
            let (p, q) = (sets[own][k], sets[own][(k + 1) % 3]);
            sets[1 - own].into_iter().all(|corner| corners.orient2d(axis, p, q, corner) != turns[own])
        })
    })
}
