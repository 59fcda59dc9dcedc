//! Plain data that is either owned or borrowed from bytes that somebody else keeps alive.
//!
//! Nodes and packed triangles live behind [`Buffer`], so that a baked file in a memory map, or memory shared between
//! processes, serves a query without a copy.

use std::fmt;
use std::ops::{Deref, Range};
use std::sync::Arc;

use bytemuck::AnyBitPattern;

/// Bytes that outlive every [`Buffer`] that borrows them: a vector, a memory map.
pub type SharedBytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// A slice of plain data, owned or borrowed from [`SharedBytes`].
#[derive(Clone)]
pub enum Buffer<T> {
    /// Built here.
    Owned(Vec<T>),
    /// A range of somebody else's bytes, checked for length and alignment when it was made.
    Borrowed(SharedBytes, Range<usize>),
}

impl<T: AnyBitPattern> Buffer<T> {
    /// The elements that the bytes of `range` are, or `None` where the range lies outside, is not a whole number of
    /// elements, or is not aligned for them.
    #[must_use]
    pub fn borrow(bytes: SharedBytes, range: Range<usize>) -> Option<Self> {
        let slice = (*bytes).as_ref().get(range.clone())?;
        bytemuck::try_cast_slice::<u8, T>(slice).ok()?;
        Some(Self::Borrowed(bytes, range))
    }
}

impl<T: AnyBitPattern> Deref for Buffer<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match self {
            Self::Owned(elements) => elements,
            Self::Borrowed(bytes, range) => bytemuck::cast_slice(&(**bytes).as_ref()[range.clone()]),
        }
    }
}

impl<T> From<Vec<T>> for Buffer<T> {
    fn from(elements: Vec<T>) -> Self {
        Self::Owned(elements)
    }
}

impl<T: AnyBitPattern + fmt::Debug> fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borrowed_and_owned_read_the_same() {
        let numbers: Vec<u32> = (0..16).collect();
        let bytes: SharedBytes = Arc::new(bytemuck::cast_slice::<u32, u8>(&numbers).to_vec());
        // A vector of bytes is aligned by chance alone: start at the first address that suits four bytes.
        let start = (*bytes).as_ref().as_ptr().align_offset(4);
        let end = start + 8;
        let borrowed = Buffer::<u32>::borrow(bytes.clone(), start..end).expect("aligned and in range");
        let copied: Vec<u32> =
            (*bytes).as_ref()[start..end].chunks(4).map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]])).collect();
        assert_eq!(&*borrowed, &*Buffer::from(copied));
    }

    #[test]
    fn a_range_that_does_not_fit_is_refused() {
        let bytes: SharedBytes = Arc::new(vec![0_u8; 64]);
        let start = (*bytes).as_ref().as_ptr().align_offset(4);
        assert!(Buffer::<u32>::borrow(bytes.clone(), start..start + 6).is_none(), "one element and a half");
        assert!(Buffer::<u32>::borrow(bytes.clone(), start + 1..start + 9).is_none(), "not aligned");
        assert!(Buffer::<u32>::borrow(bytes, 0..65).is_none(), "past the end");
    }
}
