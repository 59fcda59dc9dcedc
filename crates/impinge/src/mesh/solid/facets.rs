//! Facets: the flat parts of a surface, which are triangles of about one plane connected along
//! edges.
//!
//! A large triangulated wall is one facet. A query that only cares about the wall need not look at
//! the edges between its triangles.
//!
//! Guarded by `tests/it/clash/cases.rs`.

use crate::math::vec3::{Vector, cross, dot, length, scale, sub};
use crate::mesh::Mesh;
use crate::mesh::derived::topology::{Across, Components};

/// Distance of a corner from the plane of a facet, relative to the size of the mesh, up to which
/// the corner counts as in the plane. Coordinates in single precision are this close.
const FLATNESS: f64 = 1.0 / (1_u64 << 22) as f64;

impl Mesh {
    /// Returns the facets of the mesh. A face without area is a facet of its own.
    ///
    /// # Complexity
    /// O(n log n) in the faces the first time, then constant.
    pub(crate) fn facets(&self) -> &Components {
        let slot = &self.0.derived.facets;
        // No lock is held during the computation, as in `sheets`.
        if slot.get().is_none() {
            let _ = slot.set(self.flat_parts());
        }
        slot.get_or_init(|| self.flat_parts())
    }

    /// Reports whether an edge of a face is on the border of its facet. Edge k runs from corner k
    /// to the next.
    pub(crate) fn is_border_of_facet(&self, face: u32, edge: usize) -> bool {
        let of_face = &self.facets().of_face;
        match self.across(face)[edge] {
            Across::Face(other) => of_face[other as usize] != of_face[face as usize],
            Across::Nothing | Across::Several => true,
        }
    }

    fn flat_parts(&self) -> Components {
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
        let mut stack = Vec::new();
        for seed in by_area {
            if root_of[seed as usize].is_some() {
                continue;
            }
            root_of[seed as usize] = Some(seed);
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
                for across in self.across(face) {
                    let Across::Face(other) = across else { continue };
                    if root_of[other as usize].is_none() && is_flat(other) {
                        root_of[other as usize] = Some(seed);
                        stack.push(other);
                    }
                }
            }
        }
        Components::numbered(count, root_of.into_iter())
    }
}
