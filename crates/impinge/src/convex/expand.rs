//! The expanding polytope, grown facet by facet: how deep the origin is in the set of differences of two cores.
//!
//! The polytope is a list of oriented triangles that is closed: every directed edge is linked with one that is its reverse. A step takes
//! the nearest triangle, finds the farthest difference along its normal, and puts a cone from there over the border of the triangles
//! around that see it. The border of any triangles is closed, so whichever are taken, the list stays so; which ones see a point is a
//! matter of floats and may be wrong. What is proved needs no more: where all triangles of a closed list have the origin at least
//! ρ > 0 below their planes, their hull holds the ball of ρ about the origin (docs/proof.md, L29). Where that does not come
//! about, for sets without a volume or an origin on their border, the hulls of `depth` take over.
//!
//! # Source
//! Van den Bergen, *Proximity queries and penetration depth computation on 3D game objects*, GDC 2001, whose polytope has to stay
//! convex; ours only has to stay closed.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::facet::Facet;
use super::posed::{Difference, Pair};
use super::simplex;
use crate::primitive::{dot, length};

/// How far below a triangle's plane a point may be for the triangle to see it still, in the common unit: 2^-48. What is in the plane
/// but for rounding is replaced with the rest: were it kept, cones over it would have triangles without area.
const IN_PLANE: f64 = 16.0 * f64::EPSILON;

/// A triangle without area is farther from the origin than this, in the common unit, or nothing is proved: 2^-20.
const FAR: f64 = 1.0 / (1 << 20) as f64;

/// Triangles for each point, of which a surface without handles has fewer than two: beyond this rounding has made several layers of
/// them, each step of which may treble their number, and nothing more comes of it.
const TANGLED: usize = 4;

/// A closed list of triangles about the origin.
pub(super) struct Polytope {
    points: Vec<Difference>,
    /// The points' vectors, side by side, as every step looks at all of them.
    vectors: Vec<[f64; 3]>,
    /// Those that are no longer in the list keep their places until others need them.
    triangles: Vec<Triangle>,
    vacant: Vec<u32>,
    /// The triangles by what they bound, and some that have left the list.
    order: BinaryHeap<Entry>,
    /// What a step works on, kept for its memory.
    removed: Vec<u32>,
    border: Vec<BorderEdge>,
    unlinked: Vec<Unlinked>,
}

#[derive(Clone, Copy)]
struct Triangle {
    corners: [u32; 3],
    /// Beyond the edge from each corner to the next.
    neighbours: [Side; 3],
    is_listed: bool,
    direction: [f64; 3],
    /// How far below the plane the origin is at least; infinite for a triangle without area, which bounds nothing, and negative
    /// infinity where that may hold the origin.
    lower: f64,
    /// The height of the plane along the direction, which has no length of 1.
    height: f64,
}

/// An edge of a triangle: from the corner of that number to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    triangle: u32,
    edge: u8,
}

/// An edge of removed triangles, and what is beyond.
struct BorderEdge {
    ends: [u32; 2],
    beyond: Side,
}

/// An edge whose reverse has not come yet.
struct Unlinked {
    ends: [u32; 2],
    side: Side,
}

/// Ordered so that the least bound is the greatest entry; of equal ones the first triangle.
#[derive(PartialEq)]
struct Entry {
    lower: f64,
    triangle: u32,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower).then(other.triangle.cmp(&self.triangle))
    }
}

/// The triangle that is nearest to the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The ball of this radius is in the hull of the points, as computed; where it is zero or less nothing is proved.
    pub(super) lower: f64,
    /// Across the triangle, outwards; its greatest entry is ±1.
    pub(super) direction: [f64; 3],
    at: u32,
    corners: [u32; 3],
}

impl Polytope {
    /// The tetrahedron of four differences, if it holds the origin well inside.
    pub(super) fn of_simplex(simplex: &[Difference]) -> Option<Self> {
        let [p, q, r, s] = *<&[Difference; 4]>::try_from(simplex).ok()?;
        let inside = |corners: [[u32; 3]; 4]| {
            let polytope = Self::new(vec![p, q, r, s], &corners);
            polytope
                .triangles
                .iter()
                .all(|triangle| triangle.lower > 0.0 && triangle.lower.is_finite())
                .then_some(polytope)
        };
        inside([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
            .or_else(|| inside([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    }

    /// The closed surface of these triangles.
    pub(super) fn new(points: Vec<Difference>, faces: &[[u32; 3]]) -> Self {
        let mut polytope = Self {
            vectors: points.iter().map(|point| point.vector).collect(),
            points,
            triangles: Vec::with_capacity(64),
            vacant: Vec::new(),
            order: BinaryHeap::with_capacity(64),
            removed: Vec::new(),
            border: Vec::new(),
            unlinked: Vec::new(),
        };
        for &face in faces {
            let triangle = polytope.push(face);
            for edge in 0..3 {
                polytope.link_with_reverse(Side { triangle, edge });
            }
        }
        polytope
    }

    /// The triangle that bounds least.
    pub(super) fn nearest(&mut self) -> Option<Nearest> {
        loop {
            let &Entry { lower, triangle: at } = self.order.peek()?;
            let triangle = &self.triangles[at as usize];
            if triangle.is_listed && triangle.lower == lower {
                let Triangle { direction, corners, .. } = *triangle;
                return lower.is_finite().then_some(Nearest { lower, direction, at, corners });
            }
            self.order.pop();
        }
    }

    /// Grows to a point that is beyond the plane of a triangle. False where it is a corner already, or there are as many as may be.
    /// False, too, where the surface is tangled. It is then of no more use.
    pub(super) fn grow(&mut self, beyond: &Nearest, point: Difference, most_points: usize) -> bool {
        let [x, y, z] = point.vector;
        if self.points.len() >= most_points || self.vectors.iter().any(|v| v[0] == x && v[1] == y && v[2] == z) {
            return false;
        }
        let number = self.points.len() as u32;
        self.points.push(point);
        self.vectors.push(point.vector);
        self.remove_seen(beyond.at, &point.vector);
        let listed = self.triangles.len() - self.vacant.len();
        if listed + self.border.len() > TANGLED * self.points.len() {
            return false;
        }
        let mut border = std::mem::take(&mut self.border);
        for BorderEdge { ends: [from, to], beyond } in border.drain(..) {
            let triangle = self.push([from, to, number]);
            self.link(Side { triangle, edge: 0 }, beyond);
            self.link_with_reverse(Side { triangle, edge: 1 });
            self.link_with_reverse(Side { triangle, edge: 2 });
        }
        self.border = border;
        true
    }

    /// The points of A and of B whose difference is the nearest of a triangle.
    pub(super) fn foot(&self, nearest: &Nearest) -> [[f64; 3]; 2] {
        let corners = nearest.corners.map(|corner| self.points[corner as usize]);
        super::gjk::means(&corners, &simplex::nearest(&corners.map(|corner| corner.vector)).weights)
    }

    /// Removes a triangle, those that see a point and are reached from there over others that do, and triangles without area between
    /// them, which see nothing and would only be in the way; their border is kept.
    fn remove_seen(&mut self, first: u32, point: &[f64; 3]) {
        self.triangles[first as usize].is_listed = false;
        self.removed.push(first);
        while let Some(at) = self.removed.pop() {
            let Triangle { corners, neighbours, .. } = self.triangles[at as usize];
            for edge in 0..3 {
                let beyond = neighbours[edge];
                let next = &mut self.triangles[beyond.triangle as usize];
                if !next.is_listed {
                    continue;
                }
                if next.height == f64::INFINITY || dot(&next.direction, point) - next.height >= -IN_PLANE {
                    next.is_listed = false;
                    self.removed.push(beyond.triangle);
                } else {
                    self.border.push(BorderEdge { ends: [corners[edge], corners[(edge + 1) % 3]], beyond });
                }
            }
            self.vacant.push(at);
        }
    }

    fn push(&mut self, corners: [u32; 3]) -> u32 {
        let [a, b, c] = corners.map(|corner| self.vectors[corner as usize]);
        let (direction, lower, height) = match Facet::of(&a, &b, &c) {
            Some(Facet { direction, lower }) => (direction, lower, dot(&direction, &a)),
            // Far from the origin it covers no direction of its own; near, nothing is proved any more.
            None => {
                let away = length(&simplex::nearest(&[a, b, c]).vector);
                ([0.0; 3], if away > FAR { f64::INFINITY } else { f64::NEG_INFINITY }, f64::INFINITY)
            }
        };
        let at = self.vacant.pop().unwrap_or(self.triangles.len() as u32);
        let neighbours = [0, 1, 2].map(|edge| Side { triangle: at, edge });
        let triangle = Triangle { corners, neighbours, is_listed: true, direction, lower, height };
        match self.triangles.get_mut(at as usize) {
            Some(place) => *place = triangle,
            None => self.triangles.push(triangle),
        }
        self.order.push(Entry { lower, triangle: at });
        at
    }

    fn link(&mut self, one: Side, other: Side) {
        self.triangles[one.triangle as usize].neighbours[usize::from(one.edge)] = other;
        self.triangles[other.triangle as usize].neighbours[usize::from(other.edge)] = one;
    }

    /// Links an edge with one that is its reverse, now or when that comes. Which one does not matter where there are several.
    fn link_with_reverse(&mut self, side: Side) {
        let (corners, edge) = (self.triangles[side.triangle as usize].corners, usize::from(side.edge));
        let [from, to] = [corners[edge], corners[(edge + 1) % 3]];
        match self.unlinked.iter().rposition(|other| other.ends == [to, from]) {
            Some(reverse) => {
                let other = self.unlinked.swap_remove(reverse).side;
                self.link(side, other);
            }
            None => self.unlinked.push(Unlinked { ends: [from, to], side }),
        }
    }
}

/// Whether the cores certainly have a common point: a polytope of differences is about the origin, by more than these may be off. It
/// grows by a few points where it is not so at once, as for shapes that stand alike, whose first differences have the origin on
/// their border.
pub(super) fn certainly_meet(pair: &Pair<'_>, simplex: &[Difference]) -> bool {
    const MOST_POINTS: usize = 48;
    let Some(mut polytope) = about_origin(pair, simplex) else { return false };
    while let Some(nearest) = polytope.nearest() {
        if nearest.lower > pair.point_error() {
            return true;
        }
        if !polytope.grow(&nearest, pair.support(nearest.direction), MOST_POINTS) {
            break;
        }
    }
    false
}

/// A polytope about the origin, from what the distance left.
pub(super) fn about_origin(pair: &Pair<'_>, simplex: &[Difference]) -> Option<Polytope> {
    if let Some(polytope) = Polytope::of_simplex(simplex) {
        return Some(polytope);
    }
    // The border or an edge of the set is near: a hull of more points, in directions that boxes have no facets across.
    let mut points = simplex.to_vec();
    for direction in DIRECTIONS {
        for direction in [direction, direction.map(|x| -x)] {
            let point = pair.support(direction);
            if points.iter().all(|known| known.vector != point.vector) {
                points.push(point);
            }
        }
    }
    let vectors: Vec<[f64; 3]> = points.iter().map(|point| point.vector).collect();
    let hull = crate::hull::Hull::new(&vectors).ok()?;
    (hull.kind() == crate::hull::HullKind::Solid).then(|| {
        let points = hull.vertices().iter().map(|&vertex| points[vertex as usize]).collect();
        Polytope::new(points, hull.faces())
    })
}

/// Seven directions, of which no plane holds more than three.
const DIRECTIONS: [[f64; 3]; 7] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.875, 0.75],
    [-1.0, 0.875, 0.75],
    [1.0, -0.875, 0.75],
    [1.0, 0.875, -0.75],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::posed::Spot;

    fn difference(vector: [f64; 3]) -> Difference {
        let spot = |point| Spot { local: point, point };
        Difference { a: spot(vector), b: spot([0.0; 3]), vector }
    }

    /// However points come, every directed edge is as often there as its reverse.
    #[test]
    fn the_surface_stays_closed() {
        let corners = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]];
        let mut polytope = Polytope::of_simplex(&corners.map(difference)).expect("about the origin");
        let mut grown = 0;
        for step in 0..60_u32 {
            // On grids that become larger, so that many are in planes of facets and still beyond others.
            let digit = |at: u32| f64::from(1 + step / 6) * (f64::from((step * 7 + at * step) % 5) - 2.0);
            let Some(nearest) = polytope.nearest() else { break };
            grown += u32::from(polytope.grow(&nearest, difference([digit(1), digit(3), digit(5)]), 64));
            let mut edges: Vec<[u32; 2]> = Vec::new();
            assert!(polytope.unlinked.is_empty());
            for triangle in polytope.triangles.iter().filter(|triangle| triangle.is_listed) {
                let [p, q, r] = triangle.corners;
                edges.extend([[p, q], [q, r], [r, p]]);
                for (edge, side) in triangle.neighbours.iter().enumerate() {
                    let other = &polytope.triangles[side.triangle as usize];
                    let [from, to] =
                        [other.corners[usize::from(side.edge)], other.corners[usize::from(side.edge + 1) % 3]];
                    assert!(
                        other.is_listed && [to, from] == [triangle.corners[edge], triangle.corners[(edge + 1) % 3]]
                    );
                }
            }
            let mut reversed: Vec<[u32; 2]> = edges.iter().map(|&[from, to]| [to, from]).collect();
            edges.sort_unstable();
            reversed.sort_unstable();
            assert_eq!(edges, reversed);
        }
        assert!(grown > 20, "{grown}");
    }
}
