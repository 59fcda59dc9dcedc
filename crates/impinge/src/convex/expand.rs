//! The expanding polytope, grown facet by facet: how deep the origin is in the set of differences of two cores.
//!
//! The polytope is a list of oriented triangles that is closed: every directed edge is as often in it as its reverse. A step takes the
//! nearest triangle, finds the farthest difference along its normal, and puts a cone from there over the border of the triangles
//! that see it. The border of any triangles is closed, so whichever are taken, the list stays so; which ones see a point is a
//! matter of floats and may be wrong. What is proved needs no more: where all triangles of a closed list have the origin at least
//! ρ > 0 below their planes, their hull holds the ball of ρ about the origin (docs/proof.md, L29). Where that does not come
//! about, for sets without a volume or an origin on their border, the hulls of `depth` take over.
//!
//! # Source
//! Van den Bergen, *Proximity queries and penetration depth computation on 3D game objects*, GDC 2001, whose polytope has to stay
//! convex; ours only has to stay closed.

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
    triangles: Vec<Triangle>,
    /// Kept for its memory.
    border: Vec<[u32; 2]>,
}

#[derive(Clone, Copy)]
struct Triangle {
    corners: [u32; 3],
    direction: [f64; 3],
    /// How far below the plane the origin is at least; infinite for a triangle without area, which bounds nothing, and negative
    /// infinity where that may hold the origin.
    lower: f64,
    /// The height of the plane along the direction, which has no length of 1.
    height: f64,
}

/// The triangle that is nearest to the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The ball of this radius is in the hull of the points, as computed; where it is zero or less nothing is proved.
    pub(super) lower: f64,
    /// Across the triangle, outwards; its greatest entry is ±1.
    pub(super) direction: [f64; 3],
    at: usize,
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
        let mut polytope = Self { points, triangles: Vec::with_capacity(64), border: Vec::new() };
        for &face in faces {
            polytope.push(face);
        }
        polytope
    }

    /// The triangle that bounds least.
    pub(super) fn nearest(&self) -> Option<Nearest> {
        let (at, triangle) = self.triangles.iter().enumerate().min_by(|x, y| x.1.lower.total_cmp(&y.1.lower))?;
        triangle.lower.is_finite().then_some(Nearest { lower: triangle.lower, direction: triangle.direction, at })
    }

    /// Grows to a point that is beyond the plane of a triangle. False where it is a corner already, or there are as many as may be:
    /// each one costs a look at all triangles. False, too, where the surface is tangled, which is then of no more use.
    pub(super) fn grow(&mut self, beyond: &Nearest, point: Difference, most_points: usize) -> bool {
        if self.points.len() >= most_points || self.points.iter().any(|known| known.vector == point.vector) {
            return false;
        }
        let number = self.points.len() as u32;
        self.points.push(point);
        let mut border = std::mem::take(&mut self.border);
        let mut at = 0..;
        self.triangles.retain(|triangle| {
            let is_seen = dot(&triangle.direction, &point.vector) - triangle.height >= -IN_PLANE;
            let is_removed = at.next() == Some(beyond.at) || is_seen;
            if is_removed {
                let [p, q, r] = triangle.corners;
                for edge in [[p, q], [q, r], [r, p]] {
                    add_to_border(&mut border, edge);
                }
            }
            !is_removed
        });
        if self.triangles.len() + border.len() > TANGLED * self.points.len() {
            return false;
        }
        for [from, to] in border.drain(..) {
            self.push([from, to, number]);
        }
        self.border = border;
        true
    }

    /// The points of A and of B whose difference is the nearest of a triangle.
    pub(super) fn foot(&self, nearest: &Nearest) -> [[f64; 3]; 2] {
        let corners = self.triangles[nearest.at].corners.map(|corner| self.points[corner as usize]);
        super::gjk::means(&corners, &simplex::nearest(&corners.map(|corner| corner.vector)).weights)
    }

    fn push(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|corner| self.points[corner as usize].vector);
        let triangle = match Facet::of(&a, &b, &c) {
            Some(Facet { direction, lower }) => Triangle { corners, direction, lower, height: dot(&direction, &a) },
            // Far from the origin it covers no direction of its own; near, nothing is proved any more.
            None => {
                let away = length(&simplex::nearest(&[a, b, c]).vector);
                let lower = if away > FAR { f64::INFINITY } else { f64::NEG_INFINITY };
                Triangle { corners, direction: [0.0; 3], lower, height: f64::INFINITY }
            }
        };
        self.triangles.push(triangle);
    }
}

/// An edge that is on the border, unless its reverse is: then neither is.
fn add_to_border(border: &mut Vec<[u32; 2]>, [from, to]: [u32; 2]) {
    match border.iter().position(|edge| *edge == [to, from]) {
        Some(reverse) => {
            border.swap_remove(reverse);
        }
        None => border.push([from, to]),
    }
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
            for triangle in &polytope.triangles {
                let [p, q, r] = triangle.corners;
                edges.extend([[p, q], [q, r], [r, p]]);
            }
            let mut reversed: Vec<[u32; 2]> = edges.iter().map(|&[from, to]| [to, from]).collect();
            edges.sort_unstable();
            reversed.sort_unstable();
            assert_eq!(edges, reversed);
        }
        assert!(grown > 20, "{grown}");
    }
}
