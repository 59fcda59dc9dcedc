//! Validates arrays once, when they enter the library, so that no query can fail
//! (docs/notes/proof.md, L0).

use rayon::prelude::*;

use crate::input::{InputError, InputErrorKind};
use crate::mesh::storage::frame::Extremes;
use crate::mesh::storage::positions::{Vertex, VertexSlice};
use crate::simd::{CACHE_LINE, prefetch_at};

/// Exclusive limit for the magnitude of a coordinate: 2^128, the range of the proofs. Every finite
/// single precision number is below it.
const COORDINATE_LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// Maximum number of vertices. Faces name them with 32 bits.
const MAX_VERTICES: usize = u32::MAX as usize;

/// Maximum number of faces. Lanes of leaves are numbered with 32 bits, and there may be as many
/// leaves as faces, with eight lanes each.
const MAX_FACES: usize = (1 << 29) - 1;

/// Number of vertices, or of indices of faces, per task.
const CHUNK: usize = 1 << 10;

/// Validates the vertices and faces of a mesh. Returns the minimum and maximum coordinates of the
/// vertices.
pub(in crate::mesh) fn validate(vertices: VertexSlice<'_>, faces: &[[u32; 3]]) -> Result<Extremes, InputError> {
    for (what, count, limit) in [("vertices", vertices.len(), MAX_VERTICES), ("faces", faces.len(), MAX_FACES)] {
        if count > limit {
            return Err(InputError::new(InputErrorKind::TooMany { what, count, limit }));
        }
    }
    let extremes = validate_vertices(vertices)?;
    let len = vertices.len();
    // Indices are compared in one sequence and not face by face, so that the compiler vectorizes
    // it.
    let indices = faces.as_flattened();
    if let Some(lost) = first(indices, |&index| index >= len as u32) {
        let (face, index) = (lost / 3, indices[lost]);
        return Err(InputError::new(InputErrorKind::IndexOutOfBounds { face, index, len }));
    }
    Ok(extremes)
}

/// Validates coordinates.
fn validate_vertices(vertices: VertexSlice<'_>) -> Result<Extremes, InputError> {
    let validated = match vertices {
        VertexSlice::F32(vertices) => extremes(vertices, Extremes::of),
        VertexSlice::F64(vertices) => extremes(vertices, Extremes::of),
    };
    validated.map_err(|index| {
        let finite = vertices.get(index).iter().all(|x| x.is_finite());
        InputError::new(if finite {
            InputErrorKind::OutOfRange { what: "vertex", index, limit: "2^128" }
        } else {
            InputErrorKind::NonFinite { what: "vertex", index }
        })
    })
}

/// Validates the moved vertices of a mesh that must have `expected` vertices.
pub(super) fn validate_moved(vertices: VertexSlice<'_>, expected: usize) -> Result<Extremes, InputError> {
    if vertices.len() != expected {
        let (what, count) = ("vertices", vertices.len());
        return Err(InputError::new(InputErrorKind::OtherCount { what, count, expected }));
    }
    validate_vertices(vertices)
}

/// Returns the minimum and maximum coordinates if all vertices are valid, else the index of the
/// first invalid vertex. One pass does both, as reading the vertices is most of the cost.
fn extremes<V: Vertex>(vertices: &[V], of_chunk: impl Fn(&[V]) -> Extremes + Sync) -> Result<Extremes, usize> {
    let are_good = |extremes: &Extremes| extremes.are_below(COORDINATE_LIMIT);
    let both = |a: Extremes, b: Extremes| Some(a.union(b));
    let validated = vertices.par_chunks(CHUNK).map(|chunk| Some(of_chunk(chunk)).filter(are_good));
    let is_bad = |vertex: &V| !vertex.widened().iter().all(|x| x.abs() < COORDINATE_LIMIT);
    validated.try_reduce(|| Extremes::NONE, both).ok_or_else(|| first(vertices, is_bad).unwrap_or_default())
}

/// Returns the index of the first invalid element.
fn first<T: Sync>(elements: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let chunk = elements.par_chunks(CHUNK).position_first(|chunk| !all(chunk, |one| !is_bad(one)))?;
    elements[chunk * CHUNK..].iter().position(is_bad).map(|at| chunk * CHUNK + at)
}

/// Reports whether all elements are valid. There is no branch per element, as nearly all are valid.
/// The elements after these are prefetched earlier than the processor does by itself.
#[inline(always)]
fn all<T>(elements: &[T], is_good: impl Fn(&T) -> bool) -> bool {
    (0..elements.len()).step_by(CACHE_LINE / size_of::<T>()).for_each(|at| prefetch_at(elements, elements.len() + at));
    elements.iter().fold(true, |all, one| all & is_good(one))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whichever index is out of bounds, in the first chunk or a later one, the first of several is
    /// named.
    #[test]
    fn the_first_index_out_of_bounds_is_reported() {
        let vertices = [[0.0_f32; 3]; 5];
        let vertices = VertexSlice::F32(&vertices);
        let faces = vec![[0, 4, 2]; CHUNK];
        assert!(validate(vertices, &faces).is_ok());
        for at in [0, 1, CHUNK / 3 - 1, CHUNK / 3, CHUNK / 3 + 1, CHUNK - 1] {
            for corner in 0..3 {
                for index in [5, 6, 1 << 31, u32::MAX] {
                    let mut faces = faces.clone();
                    faces[at][corner] = index;
                    faces[CHUNK - 1][2] = index;
                    let expected = InputErrorKind::IndexOutOfBounds { face: at, index, len: 5 };
                    let refused = validate(vertices, &faces).map_err(|error| error.kind().clone());
                    assert_eq!(refused, Err(expected), "at {at}, corner {corner}");
                }
            }
        }
    }
}
