//! The boxes of a mesh's faces, as a builder asks for them: made from the vertices and never kept.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch, f32x4};
use rayon::prelude::*;

use super::frame::{PackedFrame, REACH};
use super::positions::{Vertex, VertexSlice};
use crate::hierarchy::Boxes;
use crate::simd::{best_level, by_axis};
use crate::volume::Aabb;

/// Vertices, or faces, that are one task.
const CHUNK: usize = 1 << 14;

/// Faces over vertices in the packed frame, rounded to single precision.
pub(super) struct FaceBoxes<'a> {
    packed: &'a [[f32; 4]],
    faces: &'a [[u32; 3]],
}

impl<'a> FaceBoxes<'a> {
    /// Of faces whose indices were judged. `packed` is room for the vertices.
    pub(super) fn of(
        vertices: VertexSlice<'_>,
        faces: &'a [[u32; 3]],
        frame: &PackedFrame,
        packed: &'a mut [[f32; 4]],
    ) -> Self {
        match vertices {
            VertexSlice::F32(vertices) => pack(vertices, frame, packed),
            VertexSlice::F64(vertices) => pack(vertices, frame, packed),
        }
        Self { packed, faces }
    }

    /// The boxes one by one, rounded outward (docs/proof.md, L1): a step to the next float is a whole unit in the last place,
    /// more than half of one for the rounding to single precision and the double precision errors before it.
    pub(super) fn listed(&self) -> Vec<Aabb> {
        let mut boxes = vec![Aabb::EMPTY; self.faces.len()];
        boxes.par_chunks_mut(CHUNK).zip(self.faces.par_chunks(CHUNK)).for_each(|(boxes, faces)| {
            dispatch!(best_level(), simd => for (bounds, face) in boxes.iter_mut().zip(faces) {
                let [min, max] = self.extremes(simd, face);
                *bounds = Aabb { min: [min[0], min[1], min[2]], max: [max[0], max[1], max[2]] }.next_outward();
            });
        });
        boxes
    }

    #[inline(always)]
    fn extremes<S: Simd>(&self, simd: S, face: &[u32; 3]) -> [f32x4<S>; 2] {
        let [p, q, r] = by_axis!(corner => f32x4::from_slice(simd, &self.packed[face[corner] as usize]));
        [p.min(q).min(r), p.max(q).max(r)]
    }
}

/// Puts the vertices into the packed frame, rounded to single precision.
fn pack<V: Vertex>(vertices: &[V], frame: &PackedFrame, packed: &mut [[f32; 4]]) {
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

    /// Of the box before it is rounded outward.
    #[inline(always)]
    fn twice_centre<S: Simd>(&self, simd: S, index: u32) -> f32x4<S> {
        let [min, max] = self.extremes(simd, &self.faces[index as usize]);
        min + max
    }
}
