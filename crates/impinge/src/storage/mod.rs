//! Plain data that is either owned or borrowed from bytes that somebody else keeps alive.
//!
//! Nodes and packed triangles live behind [`Buffer`], so that a baked file in a memory map, or
//! memory shared between processes, serves a query without a copy.

mod aligned;
mod growing;
mod map;
mod try_push;

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Deref, Range};
use std::sync::Arc;

use bytemuck::Pod;

pub use aligned::AlignedBytes;
pub(crate) use growing::Growing;
use map::Map;
pub(crate) use try_push::{TryPush, try_concat};

/// Bytes that outlive every [`Buffer`] that borrows them: a vector, a memory map.
pub type SharedBytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// Plain data in pages of its own, which the system is asked to make large. With small pages, a
/// query that jumps about in 100 MB waits for page tables, and a build waits for each page to be
/// handed out.
pub struct Pages<T> {
    map: Map,
    len: usize,
    of: PhantomData<T>,
}

impl<T: Pod> Pages<T> {
    /// Returns a buffer of `len` elements that are zero. They are in a vector if they take less
    /// than 2 MiB, if the system refuses pages, or without the feature `mmap`. Otherwise they are
    /// in pages of their own.
    #[must_use]
    pub fn zeroed(len: usize) -> Buffer<T> {
        /// One large page of the usual kind.
        const LARGE: usize = 2 << 20;
        let bytes = len.saturating_mul(size_of::<T>());
        if bytes >= LARGE
            && let Some(map) = map::zeroed(bytes)
        {
            return Buffer::Paged(Self { map, len, of: PhantomData });
        }
        Buffer::Owned(vec![T::zeroed(); len])
    }

    /// Returns a copy of these elements.
    pub(crate) fn copied(elements: &[T]) -> Buffer<T> {
        let mut copy = Self::zeroed(elements.len());
        copy.to_mut().copy_from_slice(elements);
        copy
    }

    fn bytes(&self) -> usize {
        self.len * size_of::<T>()
    }
}

/// A slice of plain data, owned or borrowed from [`SharedBytes`].
pub enum Buffer<T> {
    /// Elements owned in a vector.
    Owned(Vec<T>),
    /// Elements owned in large pages.
    Paged(Pages<T>),
    /// A range of shared bytes. Its length and alignment suit the elements, as
    /// [`borrow`](Self::borrow) checks.
    Borrowed(SharedBytes, Range<usize>),
}

impl<T: Pod> Buffer<T> {
    /// Borrows the elements in the bytes of `range`, without a copy. Returns `None` if the range is
    /// out of bounds, is not a whole number of elements, or is not aligned for them.
    #[must_use]
    pub fn borrow(bytes: SharedBytes, range: Range<usize>) -> Option<Self> {
        let slice = (*bytes).as_ref().get(range.clone())?;
        bytemuck::try_cast_slice::<u8, T>(slice).ok()?;
        Some(Self::Borrowed(bytes, range))
    }
}

impl<T: Pod> Buffer<T> {
    /// Returns the elements for writing. Borrowed elements are copied first.
    #[inline(always)]
    pub fn to_mut(&mut self) -> &mut [T] {
        if let Self::Borrowed(..) = self {
            self.copy();
        }
        match self {
            Self::Owned(elements) => elements,
            Self::Paged(pages) => {
                let bytes = pages.bytes();
                bytemuck::cast_slice_mut(&mut pages.map[..bytes])
            }
            Self::Borrowed(..) => unreachable!("made its own above"),
        }
    }

    #[cold]
    fn copy(&mut self) {
        *self = Self::Owned(self.to_vec());
    }

    /// Returns the first `to` elements. There must be at least `to`.
    fn shortened(mut self, to: usize) -> Self {
        match &mut self {
            Self::Owned(elements) => elements.truncate(to),
            Self::Paged(pages) => pages.len = pages.len.min(to),
            Self::Borrowed(_, range) => range.end = range.end.min(range.start + to * size_of::<T>()),
        }
        self
    }
}

impl<T: Pod> Deref for Buffer<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        match self {
            Self::Owned(elements) => elements,
            Self::Paged(pages) => bytemuck::cast_slice(&pages.map[..pages.bytes()]),
            Self::Borrowed(bytes, range) => bytemuck::cast_slice(&(**bytes).as_ref()[range.clone()]),
        }
    }
}

impl<T: Pod> Clone for Buffer<T> {
    /// Copies owned elements. Borrowed bytes are shared, not copied.
    fn clone(&self) -> Self {
        match self {
            Self::Owned(elements) => Self::Owned(elements.clone()),
            Self::Paged(_) => Pages::copied(self),
            Self::Borrowed(bytes, range) => Self::Borrowed(bytes.clone(), range.clone()),
        }
    }
}

impl<T: Pod + PartialEq> PartialEq for Buffer<T> {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

impl<T> From<Vec<T>> for Buffer<T> {
    fn from(elements: Vec<T>) -> Self {
        Self::Owned(elements)
    }
}

impl<T: Pod + fmt::Debug> fmt::Debug for Buffer<T> {
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
        // A byte vector is aligned by chance only, so start at the first address that suits four
        // bytes.
        let start = (*bytes).as_ref().as_ptr().align_offset(4);
        let end = start + 8;
        let borrowed = Buffer::<u32>::borrow(bytes.clone(), start..end).expect("aligned and in range");
        let copied: Vec<u32> =
            (*bytes).as_ref()[start..end].chunks(4).map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]])).collect();
        assert_eq!(&*borrowed, &*Buffer::from(copied));
    }

    #[test]
    fn pages_are_zeros_that_can_be_changed() {
        for len in [0, 1, 1 << 10, 3 << 20] {
            let mut numbers = Pages::<u32>::zeroed(len);
            assert_eq!(numbers.len(), len);
            let is_large = cfg!(feature = "mmap") && len > 1 << 19;
            assert_eq!(matches!(numbers, Buffer::Paged(_)), is_large, "{len}: large ones in pages of their own");
            assert!(numbers.iter().all(|&x| x == 0));
            for (at, number) in numbers.to_mut().iter_mut().enumerate() {
                *number = at as u32;
            }
            assert!(numbers.iter().enumerate().all(|(at, &x)| x == at as u32));
        }
    }

    #[test]
    fn writing_to_borrowed_elements_changes_a_copy() {
        let bytes: SharedBytes = Arc::new(vec![7_u8; 16]);
        let mut borrowed = Buffer::<u8>::borrow(bytes.clone(), 0..16).expect("in range");
        borrowed.to_mut()[3] = 1;
        assert_eq!((borrowed[3], (*bytes).as_ref()[3]), (1, 7));
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
