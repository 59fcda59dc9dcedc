//! The vertices of a mesh, kept in the precision that they were given in.

use crate::simd::by_axis;

/// Vertex positions in the mesh's own frame and unit; a stored coordinate is the real number that its float is.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// Single precision, kept as given.
    F32(Vec<[f32; 3]>),
    /// Double precision, kept as given.
    F64(Vec<[f64; 3]>),
}

/// A vertex in either precision.
pub(super) trait Vertex: Copy + Sync {
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

impl Positions {
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
    pub(super) fn narrowed(self) -> Self {
        let exact = |x: f64| f64::from(x as f32) == x;
        match self {
            Self::F64(vertices) if vertices.iter().flatten().all(|&x| exact(x)) => {
                Self::F32(vertices.into_iter().map(|v| v.map(|x| x as f32)).collect())
            }
            kept => kept,
        }
    }
}
