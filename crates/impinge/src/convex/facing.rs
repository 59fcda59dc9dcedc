//! The part of a core that faces along a direction: a corner, an edge or a facet of a polytope. For
//! a round core it is a polygon of its points.

use super::facets::Facets;
use super::posed::{Core, Posed, to_unit_entries, to_unit_length};
use super::short_list::ShortList;
use crate::math::vec3::{cross, dot, length, sub};

/// Maximum sine of the angle between a facet's normal and a direction for the facet to count as
/// facing it, or between an edge and the plane perpendicular to the direction: about 14 degrees. A
/// larger value makes contacts of parts that only lean. A smaller value loses corners of shapes
/// that rock.
const MAX_FACING_SINE: f64 = 0.25;

/// Tilts of the direction that find the border of the part of a round core that faces a plane. The
/// smallest tilt that sees more than one place is the most accurate, so they are tried in ascending
/// order.
const TILTS: [f64; 3] = [1.0 / 65_536.0, 1.0 / 2_048.0, 1.0 / 64.0];

/// Maximum distance of points on a round core that count as one, relative to the core's reach.
const SAME_PLACE_DISTANCE: f64 = 1.0 / 16.0;

/// A corner of the facing part: its number, and its position in the common frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) number: u32,
    pub(super) point: [f64; 3],
}

/// The corners of a facing part. The facets of boxes, and the parts of round cores, have at most
/// eight.
pub(super) type Corners = ShortList<Corner, 8>;

/// The part that faces a direction: a convex polygon, a segment or a point, given by its corners in
/// order.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    pub(super) corners: Corners,
    /// Number of the facet. Meaningful only if there are more than two corners.
    pub(super) facet: u32,
}

fn no_corners() -> Corners {
    ShortList::new(Corner { number: 0, point: [0.0; 3] })
}

/// Returns the part of a core that faces a direction of length 1 in the common frame. Facets are
/// needed for polytopes.
pub(super) fn facing(set: &Posed<'_>, facets: Option<&Facets>, direction: [f64; 3]) -> Facing {
    match facets {
        Some(facets) if !facets.corners.is_empty() => of_polytope(set, facets, direction),
        _ => of_round(set, direction),
    }
}

/// Returns all facets of a polytope that lean towards a direction, the one that leans most first.
/// If there is none, returns the edge or the corner that faces it.
pub(super) fn facing_facets(set: &Posed<'_>, facets: &Facets, direction: [f64; 3]) -> Vec<Facing> {
    let best = of_polytope(set, facets, direction);
    if best.corners.len() < 3 {
        return vec![best];
    }
    let others = (0..facets.outlines.len() as u32)
        .filter(|&facet| facet != best.facet)
        .filter(|&facet| faces(facets.cosine(set, facet, &direction)));
    let others = others.map(|facet| facets.facing(set, facet)).collect::<Vec<_>>();
    std::iter::once(best).chain(others).collect()
}

/// Reports whether a facet with this cosine between its normal and a direction faces it.
fn faces(cosine: f64) -> bool {
    cosine > 0.0 && cosine * cosine >= 1.0 - MAX_FACING_SINE * MAX_FACING_SINE
}

/// Returns the outward normals of all facets of a core, of length 1 in the common frame.
pub(super) fn facet_normals(set: &Posed<'_>, facets: &Facets) -> Vec<[f64; 3]> {
    (0..facets.outlines.len() as u32).map(|facet| facets.normal(set, facet)).collect()
}

impl Facets {
    /// Returns the cosine of the angle between the outward normal of a facet and a direction.
    fn cosine(&self, set: &Posed<'_>, facet: u32, direction: &[f64; 3]) -> f64 {
        dot(direction, &self.normal(set, facet))
    }

    fn normal(&self, set: &Posed<'_>, facet: u32) -> [f64; 3] {
        let outline = self.outlines.list(facet).iter().map(|&corner| set.spot(self.corners[corner as usize].1).point);
        let outward = if set.pose().mirrors() { -1.0 } else { 1.0 };
        to_unit_length(vector_area(outline).map(|x| outward * x))
    }

    fn facing(&self, set: &Posed<'_>, facet: u32) -> Facing {
        let corner = |&corner: &u32| {
            let (number, local) = self.corners[corner as usize];
            Corner { number, point: set.spot(local).point }
        };
        let mut corners = no_corners();
        corners.extend(self.outlines.list(facet).iter().map(corner));
        Facing { corners, facet }
    }
}

fn of_polytope(set: &Posed<'_>, facets: &Facets, direction: [f64; 3]) -> Facing {
    let point = |corner: u32| set.spot(facets.corners[corner as usize].1).point;
    let corner = |corner: u32| Corner { number: facets.corners[corner as usize].0, point: point(corner) };
    let farthest = match set.core() {
        Core::Hull(_) => set.farthest_vertex(direction),
        _ => {
            let height = |&corner: &u32| dot(&direction, &point(corner));
            (0..facets.corners.len() as u32).max_by(|x, y| height(x).total_cmp(&height(y)).then(y.cmp(x))).unwrap_or(0)
        }
    };
    let facet = facets.facets_at.list(farthest).iter().map(|&facet| (facets.cosine(set, facet, &direction), facet));
    let facet = facet.max_by(|x, y| x.0.total_cmp(&y.0).then(y.1.cmp(&x.1)));
    if let Some((cosine, facet)) = facet
        && faces(cosine)
    {
        return facets.facing(set, facet);
    }
    let sine = |other: u32| dot(&direction, &to_unit_length(sub(&point(other), &point(farthest)))).abs();
    let edge = facets.neighbors.list(farthest).iter().map(|&other| (sine(other), other));
    let edge = edge.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1))).filter(|edge| edge.0 <= MAX_FACING_SINE);
    let mut corners = no_corners();
    corners.extend(std::iter::once(corner(farthest)).chain(edge.map(|(_, other)| corner(other))));
    Facing { corners, facet: 0 }
}

/// Returns the farthest points along eight directions about the given one, numbered by direction,
/// if they are in more than one place. Otherwise returns one point with number 8.
fn of_round(set: &Posed<'_>, direction: [f64; 3]) -> Facing {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const TURNS: [[f64; 2]; 8] =
        [[1.0, 0.0], [HALF, HALF], [0.0, 1.0], [-HALF, HALF], [-1.0, 0.0], [-HALF, -HALF], [0.0, -1.0], [HALF, -HALF]];
    let along = set.turned(direction);
    let axis = (0..3).max_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs()).then(j.cmp(&i))).unwrap_or(0);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let near = SAME_PLACE_DISTANCE * set.reach();
    for tilt in TILTS {
        let mut corners = no_corners();
        for (number, turn) in (0..).zip(TURNS) {
            let mut tilted = along;
            tilted[i] += tilt * turn[0];
            tilted[j] += tilt * turn[1];
            let point = set.spot(set.farthest_local(to_unit_entries(tilted))).point;
            if corners.iter().all(|known| length(&sub(&known.point, &point)) > near) {
                corners.push(Corner { number, point });
            }
        }
        if corners.len() > 1 {
            return Facing { corners, facet: 0 };
        }
    }
    {
        let mut corners = no_corners();
        corners.push(Corner { number: 8, point: set.support(direction).point });
        Facing { corners, facet: 0 }
    }
}

/// Returns the vector area of a polygon times 2.
fn vector_area(mut outline: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    let Some(first) = outline.next() else { return [0.0; 3] };
    let mut area = [0.0; 3];
    let mut before = [0.0; 3];
    for point in outline {
        let from_first = sub(&point, &first);
        let triangle = cross(&before, &from_first);
        area = std::array::from_fn(|k| area[k] + triangle[k]);
        before = from_first;
    }
    area
}
