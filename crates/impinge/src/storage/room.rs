//! Memory that a build uses twice: for what it needs in passing, then for what it leaves behind.
//!
//! The system clears each page before it hands it out, and hands it out when it is first touched: a fourth of the time of a
//! build goes there, so that it pays to touch fewer.

use std::mem::size_of;

use bytemuck::{Pod, Zeroable};

use super::{Buffer, Pages};

/// Memory to be used for one thing after another.
pub(crate) struct Room {
    lines: Buffer<Line>,
    passing: usize,
}

/// Aligned for whatever is put there.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

impl Room {
    /// Room for so many bytes in passing, and then for about as many bytes as shall last. Room that is never used costs
    /// nothing.
    pub(crate) fn new(passing: usize, lasting: usize) -> Self {
        Self { lines: Pages::zeroed(lines(passing.max(lasting))), passing }
    }

    /// All of it, with whatever was left there.
    pub(crate) fn space(&mut self) -> Space<'_> {
        Space(self.lines.to_mut())
    }

    /// Elements to be written, in the same memory where they take most of what was used in passing, and zeros where
    /// they do not.
    pub(crate) fn into_buffer<T: Pod>(self, len: usize) -> Buffer<T> {
        let bytes = len.saturating_mul(size_of::<T>());
        match self.lines {
            Buffer::Paged(pages) if self.passing <= bytes + bytes / 4 => pages.cast(len),
            _ => Pages::zeroed(len),
        }
    }
}

/// Bytes that are aligned for whatever may lie in them: a copy of what somebody else keeps, and may change.
pub struct AlignedBytes {
    lines: Buffer<Line>,
    len: usize,
}

impl AlignedBytes {
    /// As many zeros.
    #[must_use]
    pub fn zeroed(len: usize) -> Self {
        Self { lines: Pages::zeroed(lines(len)), len }
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

/// What is left of a room.
pub(crate) struct Space<'a>(&'a mut [Line]);

impl<'a> Space<'a> {
    /// How many bytes [`take`](Self::take) takes.
    pub(crate) fn of<T>(len: usize) -> usize {
        len.saturating_mul(size_of::<T>()).next_multiple_of(size_of::<Line>())
    }

    /// A part of so many bytes, as [`of`](Self::of) counts them.
    pub(crate) fn part(&mut self, bytes: usize) -> Space<'a> {
        let all = std::mem::take(&mut self.0);
        let (part, rest) = all.split_at_mut(lines(bytes).min(all.len()));
        self.0 = rest;
        Space(part)
    }

    /// What is left of it, to be used for one thing before another.
    pub(crate) fn rest(&mut self) -> Space<'_> {
        Space(self.0)
    }

    /// As many elements as fit, at most `len`: all where the room was made for them.
    pub(crate) fn take<T: Pod>(&mut self, len: usize) -> &'a mut [T] {
        let (_, elements, _) = bytemuck::pod_align_to_mut::<Line, T>(self.part(Self::of::<T>(len)).0);
        let len = len.min(elements.len());
        &mut elements[..len]
    }
}

fn lines(bytes: usize) -> usize {
    bytes.div_ceil(size_of::<Line>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_lies_side_by_side_and_what_lasts_takes_its_place() {
        for scale in [1, 1 << 16] {
            let (numbers, words) = (10 * scale, 7 * scale);
            let passing = Space::of::<[f32; 4]>(words) + Space::of::<u64>(numbers);
            let mut room = Room::new(passing, 3 * passing);
            let mut space = room.space();
            let (taken_words, taken_numbers) = (space.take::<[f32; 4]>(words), space.take::<u64>(numbers));
            assert_eq!((taken_words.len(), taken_numbers.len()), (words, numbers));
            taken_words.fill([1.0; 4]);
            taken_numbers.fill(2);
            assert!(taken_words.iter().all(|&word| word == [1.0; 4]));
            let mut lasting = room.into_buffer::<[u16; 48]>(passing / 64);
            assert_eq!(lasting.len(), passing / 64);
            let reused = lasting[0] != [0; 48];
            assert_eq!(reused, scale > 1, "small rooms are not worth it");
            lasting.to_mut().fill([7; 48]);
            assert!(lasting.iter().all(|element| element == &[7; 48]));
        }
    }

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

    #[test]
    fn what_lasts_and_is_smaller_or_does_not_fit_has_memory_of_its_own() {
        const LARGE: usize = 1 << 22;
        for len in [LARGE / 2, 3 * LARGE] {
            let mut room = Room::new(LARGE, 2 * LARGE);
            room.space().take::<u8>(LARGE).fill(1);
            let buffer = room.into_buffer::<u8>(len);
            assert_eq!(buffer.len(), len);
            assert!(buffer.iter().all(|&byte| byte == 0), "{len}");
        }
    }
}
