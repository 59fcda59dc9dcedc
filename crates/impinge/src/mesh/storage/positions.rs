//! The vertices of a mesh, kept in the precision that they were given in.

use std::sync::OnceLock;

use crate::simd::by_axis;
use crate::storage::Buffer;

/// Vertex positions in the mesh's own frame and unit; a stored coordinate is the real number that its float is.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// Single precision, kept as given.
    F32(Vec<[f32; 3]>),
    /// Double precision, kept as given.
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

/// Vertices as a mesh keeps them: as they were given, or in bytes that somebody else keeps.
#[derive(Debug)]
pub(in crate::mesh) enum Vertices {
    /// Owned.
    Given(Positions),
    /// Borrowed, and a copy for those who ask for [`Positions`].
    BorrowedF32(Buffer<[f32; 3]>, OnceLock<Positions>),
    /// Likewise.
    BorrowedF64(Buffer<[f64; 3]>, OnceLock<Positions>),
}

/// Vertices, whoever keeps them.
#[derive(Clone, Copy)]
pub(in crate::mesh) enum VertexSlice<'a> {
    F32(&'a [[f32; 3]]),
    F64(&'a [[f64; 3]]),
}

/// A vertex in either precision.
pub(in crate::mesh) trait Vertex: Copy + Sync {
    /// The same point in double precision.
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
    #[inline(always)]
    pub(in crate::mesh) fn get(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Given(positions) => positions.get(index),
            Self::BorrowedF32(vertices, _) => vertices[index].map(f64::from),
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

    /// The vertices as they were given; a copy, made once, where they are borrowed.
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

    /// The numbers as bytes.
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

    /// How many vertices there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Vertex `index` in double precision, which holds either kind without rounding.
    ///
    /// # Panics
    /// Where `index` is not below [`len`](Self::len).
    #[inline(always)]
    #[must_use]
    pub fn get(&self, index: usize) -> [f64; 3] {
        match self {
            Self::F32(v) => v[index].map(f64::from),
            Self::F64(v) => v[index],
        }
    }

    /// The same positions in single precision where that holds every coordinate exactly, unchanged otherwise.
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
