//! Bytes that are aligned for every element type.

use bytemuck::{Pod, Zeroable};

use super::{Buffer, Pages};

/// A cache line. Its alignment suits every element type.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// Bytes aligned to 64 bytes, which suits every element type. They hold a copy of memory that
/// belongs to somebody else and may change.
pub struct AlignedBytes {
    lines: Buffer<Line>,
    len: usize,
}

impl AlignedBytes {
    /// Returns `len` bytes that are zero.
    #[must_use]
    pub fn zeroed(len: usize) -> Self {
        Self { lines: Pages::zeroed(len.div_ceil(size_of::<Line>())), len }
    }
}

impl AsRef<[u8]> for AlignedBytes {
    fn as_ref(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.lines)[..self.len]
    }
}

impl AsMut<[u8]> for AlignedBytes {
    fn as_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(self.lines.to_mut())[..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aligned_bytes_are_aligned_zeros() {
        for len in [0, 1, 63, 64, 65, 3 << 20] {
            let mut bytes = AlignedBytes::zeroed(len);
            assert_eq!(bytes.as_ref().as_ptr().align_offset(64), 0);
            assert!(bytes.as_ref().len() == len && bytes.as_ref().iter().all(|&byte| byte == 0));
            bytes.as_mut().fill(7);
            assert!(bytes.as_ref().iter().all(|&byte| byte == 7));
        }
    }
}
