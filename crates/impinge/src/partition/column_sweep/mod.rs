//! All pairs of boxes that all move: sorted into columns and swept along them, from nothing, each time.
//!
//! Source: Tracy, Buss, Woods, *Efficient large-scale sweep and prune methods with AABB insertion and removal*, IEEE VR 2009
//! (a grid of sweeps); Ericson, 7.2 (levels for sizes). Ours departs in that nothing is kept from step to step, in columns
//! that cross space so that a sweep replaces one axis of the grid, in eight boxes a comparison, and in coordinates that are
//! rounded *monotonically*: if a coordinate is not greater than another, neither are their images. Images that are apart
//! thus prove boxes apart, images that overlap by more than a touch prove that they meet, and only for a touch are the
//! boxes themselves asked.

mod columns;
mod frame;
mod lanes;
mod order;
mod slots;

use std::ops::Range;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use crate::simd::best_level;
use crate::volume::{BoundingVolume, MinMax};
use columns::Columns;
use frame::{Frame, LARGEST, LEVELS, Record};
use lanes::Lanes;
use order::sort_pairs;

/// Finds all pairs of boxes that meet, without memory of earlier places: the quickest way where most boxes move.
///
/// Boxes about as large as each other share one level of columns, with copies in each column that they reach into; larger
/// ones have levels of their own, up to one for those that are larger than the scene. It holds no boxes and so answers no
/// questions but this; what it keeps is memory to work in.
///
/// # Complexity
/// O(n) and a sweep of each column: boxes that are spread are compared with about eight others each, and sizes over any
/// ratio add a comparison for each level of fourfold size. Boxes that are long and thin, many side by side in one column,
/// are compared with each other: then a [`BoxTree`](super::BoxTree) is the better kind.
///
/// ```
/// use impinge::partition::ColumnSweep;
/// use impinge::volume::MinMax;
///
/// let boxes = [0.0, 0.5, 9.0].map(|x| MinMax::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]).unwrap());
/// let mut pairs = Vec::new();
/// ColumnSweep::new().find(&boxes, &mut pairs);
/// assert_eq!(pairs, [[0, 1]]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct ColumnSweep {
    /// Of each run of boxes, for a thread.
    runs: Vec<Columns>,
    /// Of each level but the finest.
    coarse: Vec<Coarse>,
    /// Pairs before they are sorted.
    found: Vec<[u32; 2]>,
    lanes: Lanes,
}

/// The columns of a level one after the other.
#[derive(Clone, Debug, Default)]
struct Coarse {
    records: Vec<Record>,
    /// Where each column starts, and the last one ends.
    starts: Vec<u32>,
}

/// Boxes that a thread sorts into columns at least.
const SHORTEST_RUN: usize = 1 << 14;

/// Columns of a task: enough to be worth a thread's while.
const TASK: usize = 16;

impl ColumnSweep {
    /// One that has no memory yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts the pairs of places in `boxes` whose boxes meet in `pairs`, in place of what is there: sorted, each once, the
    /// lesser first. Exact, and the same for any number of threads, on as many as the caller's `rayon` pool has.
    pub fn find(&mut self, boxes: &[MinMax], pairs: &mut Vec<[u32; 2]>) {
        self.found.clear();
        if let Some(frame) = Frame::of(boxes) {
            self.deal(&frame, boxes);
            self.gather_coarse(&frame);
            self.sweep(&frame, boxes);
        }
        sort_pairs(&mut self.found, pairs, boxes.len());
    }

    fn deal(&mut self, frame: &Frame, boxes: &[MinMax]) {
        let run = boxes.len().div_ceil(rayon::current_num_threads()).max(SHORTEST_RUN);
        self.runs.resize_with(boxes.len().div_ceil(run), Columns::default);
        if let [columns] = self.runs.as_mut_slice() {
            // A pool that is not needed is not woken either, which would take longer than a thousand boxes.
            return columns.fill(frame, boxes, 0);
        }
        self.runs.par_iter_mut().zip(boxes.par_chunks(run)).enumerate().for_each(|(at, (columns, boxes))| {
            columns.fill(frame, boxes, (at * run) as u32);
        });
    }

    /// Puts the columns of all levels but the finest together, for finer ones to be compared with.
    fn gather_coarse(&mut self, frame: &Frame) {
        self.coarse.resize_with(LEVELS - 1, Coarse::default);
        for (level, coarse) in (1..).zip(&mut self.coarse) {
            coarse.records.clear();
            coarse.starts.clear();
            if self.runs.iter().all(|run| run.count(level) == 0) {
                continue;
            }
            coarse.starts.push(0);
            for column in frame.columns(level) {
                let blocks = self.runs.iter().flat_map(|run| run.blocks(column));
                blocks.for_each(|block| coarse.records.extend_from_slice(block));
                coarse.starts.push(coarse.records.len() as u32);
            }
        }
    }

    fn sweep(&mut self, frame: &Frame, boxes: &[MinMax]) {
        let (runs, coarse) = (&self.runs, &self.coarse);
        let sweep = |(mut lanes, mut found): (Lanes, Vec<[u32; 2]>), (level, columns): (usize, Range<usize>)| {
            for column in columns {
                let blocks = runs.iter().flat_map(|run| run.blocks(column));
                let mut bucket = Bucket { frame, boxes, level, lanes: &mut lanes };
                bucket.find(blocks, &coarse[level..], &mut found);
            }
            (lanes, found)
        };
        let used = (0..LEVELS).filter(|&level| level == 0 || !coarse[level - 1].records.is_empty());
        let tasks = used.flat_map(|level| {
            let columns = frame.columns(level);
            columns.clone().step_by(TASK).map(move |first| (level, first..columns.end.min(first + TASK)))
        });
        if runs.len() == 1 {
            let start = (std::mem::take(&mut self.lanes), std::mem::take(&mut self.found));
            (self.lanes, self.found) = tasks.fold(start, sweep);
            return;
        }
        let parts: Vec<_> =
            tasks.collect::<Vec<_>>().into_par_iter().fold(Default::default, sweep).map(|(_, found)| found).collect();
        parts.iter().for_each(|part| self.found.extend_from_slice(part));
    }
}

/// A column at work.
struct Bucket<'a> {
    frame: &'a Frame,
    boxes: &'a [MinMax],
    level: usize,
    lanes: &'a mut Lanes,
}

impl Bucket<'_> {
    /// Finds the pairs among these copies, and of them with those of coarser levels.
    fn find<'r>(&mut self, blocks: impl Iterator<Item = &'r [Record]>, coarser: &[Coarse], found: &mut Vec<[u32; 2]>) {
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            self.lanes.fill(self.frame.along, blocks);
            let boxes = self.boxes;
            self.lanes.sweep_self(simd, #[inline(always)] |one, other| {
                if one.tag.is_owner(other.tag) {
                    meet(one, other, boxes, found);
                }
            });
        }));
        if !self.lanes.records().is_empty() && coarser.iter().any(|coarse| !coarse.records.is_empty()) {
            self.find_coarser(coarser, found);
        }
    }

    /// A coarse copy that comes near these is swept against them: there are few.
    fn find_coarser(&mut self, coarser: &[Coarse], found: &mut Vec<[u32; 2]>) {
        let mut columns: Vec<[i32; 2]> = Vec::new();
        let [mut low, mut high] = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for record in self.lanes.records() {
            for axis in 0..3 {
                low[axis] = low[axis].min(record.min[axis]);
                high[axis] = high[axis].max(record.max[axis]);
            }
            let column = self.frame.own_column(record, self.level);
            if columns.last() != Some(&column) {
                columns.push(column);
            }
        }
        // A little more than the sizes of a level, for the rounding of differences.
        let longest =
            if self.level == LEVELS - 1 { f32::INFINITY } else { LARGEST * 1.001 * (1_u32 << (2 * self.level)) as f32 };
        for (coarser_level, coarse) in (self.level + 1..).zip(coarser).filter(|(_, coarse)| !coarse.records.is_empty())
        {
            let bucket = |&column: &[i32; 2]| self.frame.coarse_bucket(column, self.level, coarser_level);
            let mut buckets: Vec<usize> = columns.iter().map(bucket).collect();
            buckets.sort_unstable();
            buckets.dedup();
            for bucket in buckets {
                for other in &coarse.records[coarse.starts[bucket] as usize..coarse.starts[bucket + 1] as usize] {
                    if !(0..3).all(|axis| (other.min[axis] <= high[axis]) & (low[axis] <= other.max[axis])) {
                        continue;
                    }
                    dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
                        self.lanes.sweep_one(simd, self.frame.along, other, longest, #[inline(always)] |one| {
                            if self.frame.is_owner(one, self.level, other, coarser_level) {
                                meet(one, other, self.boxes, found);
                            }
                        });
                    }));
                }
            }
        }
    }
}

/// Reports a pair whose images meet, if the boxes themselves do.
#[inline(always)]
fn meet(one: &Record, other: &Record, boxes: &[MinMax], found: &mut Vec<[u32; 2]>) {
    let certain = (0..3)
        .fold(true, |certain, axis| certain & (one.min[axis] < other.max[axis]) & (other.min[axis] < one.max[axis]));
    if certain || boxes[one.key as usize].overlaps(&boxes[other.key as usize]) {
        found.push([one.key.min(other.key), one.key.max(other.key)]);
    }
}
