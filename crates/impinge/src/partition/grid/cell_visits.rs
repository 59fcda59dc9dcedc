//! The cells of one level that a batch of moving boxes visits.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x4};

use super::super::{Changes, Items};
use super::frame::{Block, Frame};
use super::layout::Along;
use super::level::Level;
use super::lines::LINE_CAPACITY;
use super::move_batch::{BATCH, MoveBatch};
use super::quantization::PART_BITS;
use super::quantized_move::QuantizedMove;
use crate::simd::{best_level, by_axis, dispatch, prefetch};
use crate::volume::MinMax;

/// Maximum number of cells around a path that is processed in a batch. For longer paths, batching
/// costs more than it saves.
pub(super) const MAX_PATH_CELLS: usize = 27;

/// Maximum number of cells around such a path along each axis.
const MAX_PATH_WIDTH: usize = 4;

/// The cells of one level that the boxes of a batch visit, in the order of the moves. The memory is
/// reused for each batch.
#[derive(Clone, Debug)]
pub(super) struct CellVisits {
    /// Visits; the first `count` are valid.
    visits: Vec<CellVisit>,
    count: usize,
    paths: Paths,
    candidates: Vec<Undecided>,
}

/// A cell that a box visits as it moves.
#[derive(Clone, Copy, Debug, Default)]
struct CellVisit {
    seen: QuantizedMove,
    place: u32,
    mover: u8,
    /// Number of the cell among the cells around the path: two bits per axis, counted from the
    /// first cell.
    number: u8,
}

/// Paths of the boxes of a batch among the cells, one lane per box.
#[derive(Clone, Debug, Default)]
struct Paths {
    /// First cell around each path, along each axis.
    low: [[i64; BATCH]; 3],
    /// Beginning and end of each box before the move and after it, in parts of a cell, counted from
    /// the first cell around the path.
    parts: [[[i16; BATCH]; 4]; 3],
    /// Cells around each path, one bit per cell number.
    cells: [u64; BATCH],
    /// For each path: `true` if it has more than two cells along an axis.
    is_wide: [bool; BATCH],
    /// For each box: `true` if it has copies in this level.
    is_here: [bool; BATCH],
    /// For each box: `true` if it stays in its cells.
    stays: [bool; BATCH],
}

/// A pair of boxes whose steps do not decide whether an overlap begins or ends.
#[derive(Clone, Copy, Debug)]
struct Undecided {
    key: u32,
    mover: u8,
    number: u8,
}

impl Default for CellVisits {
    fn default() -> Self {
        // One more than the maximum, because a visit is written before it is known whether it is
        // kept.
        Self {
            visits: vec![CellVisit::default(); BATCH * MAX_PATH_CELLS + 1],
            count: 0,
            paths: Paths::default(),
            candidates: Vec::new(),
        }
    }
}

impl CellVisits {
    /// Records a path among the cells of a level. Returns `false` if there are too many cells
    /// around it. `is_here` is `true` if the box has copies in this level; otherwise the box only
    /// looks for others here.
    #[inline(always)]
    pub(super) fn note_path(&mut self, level: &Level, mover: usize, [from, to]: &[MinMax; 2], is_here: bool) -> bool {
        let [before, after] = [level.frame.reach(from), level.frame.reach(to)];
        let low = by_axis!(axis => before.low[axis].min(after.low[axis]).cell());
        let counts = by_axis!(axis => before.high[axis].max(after.high[axis]).cell() - low[axis] + 1);
        let most = counts[0].max(counts[1]).max(counts[2]);
        if most > MAX_PATH_WIDTH as i64 || counts[0] * counts[1] * counts[2] > MAX_PATH_CELLS as i64 {
            return false;
        }
        let paths = &mut self.paths;
        let mut changed = 0;
        for axis in 0..3 {
            let ends = [before.low[axis], before.high[axis], after.low[axis], after.high[axis]];
            paths.low[axis][mover] = low[axis];
            let mut parts = [0; 4];
            for end in 0..4 {
                parts[end] = ends[end].parts_from(low[axis]) as i16;
                paths.parts[axis][end][mover] = parts[end];
            }
            changed |= (parts[0] ^ parts[2]) | (parts[1] ^ parts[3]);
        }
        paths.cells[mover] = cells_of(counts);
        paths.is_wide[mover] = most > 2;
        (paths.is_here[mover], paths.stays[mover]) = (is_here, changed >> PART_BITS == 0);
        true
    }

    /// Computes the visits from the recorded paths.
    #[inline(always)]
    fn spread<const WIDE: usize, S: Simd>(&mut self, simd: S, level: &Level, movers: usize) {
        let paths = &self.paths;
        let mut slices = [[[QuantizedMove::default(); BATCH]; WIDE]; 3];
        for axis in 0..3 {
            for nth in 0..WIDE {
                slices[axis][nth] = QuantizedMove::along(simd, axis, &paths.parts[axis], &paths.low[axis], nth);
            }
        }
        let mut count = 0;
        let visits = &mut self.visits[..];
        for mover in 0..movers {
            let mut along = [[Along::default(); WIDE]; 3];
            for axis in 0..3 {
                for nth in 0..WIDE {
                    along[axis][nth] = level.layout.along(axis, paths.low[axis][mover] + nth as i64);
                }
            }
            // Always written, and kept if the cell exists: a branch would be hard to predict.
            for z in 0..WIDE {
                for y in 0..WIDE {
                    let row = slices[1][y][mover].lanes(simd) | slices[2][z][mover].lanes(simd);
                    for x in 0..WIDE {
                        let place = level.layout.place([along[0][x], along[1][y], along[2][z]]) as u32;
                        let number = x | y << 2 | z << 4;
                        let visit = &mut visits[count];
                        visit.seen = QuantizedMove::all(simd, slices[0][x][mover].lanes(simd) | row);
                        (visit.place, visit.mover, visit.number) = (place, mover as u8, number as u8);
                        count += (paths.cells[mover] >> number & 1) as usize;
                    }
                }
            }
        }
        self.count = count;
    }

    /// Moves the boxes of one level of cells and records which overlaps with other boxes of that
    /// level begin and end.
    ///
    /// This is the only function of the grids that is compiled for each vector unit. Both kinds of
    /// grid share it.
    pub(super) fn apply(&mut self, level: &mut Level, items: &Items, batch: &MoveBatch, changes: &mut Changes) {
        dispatch!(best_level(), simd => self.apply_lanes(simd, level, items, batch, changes));
    }

    #[inline(always)]
    fn apply_lanes<S: Simd>(
        &mut self,
        simd: S,
        level: &mut Level,
        items: &Items,
        batch: &MoveBatch,
        changes: &mut Changes,
    ) {
        let number = batch.iter().len();
        if self.paths.is_wide[..number].contains(&true) {
            self.spread::<MAX_PATH_WIDTH, S>(simd, level, number);
        } else {
            self.spread::<2, S>(simd, level, number);
        }
        let visits = &self.visits[..self.count];
        // All prefetches come together, so that the processor translates many addresses at once.
        let first = level.lines.first();
        for visit in visits {
            prefetch(&first[visit.place as usize]);
        }
        for visit in visits {
            if let Some(more) = level.lines.after(&first[visit.place as usize]) {
                prefetch(more);
            }
        }
        self.candidates.clear();
        let mut lines = level.lines.open();
        for visit in visits {
            let mover = usize::from(visit.mover);
            let (stays, key) = (self.paths.stays[mover], batch.of(mover).0);
            let mut line = lines.first(visit.place as usize);
            loop {
                let mut own = places_of(simd, key, &line.keys);
                let mut undecided = visit.seen.compare(simd, &line.boxes) & !own;
                while stays && own != 0 {
                    let quantized = &mut line.boxes[own.trailing_zeros() as usize];
                    own &= own - 1;
                    if quantized.has_cell_key_of(visit.seen.after()) {
                        *quantized = visit.seen.after();
                    }
                }
                while undecided != 0 {
                    let key = line.keys[undecided.trailing_zeros() as usize];
                    undecided &= undecided - 1;
                    self.candidates.push(Undecided { key, mover: visit.mover, number: visit.number });
                }
                let next = line.next;
                match lines.more(next) {
                    Some(more) => line = more,
                    None => break,
                }
            }
            if self.paths.is_here[mover] && !stays {
                let (place, after) = (visit.place as usize, visit.seen.after());
                match self.paths.holds(mover, visit.number) {
                    [true, true] => lines.write(place, key, after),
                    [true, false] => lines.take(place, key, after),
                    [false, true] => lines.put(place, key, after),
                    [false, false] => {}
                }
            }
        }
        for candidate in &self.candidates {
            items.prefetch(candidate.key);
        }
        for candidate in &self.candidates {
            let mover = usize::from(candidate.mover);
            let (key, [from, to]) = batch.of(mover);
            let Some(bounds) = batch.at_turn(items, mover, candidate.key) else { continue };
            let (overlapped, overlaps) = (overlap(from, bounds), overlap(to, bounds));
            if overlapped != overlaps && self.paths.is_first(mover, candidate.number, &level.frame, bounds) {
                changes.note(key, candidate.key, overlaps);
            }
        }
    }
}

/// Returns one bit for each position of a key in a line. Positions of removed copies may be among
/// them.
#[inline(always)]
fn places_of<S: Simd>(simd: S, key: u32, keys: &[u32; LINE_CAPACITY]) -> u32 {
    let [first @ .., last] = keys;
    let are_first = u32x4::from_slice(simd, first).simd_eq(u32x4::splat(simd, key)).to_bitmask() as u32;
    are_first | u32::from(*last == key) << (LINE_CAPACITY - 1)
}

impl Paths {
    /// Reports whether a box has a copy in a cell before the move and after it.
    #[inline(always)]
    fn holds(&self, mover: usize, number: u8) -> [bool; 2] {
        let cell = from_first(number);
        let mut holds = [true; 2];
        for axis in 0..3 {
            let at = i16::from(cell[axis]);
            for (time, holds) in holds.iter_mut().enumerate() {
                let [first, last] = [2 * time, 2 * time + 1].map(|end| self.parts[axis][end][mover] >> PART_BITS);
                *holds &= (first <= at) & (at <= last);
            }
        }
        holds
    }

    /// Reports whether a cell contains the minimum corner of the intersection of a box and the
    /// block of cells around a path.
    fn is_first(&self, mover: usize, number: u8, frame: &Frame, bounds: &MinMax) -> bool {
        let (low, cell) = ([0, 1, 2].map(|axis| self.low[axis][mover]), from_first(number));
        frame.is_first([0, 1, 2].map(|axis| low[axis] + i64::from(cell[axis])), &Block { low, high: low }, bounds)
    }
}

/// Returns the bits of the cells of a block, given the number of cells along each axis, at most
/// four.
#[inline(always)]
fn cells_of(counts: [i64; 3]) -> u64 {
    let [x, y, z] = by_axis!(axis => u64::MAX >> (64 - (counts[axis] << (2 * axis))));
    // Repeats the pattern of x along y and z, and that of y along z.
    (x * 0x1111_1111_1111_1111) & (y * 0x0001_0001_0001_0001) & z
}

/// Returns the position of a cell along each axis, counted from the first cell around the path.
fn from_first(number: u8) -> [u8; 3] {
    [number & 3, number >> 2 & 3, number >> 4]
}

/// Like [`BoundingVolume::overlaps`](crate::volume::BoundingVolume::overlaps), but without a
/// branch, because the result is hard to predict.
#[inline]
fn overlap(one: &MinMax, other: &MinMax) -> bool {
    let (min, max, other_min, other_max) = (one.min(), one.max(), other.min(), other.max());
    (0..3).fold(true, |overlap, axis| overlap & (min[axis] <= other_max[axis]) & (other_min[axis] <= max[axis]))
}
