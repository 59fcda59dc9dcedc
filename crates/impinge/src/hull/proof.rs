//! Whether a surface that somebody calls the hull of points is that, without building it.
//!
//! With a centre strictly inside of the planes of all faces, each face is seen from it as a spherical triangle, the right way
//! round. The surface is closed, so every direction is covered by as many of them as any other; one that is covered once
//! shows that all are, and that the cones over the faces part space. The gauge of the surface, the factor by which it
//! must grow to reach a point, is linear on each cone; where no edge is bent inward it is convex across each wall between
//! two cones, so it is convex, and so is the surface (compare Mehlhorn and others, *Checking geometric programs or verification
//! of geometric structures*, 1996, who shoot a ray for the same reason).
//!
//! A point is inside where it is not beyond the face in whose cone it lies. That is found by walking from cone to cone, the
//! gauge of the face at hand growing with each step into another facet (the visibility walk of Devillers, Pion and Teillaud,
//! *Walking in a triangulation*, 2002, of what is a regular triangulation). Points are taken in the order of their directions,
//! along a space-filling curve, so that the next one is near.
//!
//! What is flat, or so thin that no double is inside, is built anew and compared.
//!
//! # Accuracy
//! Every decision is exact.

use rayon::prelude::*;

use super::build::{bounds, extent};
use super::cull::Place;
use super::{Hull, HullKind};
use crate::exact::{Plane, orient3d};
use crate::math::Sign::{self, Negative, Positive, Zero};

/// Points that a thread takes at a time, each chunk walking from the same face.
const CHUNK: usize = 1 << 12;

/// Of so many faces one has a rounded centroid in its own cone, or the hull is built anew.
const PROBES: usize = 64;

/// Squares along each edge of the cube map by which directions are ordered: 2^14.
const SQUARES: usize = 1 << 14;

impl Hull {
    /// Whether this is the hull of its own vertices and other points: each vertex is extreme, no point is outside, faces and
    /// neighbours are those of the boundary. How a facet is cut into triangles is left open.
    ///
    /// # Complexity
    /// O(n log n) for sorting, and one walk from each point's cone to the next one's: with n points and f faces, some n
    /// steps where they are spread evenly, and n·√f steps on shapes as bad as needles. What is flat or too thin takes what
    /// [`Hull::new`] takes.
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
                && self.neighbours == anew.neighbours
        })
    }
}

/// A surface, and a point strictly inside the planes of all its faces.
struct Inside<'h> {
    hull: &'h Hull,
    /// For each face those across the edges from each corner to the next.
    across: Vec<[u32; 3]>,
    /// The corners of the box of the vertices.
    bounds: [[f64; 3]; 2],
    centre: [f64; 3],
    /// At least how far two of the vertices, or one of them and the centre, differ along each axis.
    extent: [f64; 3],
}

impl<'h> Inside<'h> {
    /// Nothing where the mean of the vertices is not inside.
    fn of(hull: &'h Hull, across: Vec<[u32; 3]>) -> Option<Self> {
        let share = 1.0 / hull.positions.len() as f64;
        let centre = std::array::from_fn(|k| hull.positions.iter().map(|position| position[k] * share).sum());
        let bounds = bounds(&hull.positions);
        let extent = extent(&hull.positions);
        let inside = Self { hull, across, bounds, centre, extent };
        let is_below = |face: &[u32; 3]| {
            let [p, q, r] = inside.corners(face);
            inside.side([p, q, r], &centre) == Negative
        };
        // A mean within the box, so that `extent` is that of the centre too.
        (inside.may_hold(&centre) && hull.faces.par_iter().all(is_below)).then_some(inside)
    }

    /// Whether no edge is bent inward, and the neighbours of each vertex are the other ends of its edges
    /// that are bent at all: three or more, so that it is extreme.
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
        let told = (0..self.hull.positions.len() as u32)
            .flat_map(|from| self.hull.neighbours(from).iter().map(move |&to| [from, to]));
        edges.iter().copied().eq(told) && self.hull.first.windows(2).all(|ends| ends[1] - ends[0] >= 3)
    }

    /// Whether some direction is in the cone of one face alone; nothing where no direction is found that is well inside of one.
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

    /// Whether no point is outside.
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

    /// Walks to a face in whose cone the point is. On a convex surface no facet is met twice; nothing where, on a facet that
    /// was cut in a strange way, the walk goes round in circles.
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

    /// The place of a point's direction along a space-filling curve over the six sides of a cube.
    fn direction(&self, point: &[f64; 3]) -> u32 {
        let scaled = std::array::from_fn(|k| (point[k] - self.centre[k]) / self.extent[k]);
        let Place { side, square: [s, t], .. } = Place::of(&scaled, SQUARES);
        let spread = |x: usize| (0..14).fold(0, |spread, bit| spread | (x as u32 >> bit & 1) << (2 * bit));
        (side as u32) << 28 | spread(s) << 1 | spread(t)
    }

    /// Whether a point is in the box of the vertices.
    fn may_hold(&self, point: &[f64; 3]) -> bool {
        let [low, high] = self.bounds;
        (0..3).all(|k| low[k] <= point[k] && point[k] <= high[k])
    }

    /// On which side of the plane through the centre and an edge of a face a point is, positive being where the face is.
    #[inline(always)]
    fn beside(&self, face: &[u32; 3], edge: usize, point: &[f64; 3]) -> Sign {
        self.side([&self.centre, self.corner(face[edge]), self.corner(face[(edge + 1) % 3])], point)
    }

    /// On which side of the plane through three points another one is, all of them in the box of the vertices.
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
    /// For each face those across the edges from each corner to the next; nothing where some edge has not as many faces on one
    /// side as on the other. That there is one on either side follows once each direction is covered once: two on the
    /// same side would overlap.
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
