//! The expanding polytope, grown facet by facet. It computes the depth of the origin in the set of
//! differences of two cores.
//!
//! The polytope is a closed list of oriented triangles: every directed edge is linked with one that
//! is its reverse. A step takes the nearest triangle and finds the farthest difference along its
//! normal. It removes the connected triangles that see that point, and puts a cone from the point
//! over their border. The border of any triangles is closed, so the list stays closed whichever
//! triangles are removed. Floats choose these triangles and may choose wrong ones.
//!
//! The proof needs no more. If all triangles of a closed list have the origin at least ρ > 0 below
//! their planes, their hull holds the sphere of radius ρ about the origin (docs/notes/proof.md,
//! L29). If that fails, for sets without volume or an origin on their border, the hulls of `depth`
//! take over.
//!
//! # Source
//! Van den Bergen, *Proximity queries and penetration depth computation on 3D game objects*, GDC
//! 2001, whose polytope has to stay convex; ours only has to stay closed.
//!
//! The test is `the_surface_stays_closed` below.

use super::facet::Facet;
use super::posed::Difference;
use super::simplex;
use crate::math::vec3::{cross, dot, length, sub};

/// Maximum distance from a triangle's plane, in the common unit, of a point that counts as in the
/// plane: 2^-48.
const IN_PLANE_TOLERANCE: f64 = 16.0 * f64::EPSILON;

/// Minimum height of a new triangle on its longest edge, relative to that edge, to be put beside a
/// triangle in its plane: 2^-30. If the new triangle would be flatter, the point is put over both
/// instead.
const MIN_RELATIVE_HEIGHT: f64 = 1.0 / (1 << 30) as f64;

/// Minimum distance of a triangle without area from the origin, in the common unit: 2^-20. If it is
/// nearer, nothing is proved.
const MIN_DEGENERATE_DISTANCE: f64 = 1.0 / (1 << 20) as f64;

/// Maximum relative difference of two distances along a direction that count as one place: 2^-30.
const SAME_PLACE_TOLERANCE: f64 = 1.0 / (1 << 30) as f64;

/// Maximum number of triangles per point. A surface without handles has fewer than two. With more
/// than four, rounding has made several layers of triangles. Each step may then triple their
/// number, and nothing is gained.
const MAX_TRIANGLES_PER_POINT: usize = 4;

/// A closed list of triangles about the origin.
pub(super) struct Polytope {
    points: Vec<Difference>,
    /// Vectors of the points, side by side, because every step reads all of them.
    vectors: Vec<[f64; 3]>,
    /// All triangles. A removed triangle keeps its place until a new one needs it.
    triangles: Vec<Triangle>,
    vacant: Vec<u32>,
    /// For each triangle, a lower bound on the distance of the origin below its plane, side by side
    /// because every step reads all of them. It is infinite for a removed triangle, and for a
    /// triangle without area, which bounds nothing. It is negative infinity if such a triangle may
    /// hold the origin.
    bounds: Vec<f64>,
    /// Buffers of a step, kept to reuse their memory.
    removed: Vec<u32>,
    border: Vec<BorderEdge>,
    unlinked: Vec<Unlinked>,
    /// For each point, the new triangle whose border edge starts there, or [`NONE`].
    starts: Vec<u32>,
}

/// Value that stands for "no triangle".
const NONE: u32 = u32::MAX;

/// Number of points that a polytope reserves memory for. Most depths need fewer. With less memory,
/// the points of more depths are copied to larger memory; with more memory, none is copied.
const RESERVED_POINTS: usize = 32;

#[derive(Clone, Copy)]
struct Triangle {
    corners: [u32; 3],
    /// Sides beyond the edge from each corner to the next corner.
    neighbors: [Side; 3],
    is_listed: bool,
    direction: [f64; 3],
    /// Height of the plane along `direction`, whose length is not 1.
    height: f64,
}

/// An edge of a triangle: from the corner with this number to the next corner.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    triangle: u32,
    edge: u8,
}

/// An edge of removed triangles, and the side beyond it.
struct BorderEdge {
    ends: [u32; 2],
    beyond: Side,
}

/// An edge whose reverse has not been added yet.
struct Unlinked {
    ends: [u32; 2],
    side: Side,
}

/// The triangle nearest to the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Radius of a sphere about the origin that the hull of the computed points holds. If it is
    /// zero or negative, nothing is proved.
    pub(super) lower: f64,
    /// Outward normal of the triangle. Its greatest entry is ±1.
    pub(super) direction: [f64; 3],
    at: u32,
}

impl Polytope {
    /// Builds the hull of four differences and some more. Returns `None` unless it holds the origin
    /// strictly inside.
    pub(super) fn about_origin(points: &[Difference]) -> Option<Self> {
        let (&[p, q, r, s], more) = points.split_first_chunk()?;
        let is_above = Facet::of(&p.vector, &q.vector, &r.vector)
            .is_some_and(|facet| dot(&facet.direction, &sub(&s.vector, &p.vector)) > 0.0);
        let [q, r] = if is_above { [r, q] } else { [q, r] };
        let mut polytope = Self::new(&[p, q, r, s], &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
        for point in more {
            let seen = polytope.seen_from(&point.vector);
            if seen.is_some_and(|at| !polytope.put_over(at, *point)) {
                return None;
            }
        }
        let bounds = polytope.triangles.iter().zip(&polytope.bounds).filter(|(triangle, _)| triangle.is_listed);
        bounds.map(|(_, bound)| *bound).all(|bound| bound > 0.0 && bound.is_finite()).then_some(polytope)
    }

    /// Builds the closed surface of these triangles.
    pub(super) fn new(points: &[Difference], faces: &[[u32; 3]]) -> Self {
        let mut polytope = Self {
            points: Vec::with_capacity(RESERVED_POINTS.max(points.len())),
            vectors: Vec::with_capacity(RESERVED_POINTS.max(points.len())),
            triangles: Vec::with_capacity(2 * RESERVED_POINTS),
            vacant: Vec::with_capacity(RESERVED_POINTS),
            bounds: Vec::with_capacity(2 * RESERVED_POINTS),
            removed: Vec::with_capacity(RESERVED_POINTS),
            border: Vec::with_capacity(RESERVED_POINTS),
            unlinked: Vec::new(),
            starts: Vec::with_capacity(RESERVED_POINTS),
        };
        points.iter().for_each(|point| polytope.add(*point));
        for &face in faces {
            let triangle = polytope.push(face);
            for edge in 0..3 {
                polytope.link_with_reverse(Side { triangle, edge });
            }
        }
        polytope
    }

    /// Returns the first triangle with the least bound, or `None` if no triangle has a finite one.
    pub(super) fn nearest(&self) -> Option<Nearest> {
        let lower = self.bounds.iter().fold(f64::INFINITY, |least, &bound| if bound < least { bound } else { least });
        let at = self.bounds.iter().position(|&bound| bound == lower)?;
        lower.is_finite().then(|| Nearest { lower, direction: self.triangles[at].direction, at: at as u32 })
    }

    fn add(&mut self, point: Difference) {
        self.points.push(point);
        self.vectors.push(point.vector);
        self.starts.push(NONE);
    }

    /// Adds a point that is beyond the plane of a triangle. Returns `false` if it is already a
    /// corner, or if there are `max_points` points. Also returns `false` if the surface is tangled;
    /// it is then no longer usable.
    pub(super) fn grow(&mut self, beyond: &Nearest, point: Difference, max_points: usize) -> bool {
        let [x, y, z] = point.vector;
        if self.points.len() >= max_points || self.vectors.iter().any(|v| v[0] == x && v[1] == y && v[2] == z) {
            return false;
        }
        self.put_over(beyond.at, point)
    }

    /// Puts a new point over a triangle whose plane it is beyond, and over the triangles around
    /// that see it too. Returns `false` if the surface is tangled.
    fn put_over(&mut self, at: u32, point: Difference) -> bool {
        let number = self.points.len() as u32;
        self.add(point);
        self.remove_seen(at, &point.vector);
        let listed = self.triangles.len() - self.vacant.len();
        if listed + self.border.len() > MAX_TRIANGLES_PER_POINT * self.points.len() {
            return false;
        }
        let border = std::mem::take(&mut self.border);
        let mut is_simple = true;
        for &BorderEdge { ends: [from, to], beyond } in &border {
            let triangle = self.push([from, to, number]);
            self.link(Side { triangle, edge: 0 }, beyond);
            is_simple &= std::mem::replace(&mut self.starts[from as usize], triangle) == NONE;
        }
        self.link_cone(&border, is_simple);
        self.border = border;
        self.border.clear();
        true
    }

    /// Links the sides of the new triangles over a border that share an edge. A border is simple if
    /// no two of its edges start at one point. A surface that rounding has bent may have others.
    fn link_cone(&mut self, border: &[BorderEdge], is_simple: bool) {
        if is_simple {
            for &BorderEdge { ends: [from, to], .. } in border {
                let [triangle, next] = [from, to].map(|point| self.starts[point as usize]);
                self.link(Side { triangle, edge: 1 }, Side { triangle: next, edge: 2 });
            }
        } else {
            for &BorderEdge { beyond: Side { triangle: outside, edge }, .. } in border {
                let triangle = self.triangles[outside as usize].neighbors[usize::from(edge)].triangle;
                self.link_with_reverse(Side { triangle, edge: 1 });
                self.link_with_reverse(Side { triangle, edge: 2 });
            }
        }
        border.iter().for_each(|edge| self.starts[edge.ends[0] as usize] = NONE);
    }

    /// Returns the corners of the triangle that a direction from the origin, which must be inside,
    /// leads through, and the points of A and of B whose difference is the point there. Returns
    /// `None` if no triangle faces the direction.
    pub(super) fn along(&self, direction: &[f64; 3]) -> Option<([Difference; 3], [[f64; 3]; 2])> {
        let facing = self.triangles.iter().filter(|triangle| triangle.is_listed && triangle.height.is_finite());
        // Distance to the plane in multiples of the direction.
        let times = |triangle: &Triangle| triangle.height / dot(&triangle.direction, direction).max(0.0);
        let least = facing.clone().map(times).fold(f64::INFINITY, f64::min);
        let place = direction.map(|x| x * least);
        // Of the triangles in one plane, the one that holds the place.
        let nearest =
            facing.filter(|triangle| times(triangle) <= least * (1.0 + SAME_PLACE_TOLERANCE)).map(|triangle| {
                let corners = triangle.corners.map(|corner| self.points[corner as usize]);
                let nearest = simplex::nearest(&corners.map(|corner| sub(&corner.vector, &place)));
                (dot(&nearest.vector, &nearest.vector), corners, nearest.weights)
            });
        let (_, corners, weights) = nearest.min_by(|x, y| x.0.total_cmp(&y.0))?;
        Some((corners, super::gjk::means(&corners, &weights)))
    }

    /// Returns a triangle whose plane the point is beyond.
    fn seen_from(&self, point: &[f64; 3]) -> Option<u32> {
        let sees = |triangle: &Triangle| {
            triangle.is_listed && dot(&triangle.direction, point) - triangle.height > IN_PLANE_TOLERANCE
        };
        self.triangles.iter().position(sees).map(|at| at as u32)
    }

    /// Removes a triangle and all connected triangles that see a point, and keeps their border.
    /// Triangles without area between them, which see nothing, are removed too. If a triangle has
    /// the point in its plane, as at the flat end of a cylinder, it is removed only if the point is
    /// not beside it.
    fn remove_seen(&mut self, first: u32, point: &[f64; 3]) {
        self.triangles[first as usize].is_listed = false;
        self.removed.push(first);
        let mut looked_at = 0;
        while let Some(&at) = self.removed.get(looked_at) {
            looked_at += 1;
            for beyond in self.triangles[at as usize].neighbors {
                let next = &mut self.triangles[beyond.triangle as usize];
                if next.is_listed && !stays(next, beyond.edge, point, &self.vectors) {
                    next.is_listed = false;
                    self.removed.push(beyond.triangle);
                }
            }
        }
        for &at in &self.removed {
            self.bounds[at as usize] = f64::INFINITY;
            let Triangle { corners, neighbors, .. } = &self.triangles[at as usize];
            for (edge, &beyond) in neighbors.iter().enumerate() {
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
            // Far from the origin, the triangle covers no direction of its own. Near the origin,
            // nothing is proved any more.
            None => {
                let away = length(&simplex::nearest(&[a, b, c]).vector);
                (
                    [0.0; 3],
                    if away > MIN_DEGENERATE_DISTANCE { f64::INFINITY } else { f64::NEG_INFINITY },
                    f64::INFINITY,
                )
            }
        };
        let at = self.vacant.pop().unwrap_or(self.triangles.len() as u32);
        let neighbors = [0, 1, 2].map(|edge| Side { triangle: at, edge });
        let triangle = Triangle { corners, neighbors, is_listed: true, direction, height };
        if at as usize == self.triangles.len() {
            self.triangles.push(triangle);
            self.bounds.push(lower);
        } else {
            self.triangles[at as usize] = triangle;
            self.bounds[at as usize] = lower;
        }
        at
    }

    fn link(&mut self, one: Side, other: Side) {
        self.triangles[one.triangle as usize].neighbors[usize::from(one.edge)] = other;
        self.triangles[other.triangle as usize].neighbors[usize::from(other.edge)] = one;
    }

    /// Links an edge with its reverse, now or when the reverse is added. If there are several, any
    /// of them serves.
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

/// Reports whether a triangle stays: it does not see the point, and is not in the way of the
/// triangle that the point makes with one of its edges.
fn stays(triangle: &Triangle, edge: u8, point: &[f64; 3], vectors: &[[f64; 3]]) -> bool {
    let above = dot(&triangle.direction, point) - triangle.height;
    if triangle.height == f64::INFINITY {
        return false;
    }
    if above.abs() > IN_PLANE_TOLERANCE {
        return above < 0.0;
    }
    let edge = usize::from(edge);
    let [from, to] = [edge, (edge + 1) % 3].map(|corner| &vectors[triangle.corners[corner] as usize]);
    let (along, away) = (sub(to, from), sub(point, from));
    let longest = dot(&along, &along).max(dot(&away, &away));
    dot(&cross(&along, &away), &triangle.direction) < -MIN_RELATIVE_HEIGHT * longest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::posed::Spot;

    fn difference(vector: [f64; 3]) -> Difference {
        let spot = |point| Spot { local: point, point };
        Difference { a: spot(vector), b: spot([0.0; 3]), vector }
    }

    /// Whatever the points are, every directed edge occurs as often as its reverse.
    #[test]
    fn the_surface_stays_closed() {
        let corners = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]];
        let mut polytope = Polytope::about_origin(&corners.map(difference)).expect("about the origin");
        let mut grown = 0;
        for step in 0..60_u32 {
            // Points on grids that become larger, so that many are in planes of facets and beyond
            // others.
            let digit = |at: u32| f64::from(1 + step / 6) * (f64::from((step * 7 + at * step) % 5) - 2.0);
            let Some(nearest) = polytope.nearest() else { break };
            grown += u32::from(polytope.grow(&nearest, difference([digit(1), digit(3), digit(5)]), 64));
            let mut edges: Vec<[u32; 2]> = Vec::new();
            assert!(polytope.unlinked.is_empty());
            for triangle in polytope.triangles.iter().filter(|triangle| triangle.is_listed) {
                let [p, q, r] = triangle.corners;
                edges.extend([[p, q], [q, r], [r, p]]);
                for (edge, side) in triangle.neighbors.iter().enumerate() {
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
