//! Moves of boxes that are processed as one batch.

use super::super::Items;
use crate::volume::MinMax;

/// Number of moves per batch, which are lanes of a vector. All memory of a batch fits into the
/// first-level cache, and prefetching it together lets the processor translate several addresses at
/// once. With 32, a step took 1.07 times as long.
pub(super) const BATCH: usize = 16;

/// Value that stands for "no key". All keys are smaller.
const NONE: u32 = u32::MAX;

/// A batch of moves, each along a short path and each of a different box.
#[derive(Clone, Debug)]
pub(super) struct MoveBatch {
    keys: [u32; BATCH],
    /// Start and end of each path.
    boxes: [[MinMax; 2]; BATCH],
    count: usize,
    /// Set of the keys modulo 64, one bit each. Most keys outside the batch have no bit here, so
    /// that their comparison is skipped.
    seen: u64,
}

impl MoveBatch {
    pub(super) fn new() -> Self {
        let nowhere = MinMax::from_ordered([0.0; 3], [0.0; 3]);
        Self { keys: [NONE; BATCH], boxes: [[nowhere; 2]; BATCH], count: 0, seen: 0 }
    }

    #[inline]
    pub(super) fn of(&self, mover: usize) -> (u32, &[MinMax; 2]) {
        (self.keys[mover], &self.boxes[mover])
    }

    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = (u32, &[MinMax; 2])> {
        (0..self.count).map(|mover| self.of(mover))
    }

    #[inline(always)]
    pub(super) fn holds(&self, key: u32) -> bool {
        self.seen >> (key % 64) & 1 == 1 && self.keys.contains(&key)
    }

    /// Returns the box of a key at the time of a move, after the moves that precede it in the
    /// batch.
    #[inline]
    pub(super) fn at_turn<'b>(&'b self, items: &'b Items, mover: usize, key: u32) -> Option<&'b MinMax> {
        if !self.holds(key) {
            return items.get(key);
        }
        let own = self.keys.iter().position(|&own| own == key)?;
        Some(&self.boxes[own][usize::from(own < mover)])
    }

    /// Writes a path into the next free place of the batch, which must have room. Returns the place
    /// and the path.
    #[inline(always)]
    pub(super) fn next(&mut self, from: &MinMax, to: &MinMax) -> (usize, &[MinMax; 2]) {
        let mover = self.count;
        self.boxes[mover][0] = *from;
        self.boxes[mover][1] = *to;
        (mover, &self.boxes[mover])
    }

    /// Adds the path that was written last, for the box of a key.
    #[inline(always)]
    pub(super) fn add(&mut self, key: u32) {
        self.keys[self.count] = key;
        self.seen |= 1 << (key % 64);
        self.count += 1;
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count == BATCH
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.keys = [NONE; BATCH];
        self.count = 0;
        self.seen = 0;
    }
}
