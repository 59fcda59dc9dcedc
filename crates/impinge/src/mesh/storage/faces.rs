//! Faces by their vertex indices; all faces of a leaf are looked up together.

use fearless_simd::Simd;

use super::leaf::Leaf;
use crate::simd::{LANES, Rows, prefetch_at};

/// The vertex indices of eight triangles. The fourth number of each row has no meaning.
pub(in crate::mesh) type VertexRows = [[u32; 4]; LANES];

/// The faces of a mesh by their vertex indices.
#[derive(Clone, Copy)]
pub(in crate::mesh) struct Faces<'a>(Rows<'a, u32>);

impl<'a> Faces<'a> {
    pub(in crate::mesh) fn of(faces: &'a [[u32; 3]]) -> Self {
        Self(Rows::of(faces))
    }

    /// Returns the vertex indices of all faces.
    #[inline(always)]
    pub(in crate::mesh) fn all(&self) -> &[[u32; 3]] {
        self.0.all()
    }

    /// Prefetches the vertex indices of a face.
    #[inline(always)]
    pub(in crate::mesh) fn prefetch(&self, face: u32) {
        prefetch_at(self.0.all(), face as usize);
    }

    /// Writes the vertex indices of all faces of a leaf to `rows`, one row per lane.
    #[inline(always)]
    pub(in crate::mesh) fn look_up<S: Simd>(&self, simd: S, leaf: &Leaf, rows: &mut VertexRows) {
        if let Some(inside) = self.0.inside(simd, &leaf.faces) {
            for lane in 0..LANES {
                rows[lane] = *inside.row(lane);
            }
        } else {
            for lane in 0..LANES {
                rows[lane] = *self.0.row(leaf.faces[lane]);
            }
        }
    }
}
