//! Columns in memory: each a chain of blocks, so that one pass puts boxes into their columns.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x16};

use super::frame::{Frame, LEVELS, MAX_EXTENT, WIDTH, nearest};
use super::record::{Record, from_next, interval};
use crate::simd::{best_level, by_axis, dispatch, prefetch};
use crate::volume::MinMax;

/// Number of copies in a block: 1 KiB. Larger blocks leave more memory empty in the last block of a
/// column; smaller ones need more links.
const BLOCK: usize = 64;

/// Block number that stands for "no block".
const NONE: u32 = u32::MAX;

/// Maximum number of columns that a box of regular size reaches into.
const MAX_COPIES: usize = 4;

/// Bit in [`Batch::lacks`] for boxes that are too large for the finest level or outside its
/// columns. The lower two bits stand for the axes.
const SPECIAL: u32 = 1 << 2;

/// Number of boxes that are distributed at a time. Each step has its own loop over a batch, so that
/// the compiler can vectorize it.
const BATCH: usize = 64;

/// Copies of a run of boxes, by column.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    records: Vec<Record>,
    /// Number of the preceding block in the same column, for each block.
    links: Vec<u32>,
    /// Number of blocks in use.
    used: usize,
    /// Index at which the next copy of each column goes, one past its last copy. Zero if the column
    /// is empty.
    next: Vec<u32>,
    /// For each place of a column in memory: `true` if several columns may share it.
    shared: Vec<bool>,
    /// Number of boxes in each level.
    counts: [u32; LEVELS],
}

impl Columns {
    /// Replaces all copies by copies of these boxes, whose keys are counted from `first`.
    pub(super) fn fill(&mut self, frame: &Frame, boxes: &[MinMax], first: u32) {
        self.used = 0;
        self.next.clear();
        self.next.resize(frame.len(), 0);
        self.shared.clear();
        for level in 0..LEVELS {
            self.shared.resize(frame.columns(level).end, frame.is_folded(level));
        }
        self.counts = [0; LEVELS];
        let mut batch = Batch::default();
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            for (at, boxes) in boxes.chunks(BATCH).enumerate() {
                batch.image(frame, boxes);
                batch.place(frame);
                batch.take_steps(frame);
                self.push_all(simd, frame, &batch, boxes, first + (at * BATCH) as u32);
            }
        }));
    }

    #[inline(always)]
    fn push_all<S: Simd>(&mut self, simd: S, frame: &Frame, batch: &Batch, boxes: &[MinMax], first: u32) {
        self.reserve(MAX_COPIES * boxes.len());
        // Local slices, so that the compiler knows that no other write changes them.
        let (records, links, next) = (&mut self.records[..], &mut self.links[..], &mut self.next[..]);
        let used = &mut self.used;
        for &place in &batch.place[..boxes.len()] {
            // The block is probably not in the cache, because writes go to all columns in turn.
            if let Some(next) = records.get(next[place as usize] as usize) {
                prefetch(next);
            }
        }
        let mut push = |place: u32, record| push(records, links, next, used, place, record);
        let all = u64::MAX >> (BATCH - boxes.len());
        let [regular, x, y] = [batch.with(simd, SPECIAL) & all, batch.with(simd, 1), batch.with(simd, 2)];
        // Bit masks select the boxes that have each copy, because a branch per box would be
        // unpredictable.
        for (copy, boxes) in (0..).zip([regular, regular & x, regular & y, regular & x & y]) {
            let mut left = boxes;
            while left != 0 {
                let at = left.trailing_zeros() as usize;
                left &= left - 1;
                let [along, x, y] = by_axis!(word => batch.words[word][at]);
                let across = [
                    if copy & 1 == 0 { x } else { from_next(x, WIDTH) },
                    if copy & 2 == 0 { y } else { from_next(y, WIDTH) },
                ];
                let columns = [0, 1].map(|axis| batch.first[axis][at] + (copy >> axis & 1));
                push(frame.place(0, columns), Record::new(along, across, first + at as u32));
            }
        }
        self.counts[0] += boxes.len() as u32;
        if regular != all {
            let special = (first..).zip(boxes).zip(&batch.lacks).filter(|&(_, &lacks)| lacks & SPECIAL != 0);
            special.for_each(|((key, bounds), _)| self.push_special(frame, bounds, key));
        }
    }

    /// Makes room for this number of copies, even if each goes to a different column.
    #[inline(always)]
    fn reserve(&mut self, copies: usize) {
        if self.links.len() < self.used + copies {
            self.links.resize((2 * self.links.len()).max(self.used + copies), NONE);
            self.records.resize(self.links.len() * BLOCK, Record::default());
        }
    }

    /// Adds a box that is too large for the finest level, or outside its columns.
    #[cold]
    fn push_special(&mut self, frame: &Frame, bounds: &MinMax, key: u32) {
        let image = frame.image(bounds);
        let level = Frame::level(&image);
        let [first, last] = frame.reach(&image, level);
        let is_within = frame.is_within(level, [first, last]);
        self.reserve(MAX_COPIES);
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                let place = frame.place(level, [column, row]);
                let record = frame.record(&image, level, [column, row], key);
                push(&mut self.records, &mut self.links, &mut self.next, &mut self.used, place, record);
                self.shared[place as usize] |= !is_within;
            }
        }
        self.counts[level] += u32::from(level > 0);
    }

    /// Returns the number of boxes in a level; for the finest level, the number of all boxes.
    pub(super) fn count(&self, level: usize) -> u32 {
        self.counts[level]
    }

    /// Reports whether a place may hold copies of several columns.
    pub(super) fn is_shared(&self, place: usize) -> bool {
        self.shared[place]
    }

    /// Returns the copies in a place, one block at a time.
    pub(super) fn blocks(&self, place: usize) -> impl Iterator<Item = &[Record]> {
        let mut end = self.next[place] as usize;
        std::iter::from_fn(move || {
            let block = end.checked_sub(1)? / BLOCK;
            let copies = &self.records[block * BLOCK..end];
            end = if self.links[block] == NONE { 0 } else { (self.links[block] as usize + 1) * BLOCK };
            Some(copies)
        })
    }
}

/// Appends a copy to its column. Takes a new block if the column is empty or its last block is
/// full.
#[inline(always)]
fn push(records: &mut [Record], links: &mut [u32], next: &mut [u32], used: &mut usize, place: u32, record: Record) {
    let next = &mut next[place as usize];
    if next.is_multiple_of(BLOCK as u32) {
        links[*used] = if *next == 0 { NONE } else { *next / BLOCK as u32 - 1 };
        *next = (*used * BLOCK) as u32;
        *used += 1;
    }
    records[*next as usize] = record;
    *next += 1;
}

/// A batch of boxes on their way to columns of the finest level, one array per coordinate.
#[derive(Clone, Debug)]
struct Batch {
    min: [[f32; BATCH]; 3],
    max: [[f32; BATCH]; 3],
    first: [[i32; BATCH]; 2],
    /// Place of the first column in memory.
    place: [u32; BATCH],
    /// Bits of each box: one per axis, set if the box does not reach into the next column, and
    /// [`SPECIAL`] if the box has no copies in the finest level.
    lacks: [u32; BATCH],
    /// Intervals of each box along the column and across, as a record stores them.
    words: [[u32; BATCH]; 3],
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            min: [[0.0; BATCH]; 3],
            max: [[0.0; BATCH]; 3],
            first: [[0; BATCH]; 2],
            place: [0; BATCH],
            lacks: [0; BATCH],
            words: [[0; BATCH]; 3],
        }
    }
}

impl Batch {
    /// Returns the boxes whose `lacks` does not contain the bit `lacked`, one bit per box.
    #[inline(always)]
    fn with<S: Simd>(&self, simd: S, lacked: u32) -> u64 {
        let lacked = u32x16::splat(simd, lacked);
        let mut bits = 0;
        for at in 0..BATCH / 16 {
            let lacks = u32x16::from_slice(simd, &self.lacks[16 * at..16 * at + 16]);
            bits |= (lacks & lacked).simd_eq(u32x16::splat(simd, 0)).to_bitmask() << (16 * at);
        }
        bits
    }

    #[inline(always)]
    fn image(&mut self, frame: &Frame, boxes: &[MinMax]) {
        for (at, bounds) in boxes.iter().enumerate().take(BATCH) {
            let (min, max) = (bounds.min(), bounds.max());
            for axis in 0..3 {
                self.min[axis][at] = frame.coordinate(axis, min[axis]);
                self.max[axis][at] = frame.coordinate(axis, max[axis]);
            }
        }
    }

    #[inline(always)]
    fn place(&mut self, frame: &Frame) {
        let [x, y] = frame.across;
        let (min, max) = ([&self.min[x % 3], &self.min[y % 3]], [&self.max[x % 3], &self.max[y % 3]]);
        let along = (&self.min[frame.along % 3], &self.max[frame.along % 3]);
        for at in 0..BATCH {
            let first = [nearest(min[0][at]), nearest(min[1][at])];
            let last = [nearest(max[0][at]), nearest(max[1][at])];
            let is_small = (max[0][at] - min[0][at] <= MAX_EXTENT)
                & (max[1][at] - min[1][at] <= MAX_EXTENT)
                & (along.1[at] - along.0[at] <= MAX_EXTENT);
            let is_special = !(is_small & frame.is_within(0, [first, last]));
            self.lacks[at] = u32::from(last[0] == first[0])
                | u32::from(last[1] == first[1]) << 1
                | if is_special { SPECIAL } else { 0 };
            self.first[0][at] = first[0];
            self.first[1][at] = first[1];
            self.place[at] = frame.place(0, first);
        }
    }

    /// Computes the same steps as [`Frame::record`]: differences to column numbers of zero or more
    /// are exact in single precision.
    #[inline(always)]
    fn take_steps(&mut self, frame: &Frame) {
        let along = (&self.min[frame.along % 3], &self.max[frame.along % 3]);
        for at in 0..BATCH {
            self.words[0][at] = interval(frame.step(along.0[at]), frame.step(along.1[at]));
        }
        for axis in 0..2 {
            let (min, max) = (&self.min[frame.across[axis] % 3], &self.max[frame.across[axis] % 3]);
            for at in 0..BATCH {
                let column = self.first[axis][at] as f32;
                let step = |x: f32| (nearest((x - column) * WIDTH as f32) + WIDTH as i32) as u32;
                self.words[1 + axis][at] = interval(step(min[at]), step(max[at]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    /// Returns boxes whose corners often lie on boundaries of steps and columns. Some are too large
    /// for a column.
    fn boxes(rng: &mut Rng, far: f64) -> Vec<MinMax> {
        let unit = 1.0 / 1024.0;
        (0..8_000)
            .map(|_| {
                let min = [0; 3].map(|_: i32| far + rng.integer(-20_000, 20_000) as f64 * unit);
                let most = if rng.integer(0, 30) == 0 { 20_000 } else { 1_000 };
                let max = min.map(|x| x + rng.integer(0, most) as f64 * unit);
                MinMax::from_ordered(min, max)
            })
            .collect()
    }

    #[test]
    fn copies_made_in_batches_equal_copies_made_one_box_at_a_time() {
        let (mut rng, mut columns) = (Rng::new(71), Columns::default());
        let (mut second, mut large) = (0, 0);
        for far in [0.0, 1e6, -3.0] {
            let boxes = boxes(&mut rng, far);
            let frame = Frame::of(&boxes).expect("there are boxes");
            columns.fill(&frame, &boxes, 0);
            let mut found: Vec<(usize, u32, String)> = Vec::new();
            for place in 0..frame.len() {
                let copies = columns.blocks(place).flatten();
                found.extend(copies.map(|record| (place, record.key, format!("{record:?}"))));
            }
            let mut expected = Vec::new();
            for (bounds, key) in boxes.iter().zip(0..) {
                let image = frame.image(bounds);
                let level = Frame::level(&image);
                let [first, last] = frame.reach(&image, level);
                large += usize::from(level > 0);
                for row in first[1]..=last[1] {
                    for column in first[0]..=last[0] {
                        let record = frame.record(&image, level, [column, row], key);
                        second += usize::from(record.second() != 0);
                        expected.push((frame.place(level, [column, row]) as usize, key, format!("{record:?}")));
                    }
                }
            }
            found.sort();
            expected.sort();
            assert_eq!(found, expected, "boxes at {far}");
        }
        assert!(second > 1_000 && large > 100, "{second} second copies, {large} large boxes");
    }
}
