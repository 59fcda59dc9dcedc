//! Bytes that a Python object lends: they are used in place, without a copy. This is the only file
//! of the crate with `unsafe` code.

use std::slice;

use pyo3::buffer::PyBuffer;

/// Read-only bytes of a Python object, which is kept alive.
///
/// Nothing here writes to the bytes. If other code writes to them although they are read-only,
/// answers may be wrong and queries may panic, as with a mapped file that changes.
/// `impinge._baked.is_constant` rejects the objects for which Python knows a way to write.
pub(crate) struct LentBytes(PyBuffer<u8>);

impl LentBytes {
    /// Returns the bytes of a buffer in place, or the buffer itself if they cannot be used there:
    /// if they are empty, writable, not contiguous, or do not start at a multiple of `alignment`.
    pub(crate) fn of(buffer: PyBuffer<u8>, alignment: usize) -> Result<Self, PyBuffer<u8>> {
        let fits = buffer.readonly()
            && buffer.is_c_contiguous()
            && buffer.len_bytes() > 0
            && buffer.buf_ptr().addr().is_multiple_of(alignment);
        if fits { Ok(Self(buffer)) } else { Err(buffer) }
    }
}

impl AsRef<[u8]> for LentBytes {
    fn as_ref(&self) -> &[u8] {
        // SAFETY: the buffer is contiguous and not empty (`of`), so its pointer and its length
        // describe bytes of one allocation. Python keeps them there until the buffer is released,
        // which its drop does, after the last borrow of `self`. Nobody can guarantee that other
        // code leaves the bytes unchanged; the documentation of `Mesh.from_baked` makes that a duty
        // of the caller. Nothing in the bytes is trusted: every bit pattern is a valid value of the
        // types that are read from it (`bytemuck::Pod`), and every index is checked where it is
        // used. So bytes that change after validation can cause a wrong answer or a panic, but no
        // access out of bounds.
        #[allow(unsafe_code)]
        unsafe {
            slice::from_raw_parts(self.0.buf_ptr().cast::<u8>(), self.0.len_bytes())
        }
    }
}
