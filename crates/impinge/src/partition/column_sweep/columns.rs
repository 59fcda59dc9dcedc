//! Columns in memory: each a chain of blocks, so that boxes find their places in one pass.

use super::frame::{Frame, Record};
use crate::volume::MinMax;

/// Copies in a block: 2 KiB, so that what is left empty in the last block of a column is little, and few links are followed.
const BLOCK: usize = 64;

/// Not a block.
const NONE: u32 = u32::MAX;

/// The copies of a run of boxes, by column.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    records: Vec<Record>,
    /// For each block in use the one before it in its column.
    links: Vec<u32>,
    /// For each column where its next copy goes: one past its last; zero where it has none.
    next: Vec<u32>,
}

impl Columns {
    /// Puts copies of these boxes, whose keys are counted from `first`, in place of all others.
    pub(super) fn fill(&mut self, frame: &Frame, boxes: &[MinMax], first: u32) {
        self.links.clear();
        self.next.clear();
        self.next.resize(frame.len(), 0);
        for (at, bounds) in boxes.iter().enumerate() {
            let record = frame.image(bounds, first + at as u32);
            frame.each_copy(record, |column, copy| self.push(column, copy));
        }
    }

    #[inline(always)]
    fn push(&mut self, column: usize, record: Record) {
        let mut at = self.next[column];
        if at as usize % BLOCK == 0 {
            at = self.open(at);
        }
        self.records[at as usize] = record;
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
