//! A buffer in large pages for elements whose number is not known beforehand.

use std::ops::{Index, IndexMut};

use bytemuck::Pod;

use super::{Buffer, Pages};

/// A buffer that grows at its end.
pub(crate) struct Growing<T> {
    buffer: Buffer<T>,
    len: usize,
}

impl<T: Pod> Growing<T> {
    /// Builds an empty buffer with room for `capacity` elements. If more are pushed, all of them
    /// are moved to a larger buffer. Unused room costs nothing if pages are large.
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        Self { buffer: Pages::zeroed(capacity.max(1)), len: 0 }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn push(&mut self, element: T) {
        if self.len == self.buffer.len() {
            let mut grown = Pages::zeroed(2 * self.len);
            grown.to_mut()[..self.len].copy_from_slice(&self.buffer);
            self.buffer = grown;
        }
        self.buffer.to_mut()[self.len] = element;
        self.len += 1;
    }

    pub(crate) fn into_buffer(self) -> Buffer<T> {
        self.buffer.shortened(self.len)
    }
}

impl<T: Pod> Index<usize> for Growing<T> {
    type Output = T;

    fn index(&self, at: usize) -> &T {
        &self.buffer[..self.len][at]
    }
}

impl<T: Pod> IndexMut<usize> for Growing<T> {
    fn index_mut(&mut self, at: usize) -> &mut T {
        &mut self.buffer.to_mut()[..self.len][at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushed_elements_are_kept_in_order() {
        for (capacity, len) in [(0, 0), (0, 1), (3, 2), (1, 1000), (300_000, 600_000), (700_000, 600_001)] {
            let mut growing = Growing::<u64>::with_capacity(capacity);
            (0..len as u64).for_each(|element| growing.push(element));
            assert_eq!(growing.len(), len);
            if len > 0 {
                growing[len / 2] += 7;
                assert_eq!(growing[len / 2], (len / 2) as u64 + 7);
            }
            let buffer = growing.into_buffer();
            assert_eq!(buffer.len(), len);
            let is_its_own = |(at, &element): (usize, &u64)| element == at as u64 + if at == len / 2 { 7 } else { 0 };
            assert!(buffer.iter().enumerate().all(is_its_own), "{capacity}, {len}");
        }
    }
}
