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
use super::posed::Difference;
use super::simplex;
use crate::math::vec3::{cross, dot, length, sub};

/// How far from a triangle's plane a point counts as in it, in the common unit: 2^-48.
const IN_PLANE: f64 = 16.0 * f64::EPSILON;

/// How high a triangle is on its longest edge at least, next to that, to be put beside another in its plane: 2^-30. What would be flatter
/// is put over both instead.
const FLAT: f64 = 1.0 / (1 << 30) as f64;

/// A triangle without area is farther from the origin than this, in the common unit, or nothing is proved: 2^-20.
const FAR: f64 = 1.0 / (1 << 20) as f64;

/// Planes are met at one place by a direction where they are so far along it but for this, next to that: 2^-30.
const SAME: f64 = 1.0 / (1 << 30) as f64;

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
}

impl Polytope {
    /// The hull of four differences and some more, if it holds the origin well inside.
    pub(super) fn about_origin(points: &[Difference]) -> Option<Self> {
        let (&[p, q, r, s], more) = points.split_first_chunk()?;
        let is_above = Facet::of(&p.vector, &q.vector, &r.vector)
            .is_some_and(|facet| dot(&facet.direction, &sub(&s.vector, &p.vector)) > 0.0);
        let [q, r] = if is_above { [r, q] } else { [q, r] };
        let mut polytope = Self::new(vec![p, q, r, s], &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
        for point in more {
            let seen = polytope.seen_from(&point.vector);
            if seen.is_some_and(|at| !polytope.put_over(at, *point)) {
                return None;
            }
        }
        let is_beyond = |triangle: &Triangle| triangle.lower > 0.0 && triangle.lower.is_finite();
        polytope.triangles.iter().filter(|triangle| triangle.is_listed).all(is_beyond).then_some(polytope)
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
                let direction = triangle.direction;
                return lower.is_finite().then_some(Nearest { lower, direction, at });
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
        self.put_over(beyond.at, point)
    }

    /// Puts a new point over a triangle that it is beyond, and those around that see it too. False where the surface is tangled.
    fn put_over(&mut self, at: u32, point: Difference) -> bool {
        let number = self.points.len() as u32;
        self.points.push(point);
        self.vectors.push(point.vector);
        self.remove_seen(at, &point.vector);
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

    /// The points of A and of B whose difference is where the surface is met along a direction from the origin, which it is about.
    pub(super) fn points_along(&self, direction: &[f64; 3]) -> Option<[[f64; 3]; 2]> {
        let facing = self.triangles.iter().filter(|triangle| triangle.is_listed && triangle.height.is_finite());
        // How many times the direction it is to the plane.
        let times = |triangle: &Triangle| triangle.height / dot(&triangle.direction, direction).max(0.0);
        let least = facing.clone().map(times).fold(f64::INFINITY, f64::min);
        let place = direction.map(|x| x * least);
        // Of those in one plane, which has the place inside.
        let nearest = facing.filter(|triangle| times(triangle) <= least * (1.0 + SAME)).map(|triangle| {
            let corners = triangle.corners.map(|corner| self.points[corner as usize]);
            let nearest = simplex::nearest(&corners.map(|corner| sub(&corner.vector, &place)));
            (dot(&nearest.vector, &nearest.vector), corners, nearest.weights)
        });
        let (_, corners, weights) = nearest.min_by(|x, y| x.0.total_cmp(&y.0))?;
        Some(super::gjk::means(&corners, &weights))
    }

    /// A triangle whose plane a point is beyond.
    fn seen_from(&self, point: &[f64; 3]) -> Option<u32> {
        let sees =
            |triangle: &Triangle| triangle.is_listed && dot(&triangle.direction, point) - triangle.height > IN_PLANE;
        self.triangles.iter().position(sees).map(|at| at as u32)
    }

    /// Removes a triangle, those that see a point and are reached from there over others that do, and triangles without area between
    /// them, which see nothing and would only be in the way; their border is kept. What has the point in its plane, as the flat end of a
    /// cylinder has each that comes to its circle, is removed only where the point is not beside it.
    fn remove_seen(&mut self, first: u32, point: &[f64; 3]) {
        self.triangles[first as usize].is_listed = false;
        self.removed.push(first);
        let mut looked_at = 0;
        while let Some(&at) = self.removed.get(looked_at) {
            looked_at += 1;
            for beyond in self.triangles[at as usize].neighbours {
                let next = &mut self.triangles[beyond.triangle as usize];
                if next.is_listed && !stays(next, beyond.edge, point, &self.vectors) {
                    next.is_listed = false;
                    self.removed.push(beyond.triangle);
                }
            }
        }
        for &at in &self.removed {
            let Triangle { corners, neighbours, .. } = self.triangles[at as usize];
            for (edge, beyond) in neighbours.into_iter().enumerate() {
                if self.triangles[beyond.triangle as usize].is_listed {
                    self.border.push(BorderEdge { ends: [corners[edge], corners[(edge + 1) % 3]], beyond });
                }
            }
        }
        self.vacant.append(&mut self.removed);
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

/// Whether a triangle neither sees a point nor is in the way of the triangle that the point makes with one of its edges.
fn stays(triangle: &Triangle, edge: u8, point: &[f64; 3], vectors: &[[f64; 3]]) -> bool {
    let above = dot(&triangle.direction, point) - triangle.height;
    if triangle.height == f64::INFINITY {
        return false;
    }
    if above.abs() > IN_PLANE {
        return above < 0.0;
    }
    let edge = usize::from(edge);
    let [from, to] = [edge, (edge + 1) % 3].map(|corner| &vectors[triangle.corners[corner] as usize]);
    let (along, away) = (sub(to, from), sub(point, from));
    let longest = dot(&along, &along).max(dot(&away, &away));
    dot(&cross(&along, &away), &triangle.direction) < -FLAT * longest
}

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
        let mut polytope = Polytope::about_origin(&corners.map(difference)).expect("about the origin");
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
