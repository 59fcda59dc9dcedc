//! Columns in memory: each a chain of blocks, so that boxes find their places in one pass.

use fearless_simd::{Simd, dispatch};

use super::frame::{Frame, LEVELS, Record, Spot, Tag};
use crate::simd::{best_level, prefetch};
use crate::volume::MinMax;

/// Copies in a block: 2 KiB, so that what is left empty in the last block of a column is little, and few links are followed.
const BLOCK: usize = 64;

/// Not a block.
const NONE: u32 = u32::MAX;

/// Images that are made at a time: in a loop of their own they take the vector unit.
const BATCH: usize = 64;

/// The copies of a run of boxes, by column.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    records: Vec<Record>,
    /// For each block in use the one before it in its column.
    links: Vec<u32>,
    /// For each column where its next copy goes: one past its last; zero where it has none.
    next: Vec<u32>,
    /// Boxes of each level.
    counts: [u32; LEVELS],
}

impl Columns {
    /// Puts copies of these boxes, whose keys are counted from `first`, in place of all others.
    pub(super) fn fill(&mut self, frame: &Frame, boxes: &[MinMax], first: u32) {
        self.links.clear();
        self.next.clear();
        self.next.resize(frame.len(), 0);
        self.counts = [0; LEVELS];
        let mut images = [Record::default(); BATCH];
        let mut spots = [Spot::default(); BATCH];
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            for (at, boxes) in boxes.chunks(BATCH).enumerate() {
                let first = first + (at * BATCH) as u32;
                for ((image, bounds), key) in images.iter_mut().zip(boxes).zip(first..) {
                    *image = frame.image(bounds, key);
                }
                for (spot, image) in spots.iter_mut().zip(&images[..boxes.len()]) {
                    *spot = frame.spot(image);
                    // The block is far from the processor, as all columns take turns.
                    if let Some(next) = self.records.get(self.next[spot.bucket] as usize) {
                        prefetch(next);
                    }
                }
                for (spot, image) in spots.iter().zip(&images[..boxes.len()]) {
                    frame.each_copy(spot, #[inline(always)] |column, tag| self.push(column, image, tag));
                    self.counts[spot.level] += 1;
                }
            }
        }));
    }

    /// Boxes of a level.
    pub(super) fn count(&self, level: usize) -> u32 {
        self.counts[level]
    }

    /// Copies from memory to memory: a record that is put together first is stored in parts and read as a whole, for which
    /// processors wait.
    #[inline(always)]
    fn push(&mut self, column: usize, image: &Record, tag: Tag) {
        let mut at = self.next[column];
        if at.is_multiple_of(BLOCK as u32) {
            at = self.open(at);
        }
        let record = &mut self.records[at as usize];
        *record = *image;
        record.tag = tag;
        self.next[column] = at + 1;
    }

    /// Opens a block for a column that has none, or whose last one ends at `full`.
    #[cold]
    fn open(&mut self, full: u32) -> u32 {
        let block = self.links.len();
        self.links.push(if full == 0 { NONE } else { full / BLOCK as u32 - 1 });
        if self.records.len() < (block + 1) * BLOCK {
            self.records.resize((block + 1) * BLOCK, Record::default());
        }
        (block * BLOCK) as u32
    }

    /// The copies of a column, a block at a time.
    pub(super) fn blocks(&self, column: usize) -> impl Iterator<Item = &[Record]> {
        let mut end = self.next[column] as usize;
        std::iter::from_fn(move || {
            let block = end.checked_sub(1)? / BLOCK;
            let copies = &self.records[block * BLOCK..end];
            end = if self.links[block] == NONE { 0 } else { (self.links[block] as usize + 1) * BLOCK };
            Some(copies)
        })
    }
}
