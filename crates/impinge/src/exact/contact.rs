//! Classification of the contact between two faces, as far as it matters to the solids behind them.
//! Interiors can intersect near a contact only if the faces share a segment or an area.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::placement::Placement;
use super::triangles::Position;
use crate::math::Sign::{self, Zero};

/// How two triangles intersect. An edge is given by the indices of its corners, each 0, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contact {
    /// The triangles are disjoint, share only one point, share no area in one plane, or one of them
    /// has no area.
    Slight,
    /// The triangles share a segment that runs within both faces, off their edges.
    Across,
    /// The triangles share a segment that lies on this edge of A and within B's face.
    EdgeOfA([usize; 2]),
    /// The triangles share a segment that lies on this edge of B and within A's face.
    EdgeOfB([usize; 2]),
    /// The triangles share a segment that lies on these edges of A and of B.
    Edges([usize; 2], [usize; 2]),
    /// The triangles lie in one plane and share an area.
    Area {
        /// Whether the corners of both triangles turn the same way in the world frame.
        same_turn: bool,
    },
}

/// Returns how triangle `a` of mesh A and triangle `b` of mesh B intersect. The answer is exact.
/// Corners are given in the frame of their mesh.
pub(crate) fn contact(placement: &Placement, a: &Corners, b: &Corners) -> Contact {
    let mut corners = PairCorners::new(placement, a, b);
    match Position::of(&mut corners) {
        Position::Apart | Position::SegmentOfA(_) | Position::SegmentOfB(_) => Contact::Slight,
        Position::Crossing(line) => {
            if !line.overlap_at_length(&mut corners) {
                return Contact::Slight;
            }
            // Each triangle intersects the common line in one of its edges, or in a segment between
            // the two edges at its apex.
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

/// Reports whether some edge of one triangle has no corner of the other strictly on its inner side,
/// in the projection along `axis`. The interiors of two convex polygons are disjoint if and only if
/// such an edge exists.
fn separated_weakly(corners: &mut PairCorners, axis: usize, turns: [Sign; 2]) -> bool {
    let sets = [[0, 1, 2], [3, 4, 5]];
    (0..2).any(|own| {
        (0..3).any(|k| {
            let (p, q) = (sets[own][k], sets[own][(k + 1) % 3]);
            sets[1 - own].into_iter().all(|corner| corners.orient2d(axis, p, q, corner) != turns[own])
        })
    })
}
