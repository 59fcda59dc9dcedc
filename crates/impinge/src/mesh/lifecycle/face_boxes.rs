//! The boxes of faces as a builder reads them. They are computed from the vertices and never
//! stored.

use fearless_simd::{Simd, f32x4};
use rayon::prelude::*;

use crate::hierarchy::Boxes;
use crate::mesh::storage::stored_corners::StoredCorners;
use crate::simd::LANES;
use crate::volume::Aabb;

/// Number of faces per task.
const CHUNK: usize = 1 << 14;

/// The faces of a mesh, as a source of boxes.
pub(super) struct FaceBoxes<C>(pub(in crate::mesh) C);

impl<C: StoredCorners> FaceBoxes<C> {
    /// Returns the box of each face in the packed frame, rounded to nearest. A builder only lays
    /// out the faces; exact bounds come from fitting.
    pub(in crate::mesh) fn listed(&self) -> Vec<Aabb> {
        let Self(stored) = self;
        let packed = |vertex: u32| stored.frame().pack(stored.vertex(vertex)).map(|x| x as f32);
        let faces = stored.faces().all();
        let bounds = |face: &[u32; 3]| Aabb::of_points(face.map(packed));
        faces.par_iter().with_min_len(CHUNK).map(bounds).collect()
    }
}

impl<C: StoredCorners> Boxes for FaceBoxes<C> {
    fn len(&self) -> usize {
        self.0.faces().all().len()
    }

    fn twice_reach(&self) -> Aabb {
        self.0.twice_reach()
    }

    #[inline(always)]
    fn eight<S: Simd>(&self, simd: S, first: usize) -> [[f32x4<S>; 4]; 2] {
        let Self(stored) = self;
        let faces = &stored.faces().all()[first..];
        match faces.first_chunk::<LANES>() {
            Some(faces) => stored.twice_centers(simd, faces),
            None => {
                let mut padded = [faces[0]; LANES];
                padded[..faces.len()].copy_from_slice(faces);
                stored.twice_centers(simd, &padded)
            }
        }
    }
}
