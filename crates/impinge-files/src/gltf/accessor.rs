//! Reads accessors: typed views of bytes, strided, normalized or sparse (glTF 2.0 specification,
//! §3.6.2 and §5.1).

use crate::error::{LoadError, LoadErrorKind, Place};

use super::{
    buffer::Buffers,
    document::{Accessor, Document, Sparse},
};

/// A document with its buffers.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
    /// Length of the document's JSON text, in bytes.
    pub(super) json_len: u64,
}

/// Component types by their OpenGL numbers.
pub(super) const I8: u32 = 5120;
pub(super) const U8: u32 = 5121;
pub(super) const I16: u32 = 5122;
pub(super) const U16: u32 = 5123;
const U32: u32 = 5125;
pub(super) const F32: u32 = 5126;

/// Number of elements without data that any file may have. They take about 100 KiB. A larger value
/// lets tiny hostile files take more memory.
const FEW_ZEROS: u64 = 2048;

impl Source<'_> {
    /// Returns the number of elements of an accessor. Returns an error if its buffer view has no
    /// room for them.
    pub(super) fn count(&self, accessor: u32) -> Result<u64, LoadError> {
        let found = self.accessor(accessor)?;
        match self.room(found) {
            Some(room) if found.count > room => {
                Err(in_accessor(LoadError::truncated("elements", found.count, room), accessor))
            }
            _ => Ok(found.count),
        }
    }

    fn accessor(&self, index: u32) -> Result<&Accessor, LoadError> {
        self.document.accessors.get(index as usize).ok_or_else(|| missing("accessor", index))
    }

    /// Returns the number of elements that the buffer view of an accessor has room for. Returns
    /// `None` if it has no view, or if reading it fails for another reason.
    fn room(&self, accessor: &Accessor) -> Option<u64> {
        let width = match &*accessor.shape {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => return None,
        };
        let size = match accessor.component_type {
            I8 | U8 => 1,
            I16 | U16 => 2,
            U32 | F32 => 4,
            _ => return None,
        };
        let (bytes, stride) = self.view(accessor.buffer_view?).ok()?;
        let element = width * size;
        Some(room(bytes, accessor.byte_offset, element, stride.unwrap_or(element)))
    }

    /// Returns the number of elements that reading an accessor decodes: its own, and those that
    /// replace them.
    pub(super) fn decoded(&self, accessor: u32) -> Result<u64, LoadError> {
        Ok(self.count(accessor)?.saturating_add(self.sparse_count(accessor)?))
    }

    /// Returns the number of elements that replace those of an accessor.
    pub(super) fn sparse_count(&self, accessor: u32) -> Result<u64, LoadError> {
        let found = self.accessor(accessor)?;
        Ok(found.sparse.as_ref().map_or(0, |sparse| sparse.count))
    }

    /// Returns the positions of an accessor in f64, which holds the values of every component type.
    /// Returns an error if a coordinate is not finite.
    pub(super) fn positions(&self, accessor: u32) -> Result<Vec<[f64; 3]>, LoadError> {
        let positions = self.elements::<3>(accessor, "VEC3", &[F32, I8, U8, I16, U16]);
        let positions = positions.map_err(|e| in_accessor(e, accessor))?;
        match positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            None => Ok(positions),
            Some(vertex) => {
                let error = LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 });
                Err(in_accessor(error, accessor))
            }
        }
    }

    /// Returns the indices of an accessor. Returns an error if an index is not below `len`.
    pub(super) fn indices(&self, accessor: u32, len: usize) -> Result<Vec<u32>, LoadError> {
        let indices = self.elements::<1>(accessor, "SCALAR", &[U8, U16, U32]).map_err(|e| in_accessor(e, accessor))?;
        let checked = indices.iter().enumerate().map(|(i, &[index])| {
            // The cast is exact: the value was read from an integer of at most 32 bits.
            let index = index as u32;
            if (index as usize) < len {
                return Ok(index);
            }
            let kind = LoadErrorKind::IndexOutOfBounds { face: i as u64 / 3, index: index.into(), len: len as u64 };
            Err(in_accessor(LoadError::new(kind), accessor))
        });
        checked.collect()
    }

    /// Returns the elements of an accessor in f64; they may be NaN. Returns an error if its shape
    /// is not `shape` or its component type is not in `types`.
    pub(super) fn numbers<const N: usize>(
        &self,
        accessor: u32,
        shape: &str,
        types: &[u32],
    ) -> Result<Vec<[f64; N]>, LoadError> {
        self.elements::<N>(accessor, shape, types).map_err(|e| in_accessor(e, accessor))
    }

    fn elements<const N: usize>(&self, index: u32, shape: &str, types: &[u32]) -> Result<Vec<[f64; N]>, LoadError> {
        let accessor = self.accessor(index)?;
        if *accessor.shape != *shape {
            return Err(LoadError::syntax(format!("an accessor of type {shape}"), accessor.shape.as_bytes()));
        }
        if !types.contains(&accessor.component_type) {
            let found = accessor.component_type.to_string();
            return Err(LoadError::syntax(format!("a component type out of {types:?}"), found.as_bytes()));
        }
        let mut elements = match accessor.buffer_view {
            Some(view) => self.dense(view, accessor.byte_offset, accessor.count, accessor.component_type)?,
            None => self.zeros(accessor.count)?,
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(&mut elements, sparse, accessor.component_type)?;
        }
        if accessor.normalized {
            let (scale, low) = match accessor.component_type {
                I8 => (127.0, -1.0),
                U8 => (255.0, 0.0),
                I16 => (32767.0, -1.0),
                U16 => (65535.0, 0.0),
                _ => (1.0, f64::NEG_INFINITY),
            };
            elements.as_flattened_mut().iter_mut().for_each(|x| *x = (*x / scale).max(low));
        }
        Ok(elements)
    }

    /// Returns the elements of an accessor without a view: zeros, some of which sparse elements may
    /// replace.
    ///
    /// Zeros take no space in the file, so their number is limited to the number of bytes of the
    /// document and its buffers, or [`FEW_ZEROS`] if that is more.
    fn zeros<const N: usize>(&self, count: u64) -> Result<Vec<[f64; N]>, LoadError> {
        let limit = (self.json_len + self.buffers.total_len()).max(FEW_ZEROS);
        if count <= limit {
            return Ok(vec![[0.0; N]; count as usize]);
        }
        Err(LoadError::new(LoadErrorKind::TooMany { what: "elements without data", count, limit }))
    }

    /// Replaces elements by those of a sparse accessor.
    fn replace<const N: usize>(
        &self,
        elements: &mut [[f64; N]],
        sparse: &Sparse,
        component_type: u32,
    ) -> Result<(), LoadError> {
        let at = &sparse.indices;
        if ![U8, U16, U32].contains(&at.component_type) {
            let found = at.component_type.to_string();
            return Err(LoadError::syntax("an unsigned integer type of sparse indices", found.as_bytes()));
        }
        let indices = self.dense::<1>(at.buffer_view, at.byte_offset, sparse.count, at.component_type)?;
        let values =
            self.dense::<N>(sparse.values.buffer_view, sparse.values.byte_offset, sparse.count, component_type)?;
        for (&[index], value) in indices.iter().zip(values) {
            let len = elements.len();
            let Some(element) = elements.get_mut(index as usize) else {
                let found = format!("{index} of {len}");
                return Err(LoadError::syntax("a sparse index that exists", found.as_bytes()));
            };
            *element = value;
        }
        Ok(())
    }

    /// Returns the elements of a buffer view.
    fn dense<const N: usize>(
        &self,
        view: u32,
        offset: u64,
        count: u64,
        component_type: u32,
    ) -> Result<Vec<[f64; N]>, LoadError> {
        match component_type {
            I8 => self.strided(view, offset, count, |[a]| f64::from(a.cast_signed())),
            U8 => self.strided(view, offset, count, |[a]| f64::from(a)),
            I16 => self.strided(view, offset, count, |b| f64::from(i16::from_le_bytes(b))),
            U16 => self.strided(view, offset, count, |b| f64::from(u16::from_le_bytes(b))),
            U32 => self.strided(view, offset, count, |b| f64::from(u32::from_le_bytes(b))),
            _ => self.strided(view, offset, count, |b| f64::from(f32::from_le_bytes(b))),
        }
    }

    fn strided<const N: usize, const B: usize>(
        &self,
        view: u32,
        offset: u64,
        count: u64,
        value: impl Fn([u8; B]) -> f64,
    ) -> Result<Vec<[f64; N]>, LoadError> {
        let (bytes, stride) = self.view(view)?;
        let size = (N * B) as u64;
        let stride = stride.unwrap_or(size);
        if stride < size {
            let found = stride.to_string();
            return Err(LoadError::syntax(format!("a byte stride of {size} or more"), found.as_bytes()));
        }
        if count == 0 {
            return Ok(Vec::new());
        }
        let room = room(bytes, offset, size, stride);
        if count > room {
            return Err(LoadError::truncated("elements", count, room));
        }
        let element = |at: usize| {
            let chunks = bytes[at..at + N * B].as_chunks::<B>().0;
            std::array::from_fn(|k| value(chunks[k]))
        };
        Ok((0..count as usize).map(|i| element(offset as usize + i * stride as usize)).collect())
    }

    /// Returns the bytes of a buffer view, and its stride if it states one.
    fn view(&self, index: u32) -> Result<(&[u8], Option<u64>), LoadError> {
        let view = self.document.buffer_views.get(index as usize).ok_or_else(|| missing("buffer view", index))?;
        let Some(bytes) = self.buffers.get(view.buffer) else {
            return Err(match view.extensions.meshopt {
                Some(_) => super::extensions::lacking("EXT_meshopt_compression"),
                None => LoadError::syntax(format!("data in buffer {}", view.buffer), b""),
            });
        };
        let end = view.byte_offset.saturating_add(view.byte_length);
        if end > bytes.len() as u64 {
            let what = format!("bytes of buffer {} up to the end of view {index}", view.buffer);
            return Err(LoadError::truncated(what, end, bytes.len() as u64));
        }
        Ok((&bytes[view.byte_offset as usize..end as usize], view.byte_stride))
    }
}

/// Returns the number of elements of `size` bytes that fit after an offset: the number of complete
/// strides, plus the last element, whose stride may be cut off.
fn room(bytes: &[u8], offset: u64, size: u64, stride: u64) -> u64 {
    let room = (bytes.len() as u64).saturating_sub(offset);
    if room < size { 0 } else { (room - size) / stride.max(1) + 1 }
}

fn in_accessor(error: LoadError, accessor: u32) -> LoadError {
    error.at(Place::Entry(format!("accessor {accessor}")))
}

/// Returns the error that an entry does not exist.
pub(super) fn missing(what: &str, index: u32) -> LoadError {
    LoadError::syntax(format!("{what} {index}"), b"")
}
