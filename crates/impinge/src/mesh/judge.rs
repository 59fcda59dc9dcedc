//! The door: arrays are judged once, so that no query can fail.

use rayon::prelude::*;

use super::positions::VertexSlice;
use crate::input::{InputError, InputErrorKind};

/// Coordinates stay below this magnitude, which every finite single precision number does: the range of the proofs.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// Lanes of leaves are numbered with 32 bits; there are at most as many leaves as faces, each of eight lanes.
const MOST_FACES: usize = 1 << 29;

pub(super) fn judge(vertices: VertexSlice<'_>, faces: &[[u32; 3]]) -> Result<(), InputError> {
    let too_many = |what, count| Err(InputError::new(InputErrorKind::TooMany { what, count }));
    if vertices.len() > u32::MAX as usize {
        return too_many("vertices", vertices.len());
    }
    if faces.len() >= MOST_FACES {
        return too_many("faces", faces.len());
    }
    judge_vertices(vertices)?;
    let len = vertices.len();
    let lost = first(faces, |face| face[0].max(face[1]).max(face[2]) as usize >= len);
    if let Some(face) = lost {
        let index = faces[face].into_iter().find(|&vertex| vertex as usize >= len).unwrap_or_default();
        return Err(InputError::new(InputErrorKind::IndexOutOfBounds { face, index, len }));
    }
    Ok(())
}

/// Judges coordinates.
fn judge_vertices(vertices: VertexSlice<'_>) -> Result<(), InputError> {
    let broken = match vertices {
        VertexSlice::F32(vertices) => first(vertices, |v| !(v[0].is_finite() & v[1].is_finite() & v[2].is_finite())),
        VertexSlice::F64(vertices) => {
            first(vertices, |v| !((v[0].abs() < LIMIT) & (v[1].abs() < LIMIT) & (v[2].abs() < LIMIT)))
        }
    };
    if let Some(index) = broken {
        let finite = vertices.get(index).iter().all(|x| x.is_finite());
        return Err(InputError::new(if finite {
            InputErrorKind::OutOfRange { what: "vertex", index, limit: "2^128" }
        } else {
            InputErrorKind::NonFinite { what: "vertex", index }
        }));
    }
    Ok(())
}

/// Judges where the vertices of a mesh, of which there are `expected`, have moved.
pub(super) fn judge_moved(vertices: VertexSlice<'_>, expected: usize) -> Result<(), InputError> {
    if vertices.len() != expected {
        let (what, count) = ("vertices", vertices.len());
        return Err(InputError::new(InputErrorKind::OtherCount { what, count, expected }));
    }
    judge_vertices(vertices)
}

/// The first that is bad. Chunks are judged as wholes, without a branch for each element, as nearly all are good.
fn first<T: Sync>(all: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    const CHUNK: usize = 1 << 12;
    let chunk = all.par_chunks(CHUNK).position_first(|chunk| chunk.iter().fold(false, |any, one| any | is_bad(one)))?;
    all[chunk * CHUNK..].iter().position(is_bad).map(|at| chunk * CHUNK + at)
}
