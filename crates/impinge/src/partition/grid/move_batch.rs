//! Moves of boxes that are processed as one batch.

use super::super::Items;
use crate::volume::MinMax;

/// Number of moves per batch, which are lanes of a vector. All memory of a batch fits the first-level cache, and requesting it in a
/// row lets the processor look up several pages at once. With 32 a step took 1.07 times as long.
pub(super) const BATCH: usize = 16;

/// No key: they are less.
const NONE: u32 = u32::MAX;

/// Boxes that move in their cells, each a short path and each once.
#[derive(Clone, Debug)]
pub(super) struct MoveBatch {
    keys: [u32; BATCH],
    /// Where each comes from, and where it goes.
    boxes: [[MinMax; 2]; BATCH],
    count: usize,
    /// A bit for each key, which others share: most keys have none, and nothing has to be read that was only just written.
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

    /// Where the box of a key is when it is a mover's turn: those before it have moved.
    #[inline]
    pub(super) fn at_turn<'b>(&'b self, items: &'b Items, mover: usize, key: u32) -> Option<&'b MinMax> {
        if !self.holds(key) {
            return items.get(key);
        }
        let own = self.keys.iter().position(|&own| own == key)?;
        Some(&self.boxes[own][usize::from(own < mover)])
    }

    /// Writes a path into the next free place of the batch, which has room. Returns the place and the path.
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
