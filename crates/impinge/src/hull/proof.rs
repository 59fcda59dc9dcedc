//! Proves that a given surface is the hull of given points, without building the hull.
//!
//! Let a center be strictly inside the planes of all faces. Seen from it, each face is a spherical
//! triangle with the right orientation. The surface is closed, so every direction is covered by the
//! same number of faces. If one direction is covered once, all are, and the cones over the faces
//! partition space. The gauge of the surface, the factor by which it must grow to reach a point, is
//! linear on each cone. If no edge is bent inward, the gauge is convex across each wall between two
//! cones. So it is convex, and so is the surface (compare Mehlhorn and others, *Checking geometric
//! programs or verification of geometric structures*, 1996, who shoot a ray for the same reason).
//!
//! A point is inside if it is not beyond the face in whose cone it lies. A walk from cone to cone
//! finds that face. The gauge of the current face grows with each step into another facet (the
//! visibility walk of Devillers, Pion and Teillaud, *Walking in a triangulation*, 2002, in a
//! regular triangulation). Points are processed in the order of their directions, along a
//! space-filling curve, so that the next one is near.
//!
//! If the surface is flat, or so thin that no double is inside, the hull is built anew and
//! compared.
//!
//! # Accuracy
//! Every decision is exact (docs/notes/proof.md, L27a). The tests are in
//! `tests/it/hull/stored_hulls.rs` and `proxies.rs`.

use rayon::prelude::*;

use super::build::{bounds, extent};
use super::cull::Place;
use super::{Hull, HullKind};
use crate::exact::{Plane, orient3d};
use crate::math::Sign::{self, Negative, Positive, Zero};

/// Number of points that a thread processes at a time. Each chunk starts its walk at the same face.
const CHUNK: usize = 1 << 12;

/// Number of faces that are tried for a rounded centroid in their own cone. If none of them has
/// one, the hull is built anew.
const PROBES: usize = 64;

/// Number of squares along each edge of the cube map that orders directions: 2^14.
const SQUARES: usize = 1 << 14;

impl Hull {
    /// Reports whether this is the hull of its own vertices and `others`: each vertex is extreme,
    /// no point is outside, and faces and neighbors are those of the boundary. Any triangulation of
    /// a facet is accepted.
    ///
    /// # Complexity
    /// O(n log n) for sorting, and one walk from each point's cone to the next one's. With n points
    /// and f faces that is about n steps if the points are spread evenly, and n·√f steps on shapes
    /// as bad as needles. A flat or very thin surface takes the time of [`Hull::new`].
    pub(crate) fn is_of(&self, others: &[[f64; 3]]) -> bool {
        if self.kind != HullKind::Solid {
            return self.is_rebuilt(others);
        }
        let Some(across) = self.across() else { return false };
        let Some(inside) = Inside::of(self, across) else { return self.is_rebuilt(others) };
        match inside.covers_once() {
            Some(is_once) => is_once && inside.is_convex() && inside.hold_all(others),
            None => self.is_rebuilt(others),
        }
    }

    fn is_rebuilt(&self, others: &[[f64; 3]]) -> bool {
        Self::new(&[&self.positions, others].concat()).is_ok_and(|anew| {
            self.kind == anew.kind
                && self.positions == anew.positions
                && self.faces == anew.faces
                && self.first == anew.first
                && self.neighbors == anew.neighbors
        })
    }
}

/// A surface, and a point strictly inside the planes of all its faces.
struct Inside<'h> {
    hull: &'h Hull,
    /// For each face, the faces across the edges from each corner to the next.
    across: Vec<[u32; 3]>,
    /// The corners of the box of the vertices.
    bounds: [[f64; 3]; 2],
    center: [f64; 3],
    /// Upper bound on the difference along each axis of two vertices, or of a vertex and the
    /// center.
    extent: [f64; 3],
}

impl<'h> Inside<'h> {
    /// Returns `None` if the mean of the vertices is not strictly inside.
    fn of(hull: &'h Hull, across: Vec<[u32; 3]>) -> Option<Self> {
        let share = 1.0 / hull.positions.len() as f64;
        let center = std::array::from_fn(|k| hull.positions.iter().map(|position| position[k] * share).sum());
        let bounds = bounds(&hull.positions);
        let extent = extent(&hull.positions);
        let inside = Self { hull, across, bounds, center, extent };
        let is_below = |face: &[u32; 3]| {
            let [p, q, r] = inside.corners(face);
            inside.side([p, q, r], &center) == Negative
        };
        // The mean must be in the box, so that `extent` is valid for the center too.
        (inside.may_hold(&center) && hull.faces.par_iter().all(is_below)).then_some(inside)
    }

    /// Reports whether no edge is bent inward, and the neighbors of each vertex are exactly the
    /// other ends of its bent edges. Each vertex needs three or more, so that it is extreme.
    fn is_convex(&self) -> bool {
        let bends: Option<Vec<[bool; 3]>> = (self.hull.faces.par_iter().zip(&self.across))
            .map(|(face, across)| {
                let plane = Plane::new(self.corner(face[0]), self.corner(face[1]), self.corner(face[2]), &self.extent);
                let mut bent = [false; 3];
                for edge in 0..3 {
                    let beyond = self.hull.faces[across[edge] as usize];
                    let apex =
                        beyond.into_iter().find(|&corner| corner != face[edge] && corner != face[(edge + 1) % 3])?;
                    let apex = self.corner(apex);
                    let side = plane.side(apex).unwrap_or_else(|| self.side(self.corners(face), apex));
                    bent[edge] = match side {
                        Negative => true,
                        Zero => false,
                        Positive => return None,
                    };
                }
                Some(bent)
            })
            .collect();
        let Some(bends) = bends else { return false };
        let ends =
            self.hull.faces.iter().zip(&bends).flat_map(|(face, bent)| {
                (0..3).filter(|&edge| bent[edge]).map(|edge| [face[edge], face[(edge + 1) % 3]])
            });
        let mut edges: Vec<[u32; 2]> = ends.collect();
        edges.par_sort_unstable();
        let given = (0..self.hull.positions.len() as u32)
            .flat_map(|from| self.hull.neighbors(from).iter().map(move |&to| [from, to]));
        edges.iter().copied().eq(given) && self.hull.first.windows(2).all(|ends| ends[1] - ends[0] >= 3)
    }

    /// Reports whether some direction is in the cone of only one face. Returns `None` if no
    /// direction is found well inside a cone.
    fn covers_once(&self) -> Option<bool> {
        let in_cone = |face: &[u32; 3], point: &[f64; 3]| (0..3).all(|edge| self.beside(face, edge, point) != Negative);
        let is_well_in =
            |face: &[u32; 3], point: &[f64; 3]| (0..3).all(|edge| self.beside(face, edge, point) == Positive);
        let middle = |face: &[u32; 3]| {
            let [p, q, r] = self.corners(face);
            std::array::from_fn(|k| p[k] / 3.0 + q[k] / 3.0 + r[k] / 3.0)
        };
        let probes = self.hull.faces.iter().take(PROBES).map(|face| (face, middle(face)));
        let (_, probe) = probes.into_iter().find(|(face, probe)| self.may_hold(probe) && is_well_in(face, probe))?;
        Some(self.hull.faces.par_iter().filter(|face| in_cone(face, &probe)).count() == 1)
    }

    /// Reports whether no point is outside.
    fn hold_all(&self, points: &[[f64; 3]]) -> bool {
        if !points.par_iter().all(|point| self.may_hold(point)) {
            return false;
        }
        let mut order: Vec<(u32, u32)> = points
            .par_iter()
            .zip(0..points.len() as u32)
            .map(|(point, number)| (self.direction(point), number))
            .collect();
        order.par_sort_unstable();
        order.par_chunks(CHUNK).all(|chunk| {
            let mut at = 0;
            chunk.iter().all(|&(_, number)| {
                let point = &points[number as usize];
                let Some(found) = self.walk(point, at) else { return false };
                at = found;
                self.side(self.corners(&self.hull.faces[at as usize]), point) != Positive
            })
        })
    }

    /// Walks to a face in whose cone the point is. On a convex surface the walk visits no facet
    /// twice. Returns `None` if the walk runs in circles, on a facet with an unusual triangulation.
    fn walk(&self, point: &[f64; 3], start: u32) -> Option<u32> {
        let mut at = start;
        for _ in 0..=self.across.len() {
            let face = &self.hull.faces[at as usize];
            match (0..3).find(|&edge| self.beside(face, edge, point) == Negative) {
                Some(edge) => at = self.across[at as usize][edge],
                None => return Some(at),
            }
        }
        None
    }

    /// Returns the position of a point's direction along a space-filling curve over the six sides
    /// of a cube.
    fn direction(&self, point: &[f64; 3]) -> u32 {
        let scaled = std::array::from_fn(|k| (point[k] - self.center[k]) / self.extent[k]);
        let Place { side, square: [s, t], .. } = Place::of(&scaled, SQUARES);
        let spread = |x: usize| (0..14).fold(0, |spread, bit| spread | (x as u32 >> bit & 1) << (2 * bit));
        (side as u32) << 28 | spread(s) << 1 | spread(t)
    }

    /// Reports whether a point is in the box of the vertices.
    fn may_hold(&self, point: &[f64; 3]) -> bool {
        let [low, high] = self.bounds;
        (0..3).all(|k| low[k] <= point[k] && point[k] <= high[k])
    }

    /// Returns the side of the plane through the center and an edge of a face on which a point is.
    /// The face is on the positive side.
    #[inline(always)]
    fn beside(&self, face: &[u32; 3], edge: usize, point: &[f64; 3]) -> Sign {
        self.side([&self.center, self.corner(face[edge]), self.corner(face[(edge + 1) % 3])], point)
    }

    /// Returns the side of the plane through three points on which another point is. All points
    /// must be in the box of the vertices.
    #[inline(always)]
    fn side(&self, [p, q, r]: [&[f64; 3]; 3], point: &[f64; 3]) -> Sign {
        Plane::new(p, q, r, &self.extent).side(point).unwrap_or_else(|| orient3d(p, q, r, point))
    }

    fn corner(&self, vertex: u32) -> &[f64; 3] {
        &self.hull.positions[vertex as usize]
    }

    fn corners(&self, face: &[u32; 3]) -> [&[f64; 3]; 3] {
        face.map(|vertex| self.corner(vertex))
    }
}

impl Hull {
    /// Returns for each face the faces across the edges from each corner to the next. Returns
    /// `None` if some edge does not have as many faces on one side as on the other. Exactly one
    /// face on either side follows once each direction is covered once: two faces on the same side
    /// would overlap.
    fn across(&self) -> Option<Vec<[u32; 3]>> {
        let sorted = |turn: fn([u32; 2]) -> [u32; 2]| {
            let edges = (0_u32..).zip(&self.faces).flat_map(|(number, face)| {
                (0..3).map(move |edge| (turn([face[edge], face[(edge + 1) % 3]]), 3 * number + edge as u32))
            });
            let mut edges: Vec<([u32; 2], u32)> = edges.collect();
            edges.par_sort_unstable();
            edges
        };
        let (there, back) = (sorted(|edge| edge), sorted(|[from, to]| [to, from]));
        let mut across = vec![[0; 3]; self.faces.len()];
        for (&(edge, place), &(twin, beyond)) in there.iter().zip(&back) {
            if edge != twin {
                return None;
            }
            across[place as usize / 3][place as usize % 3] = beyond / 3;
        }
        Some(across)
    }
}
