//! The boxes of a mesh's faces, as a builder asks for them: made from the vertices when they are wanted and never kept.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};
use rayon::prelude::*;

use super::frame::{PackedFrame, REACH};
use super::positions::Vertex;
use crate::hierarchy::Boxes;
use crate::simd::by_axis;
use crate::volume::Aabb;

/// Vertices that are one task.
const CHUNK: usize = 1 << 14;

/// Faces over vertices in the packed frame, rounded to single precision.
pub(crate) struct FaceBoxes<'a> {
    packed: &'a [[f32; 4]],
    faces: &'a [[u32; 3]],
}

impl<'a> FaceBoxes<'a> {
    /// Of faces whose indices were judged, over all vertices as [`pack`] packs them.
    pub(super) fn new(packed: &'a [[f32; 4]], faces: &'a [[u32; 3]]) -> Self {
        Self { packed, faces }
    }

    #[inline(always)]
    fn corners<S: Simd>(&self, simd: S, face: u32) -> [f32x4<S>; 3] {
        let face = &self.faces[face as usize];
        by_axis!(corner => f32x4::from_slice(simd, &self.packed[face[corner] as usize]))
    }
}

/// The same for a builder that looks at centres alone, of whose tree the layout is all that is wanted: its boxes are empty.
pub(super) struct FaceCentres<'a>(pub(super) FaceBoxes<'a>);

/// Puts the vertices into the packed frame, rounded to single precision.
pub(super) fn pack<V: Vertex>(vertices: &[V], frame: &PackedFrame, packed: &mut [[f32; 4]]) {
    packed.par_chunks_mut(CHUNK).zip(vertices.par_chunks(CHUNK)).for_each(|(packed, vertices)| {
        for (packed, vertex) in packed.iter_mut().zip(vertices) {
            let [x, y, z] = frame.pack(vertex.widened());
            *packed = [x as f32, y as f32, z as f32, 0.0_f32];
        }
    });
}

impl Boxes for FaceBoxes<'_> {
    fn len(&self) -> usize {
        self.faces.len()
    }

    fn twice_centres(&self) -> Aabb {
        let reach = 2.0 * (REACH as f32).next_up();
        Aabb { min: [-reach; 3], max: [reach; 3] }
    }

    #[inline(always)]
    fn twice_centre<S: Simd>(&self, simd: S, index: u32) -> f32x4<S> {
        let [p, q, r] = self.corners(simd, index);
        p.min(q).min(r) + p.max(q).max(r)
    }

    /// Rounded outward (docs/proof.md, L1): a step to the next float is a whole unit in the last place, more than half of
    /// one for the rounding to single precision and the double precision errors before it.
    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S, group: &[u32]) -> Aabb {
        let mut min = f32x4::splat(simd, f32::INFINITY);
        let mut max = f32x4::splat(simd, f32::NEG_INFINITY);
        for &face in group {
            let [p, q, r] = self.corners(simd, face);
            min = min.min(p.min(q).min(r));
            max = max.max(p.max(q).max(r));
        }
        Aabb { min: [min[0], min[1], min[2]], max: [max[0], max[1], max[2]] }.next_outward()
    }
}

impl Boxes for FaceCentres<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn twice_centres(&self) -> Aabb {
        self.0.twice_centres()
    }

    #[inline(always)]
    fn twice_centre<S: Simd>(&self, simd: S, index: u32) -> f32x4<S> {
        self.0.twice_centre(simd, index)
    }

    #[inline(always)]
    fn bounds<S: Simd>(&self, _: S, _: &[u32]) -> Aabb {
        Aabb::EMPTY
    }
}
