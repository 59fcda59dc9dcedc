//! Faces, of which those of a leaf are looked up together.

use fearless_simd::Simd;

use super::leaf::Leaf;
use crate::simd::{LANES, Rows, prefetch_at};

/// The vertices of each of eight triangles, and any fourth number.
pub(in crate::mesh) type VertexRows = [[u32; 4]; LANES];

/// Faces by their vertices.
#[derive(Clone, Copy)]
pub(in crate::mesh) struct Faces<'a>(Rows<'a, u32>);

impl<'a> Faces<'a> {
    pub(in crate::mesh) fn of(faces: &'a [[u32; 3]]) -> Self {
        Self(Rows::of(faces))
    }

    /// All of them.
    #[inline(always)]
    pub(in crate::mesh) fn all(&self) -> &[[u32; 3]] {
        self.0.all()
    }

    /// Asks for a face.
    #[inline(always)]
    pub(in crate::mesh) fn prefetch(&self, face: u32) {
        prefetch_at(self.0.all(), face as usize);
    }

    /// Looks up the vertices of a leaf's faces.
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
