//! Facets: the flat parts of a surface, which are triangles of about one plane connected along
//! edges.
//!
//! A large triangulated wall is one facet. A query that only cares about the wall need not look at
//! the edges between its triangles. A facet supports the mesh if no vertex is beyond its plane, as
//! all facets of a convex solid do.
//!
//! Guarded by `tests/it/clash/cases.rs`.

use std::ops::ControlFlow::{self, Break, Continue};

use crate::budget::Budget;
use crate::math::vec3::{Vector, cross, dot, length, scale, sub, unit};
use crate::mesh::Mesh;
use crate::mesh::derived::facets::{FacetPlane, Facets};
use crate::mesh::derived::topology::{Across, Components, FaceAcross};
use crate::mesh::points::face_search::FaceSearch;

/// Distance of a corner from the plane of a facet, relative to the size of the mesh, up to which
/// the corner counts as in the plane. Coordinates in single precision are this close.
const FLATNESS: f64 = 1.0 / (1_u64 << 22) as f64;

/// Number of facets, the largest first, that are compared with the whole mesh. The others do not
/// count as supporting it.
const MAX_COMPARED: usize = 4096;

/// Number of faces that are sorted into facets between two checks of the budget.
const FACES_PER_CHECK: usize = 1 << 10;

/// Number of facets that are compared with the mesh between two checks of the budget.
const FACETS_PER_CHECK: usize = 4;

impl Mesh {
    /// Returns the facets of the mesh, or `None` if the budget ended the computation. A face
    /// without area is a facet of its own.
    ///
    /// # Complexity
    /// About O(n log n) in the faces the first time, then constant.
    pub(crate) fn facets(&self, budget: &Budget<'_>) -> Option<&Facets> {
        let slot = &self.0.derived.facets;
        // No lock is held during the computation, as in `sheets`.
        if slot.get().is_none() {
            let _ = slot.set(self.flat_parts(budget)?);
        }
        slot.get()
    }

    /// Reports whether an edge of a face is on the border of its facet. Edge k runs from corner k
    /// to the next.
    pub(crate) fn is_border_of_facet(&self, facets: &Facets, face: u32, edge: usize) -> bool {
        let of_face = &facets.parts.of_face;
        match self.across(face)[edge] {
            Across::Face(other) => of_face[other.face as usize] != of_face[face as usize],
            Across::Nothing | Across::Several => true,
        }
    }

    fn flat_parts(&self, budget: &Budget<'_>) -> Option<Facets> {
        let count = self.faces().len();
        let areas: Vec<Vector> = (0..count as u32)
            .map(|face| {
                let [p, q, r] = self.corners(face);
                cross(&sub(&q, &p), &sub(&r, &p))
            })
            .collect();
        let tolerance = FLATNESS * self.local_bounds().map_or(0.0, |[low, high]| length(&sub(&high, &low)));
        // A large face has the most accurate plane.
        let mut by_area: Vec<u32> = (0..count as u32).collect();
        by_area.sort_by(|&x, &y| length(&areas[y as usize]).total_cmp(&length(&areas[x as usize])).then(x.cmp(&y)));
        let mut root_of: Vec<Option<u32>> = vec![None; count];
        let mut seeds = Vec::new();
        let mut stack = Vec::new();
        for (at, seed) in by_area.into_iter().enumerate() {
            if at.is_multiple_of(FACES_PER_CHECK) && budget.is_spent() {
                return None;
            }
            if root_of[seed as usize].is_some() {
                continue;
            }
            root_of[seed as usize] = Some(seed);
            seeds.push(seed);
            let size = length(&areas[seed as usize]);
            if size == 0.0 || !size.is_finite() {
                continue;
            }
            let normal = scale(&areas[seed as usize], 1.0 / size);
            let base = self.corners(seed)[0];
            let is_flat = |face: u32| {
                dot(&areas[face as usize], &normal) > 0.0
                    && self.corners(face).iter().all(|corner| dot(&normal, &sub(corner, &base)).abs() <= tolerance)
            };
            stack.push(seed);
            while let Some(face) = stack.pop() {
                for across in &self.all_across()[face as usize] {
                    let Across::Face(FaceAcross { face: other, .. }) = *across else { continue };
                    if root_of[other as usize].is_none() && is_flat(other) {
                        root_of[other as usize] = Some(seed);
                        stack.push(other);
                    }
                }
            }
        }
        let parts = Components::numbered(count, root_of.into_iter());
        let mut planes = vec![FacetPlane { face: 0, overhang: f64::INFINITY }; parts.first_faces.len()];
        for &face in &seeds {
            planes[parts.of_face[face as usize] as usize].face = face;
        }
        for (at, &face) in seeds.iter().take(MAX_COMPARED).enumerate() {
            if at.is_multiple_of(FACETS_PER_CHECK) && budget.is_spent() {
                return None;
            }
            planes[parts.of_face[face as usize] as usize].overhang = self.overhang(face, tolerance);
        }
        Some(Facets { parts, planes })
    }

    /// Returns how far the mesh reaches beyond the plane of a face, and infinity if that is more
    /// than a tolerance or the face has no area.
    fn overhang(&self, face: u32, tolerance: f64) -> f64 {
        let [p, q, r] = self.corners(face);
        let Some(normal) = unit(&cross(&sub(&q, &p), &sub(&r, &p))) else { return f64::INFINITY };
        let mut farthest = Farthest { mesh: self, normal, base: p, tolerance, beyond: 0.0 };
        self.search(&mut farthest);
        if farthest.beyond <= tolerance { farthest.beyond } else { f64::INFINITY }
    }
}

/// A search for the vertex that is farthest beyond a plane.
struct Farthest<'m> {
    mesh: &'m Mesh,
    normal: Vector,
    base: Vector,
    /// Distance beyond which the search ends.
    tolerance: f64,
    beyond: f64,
}

impl FaceSearch for Farthest<'_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        let reach: f64 = (0..3).map(|axis| self.normal[axis].abs() * half_extents[axis]).sum();
        -(dot(&self.normal, &sub(center, &self.base)) + reach)
    }

    fn cut(&self) -> f64 {
        -self.beyond
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        for corner in self.mesh.corners(face) {
            self.beyond = self.beyond.max(dot(&self.normal, &sub(&corner, &self.base)));
        }
        if self.beyond > self.tolerance { Break(()) } else { Continue(()) }
    }
}
