//! The vertices of a mesh, stored in single or double precision.

use std::sync::OnceLock;

use crate::simd::by_axis;
use crate::storage::Buffer;

/// Vertex positions, in the mesh frame and its unit. A coordinate is exactly the real number that
/// its float represents.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// Positions in single precision, stored as given.
    F32(Vec<[f32; 3]>),
    /// Positions in double precision, stored as given.
    F64(Vec<[f64; 3]>),
}

impl From<Vec<[f32; 3]>> for Positions {
    fn from(positions: Vec<[f32; 3]>) -> Self {
        Self::F32(positions)
    }
}

impl From<Vec<[f64; 3]>> for Positions {
    fn from(positions: Vec<[f64; 3]>) -> Self {
        Self::F64(positions)
    }
}

impl From<&[[f32; 3]]> for Positions {
    fn from(positions: &[[f32; 3]]) -> Self {
        Self::F32(positions.to_vec())
    }
}

impl From<&[[f64; 3]]> for Positions {
    fn from(positions: &[[f64; 3]]) -> Self {
        Self::F64(positions.to_vec())
    }
}

impl<const N: usize> From<[[f32; 3]; N]> for Positions {
    fn from(positions: [[f32; 3]; N]) -> Self {
        Self::F32(positions.to_vec())
    }
}

impl<const N: usize> From<[[f64; 3]; N]> for Positions {
    fn from(positions: [[f64; 3]; N]) -> Self {
        Self::F64(positions.to_vec())
    }
}

/// The vertices of a mesh: owned, or borrowed from shared bytes.
#[derive(Debug)]
pub(in crate::mesh) enum Vertices {
    /// Owned positions.
    Given(Positions),
    /// Borrowed single precision positions, and a copy as [`Positions`], made when first requested.
    BorrowedF32(Buffer<[f32; 3]>, OnceLock<Positions>),
    /// Borrowed double precision positions, and a copy as [`Positions`], made when first requested.
    BorrowedF64(Buffer<[f64; 3]>, OnceLock<Positions>),
}

/// A view of vertices, owned or borrowed.
#[derive(Clone, Copy)]
pub(in crate::mesh) enum VertexSlice<'a> {
    F32(&'a [[f32; 3]]),
    F64(&'a [[f64; 3]]),
}

/// A vertex in single or double precision.
pub(in crate::mesh) trait Vertex: Copy + Sync {
    /// Returns the same point in double precision, without rounding.
    fn widened(self) -> [f64; 3];
}

impl Vertex for [f32; 3] {
    #[inline(always)]
    fn widened(self) -> [f64; 3] {
        by_axis!(axis => f64::from(self[axis]))
    }
}

impl Vertex for [f64; 3] {
    #[inline(always)]
    fn widened(self) -> [f64; 3] {
        self
    }
}

impl Vertices {
    /// Returns a vertex in double precision, without rounding.
    #[inline(always)]
    pub(in crate::mesh) fn get(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Given(positions) => positions.get(index),
            Self::BorrowedF32(vertices, _) => vertices[index].widened(),
            Self::BorrowedF64(vertices, _) => vertices[index],
        }
    }

    pub(in crate::mesh) fn slice(&self) -> VertexSlice<'_> {
        match self {
            Self::Given(positions) => positions.slice(),
            Self::BorrowedF32(vertices, _) => VertexSlice::F32(vertices),
            Self::BorrowedF64(vertices, _) => VertexSlice::F64(vertices),
        }
    }

    /// Returns the vertices as [`Positions`]. Borrowed vertices are copied at the first call.
    pub(in crate::mesh) fn positions(&self) -> &Positions {
        match self {
            Self::Given(positions) => positions,
            Self::BorrowedF32(vertices, copy) => copy.get_or_init(|| Positions::F32(vertices.to_vec())),
            Self::BorrowedF64(vertices, copy) => copy.get_or_init(|| Positions::F64(vertices.to_vec())),
        }
    }
}

impl<'a> VertexSlice<'a> {
    pub(in crate::mesh) fn len(self) -> usize {
        match self {
            Self::F32(vertices) => vertices.len(),
            Self::F64(vertices) => vertices.len(),
        }
    }

    pub(in crate::mesh) fn get(self, index: usize) -> [f64; 3] {
        match self {
            Self::F32(vertices) => vertices[index].widened(),
            Self::F64(vertices) => vertices[index],
        }
    }

    /// Returns the coordinates as bytes.
    pub(in crate::mesh) fn into_bytes(self) -> &'a [u8] {
        match self {
            Self::F32(vertices) => bytemuck::cast_slice(vertices),
            Self::F64(vertices) => bytemuck::cast_slice(vertices),
        }
    }
}

impl Positions {
    pub(in crate::mesh) fn slice(&self) -> VertexSlice<'_> {
        match self {
            Self::F32(vertices) => VertexSlice::F32(vertices),
            Self::F64(vertices) => VertexSlice::F64(vertices),
        }
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
        }
    }

    /// Reports whether there are no vertices.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the vertex `index` in double precision, without rounding.
    ///
    /// # Panics
    /// If `index` is not below [`len`](Self::len).
    #[inline(always)]
    #[must_use]
    pub fn get(&self, index: usize) -> [f64; 3] {
        match self {
            Self::F32(v) => v[index].widened(),
            Self::F64(v) => v[index],
        }
    }

    /// Returns the same positions in single precision if that represents every coordinate exactly,
    /// else unchanged.
    pub(in crate::mesh) fn narrowed(self) -> Self {
        let exact = |x: f64| f64::from(x as f32) == x;
        match self {
            Self::F64(vertices) if vertices.iter().flatten().all(|&x| exact(x)) => {
                Self::F32(vertices.into_iter().map(|v| v.map(|x| x as f32)).collect())
            }
            kept => kept,
        }
    }
}
