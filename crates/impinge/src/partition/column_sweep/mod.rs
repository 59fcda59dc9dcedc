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

use std::ops::Range;

use fearless_simd::dispatch;
use rayon::prelude::*;

use crate::simd::best_level;
use crate::volume::{BoundingVolume, MinMax};
use columns::Columns;
use frame::{Frame, LEVELS, Record};
use lanes::{Coarse, Lanes, Sorter};

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
    coarse: Vec<Coarse>,
    /// Pairs before they are sorted.
    found: Vec<[u32; 2]>,
    sorter: Sorter,
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
            self.sort_into_columns(&frame, boxes);
            self.sort_coarse(&frame);
            self.sweep_columns(&frame, boxes);
        }
        sort_pairs(&mut self.found, pairs, boxes.len());
    }

    fn sort_into_columns(&mut self, frame: &Frame, boxes: &[MinMax]) {
        let run = boxes.len().div_ceil(rayon::current_num_threads()).max(SHORTEST_RUN);
        self.runs.resize_with(boxes.len().div_ceil(run), Columns::default);
        self.runs.par_iter_mut().zip(boxes.par_chunks(run)).enumerate().for_each(|(at, (columns, boxes))| {
            columns.fill(frame, boxes, (at * run) as u32);
        });
    }

    /// Sorts the columns of all levels but the finest, against which finer ones are swept.
    fn sort_coarse(&mut self, frame: &Frame) {
        self.coarse.resize_with(LEVELS - 1, Coarse::default);
        for level in 1..LEVELS {
            let coarse = &mut self.coarse[level - 1];
            coarse.clear();
            for column in frame.columns(level) {
                self.sorter.gather(self.runs.iter().flat_map(|run| run.blocks(column)));
                coarse.push(&mut self.sorter);
            }
            coarse.lanes.pad();
        }
    }

    fn sweep_columns(&mut self, frame: &Frame, boxes: &[MinMax]) {
        let (runs, coarse) = (&self.runs, &self.coarse);
        let sweep = |(mut sorter, mut lanes, mut found): (Sorter, Lanes, Vec<[u32; 2]>), columns: Range<usize>| {
            for column in columns {
                sorter.gather(runs.iter().flat_map(|run| run.blocks(column)));
                lanes.clear();
                sorter.sort_onto(&mut lanes);
                lanes.pad();
                let bucket = Bucket { frame, boxes, level: 0, lanes: &lanes, range: 0..sorter.len() };
                bucket.sweep(coarse, &mut found);
            }
            (sorter, lanes, found)
        };
        let fine = frame.columns(0).len();
        let tasks = (0..fine.div_ceil(TASK)).map(|task| task * TASK..fine.min((task + 1) * TASK));
        if runs.len() == 1 {
            let start = (std::mem::take(&mut self.sorter), Lanes::default(), std::mem::take(&mut self.found));
            (self.sorter, _, self.found) = tasks.fold(start, sweep);
        } else {
            let parts: Vec<_> = tasks
                .collect::<Vec<_>>()
                .into_par_iter()
                .fold(Default::default, sweep)
                .map(|(_, _, found)| found)
                .collect();
            parts.iter().for_each(|part| self.found.extend_from_slice(part));
        }
        for level in 1..LEVELS {
            let own = &coarse[level - 1];
            let found: Vec<Vec<[u32; 2]>> = own
                .starts
                .par_windows(2)
                .filter(|ends| ends[0] < ends[1])
                .fold(Vec::new, |mut found, ends| {
                    let range = ends[0] as usize..ends[1] as usize;
                    Bucket { frame, boxes, level, lanes: &own.lanes, range }.sweep(&coarse[level..], &mut found);
                    found
                })
                .collect();
            found.iter().for_each(|part| self.found.extend_from_slice(part));
        }
    }
}

/// The sorted boxes of columns that share memory.
struct Bucket<'a> {
    frame: &'a Frame,
    boxes: &'a [MinMax],
    level: usize,
    lanes: &'a Lanes,
    range: Range<usize>,
}

impl Bucket<'_> {
    /// Finds the pairs among these boxes, and of them with those of coarser levels.
    fn sweep(&self, coarser: &[Coarse], found: &mut Vec<[u32; 2]>) {
        if self.range.is_empty() {
            return;
        }
        dispatch!(best_level(), simd => {
            self.lanes.sweep_self(simd, self.range.clone(), #[inline(always)] |one, other| self.meet(one, self.lanes.record(other), 0, found));
        });
        for (above, coarse) in coarser.iter().enumerate().filter(|(_, coarse)| !coarse.is_empty()) {
            self.sweep_against(coarse, above + 1, found);
        }
    }

    fn sweep_against(&self, coarse: &Coarse, above: usize, found: &mut Vec<[u32; 2]>) {
        let level = self.level + above;
        let mut last = (usize::MAX, 0);
        for at in self.range.clone() {
            let one = self.lanes.record(at);
            let bucket = self.frame.coarse_bucket(&one, self.level, level);
            let range = coarse.range(bucket);
            if range.is_empty() {
                continue;
            }
            let from = one.min[0] - coarse.widest;
            let mut cursor =
                if last.0 == bucket { last.1 } else { range.start + coarse.first_from(range.clone(), from) };
            while cursor < range.end && coarse.lanes.begin(cursor) < from {
                cursor += 1;
            }
            last = (bucket, cursor);
            dispatch!(best_level(), simd => {
                coarse.lanes.sweep_one(simd, cursor..range.end, &one, #[inline(always)] |other| self.meet(at, coarse.lanes.record(other), above, found));
            });
        }
    }

    /// Reports a pair whose images meet, once: in the column of the finer one that holds the least corner of what they share,
    /// and if the boxes themselves meet.
    #[inline]
    fn meet(&self, one: usize, other: Record, above: usize, found: &mut Vec<[u32; 2]>) {
        let one = self.lanes.record(one);
        if !self.frame.is_owner(&one, &other, self.level, above) {
            return;
        }
        let certain = (0..3).all(|axis| one.min[axis] < other.max[axis] && other.min[axis] < one.max[axis]);
        if certain || self.boxes[one.key as usize].overlaps(&self.boxes[other.key as usize]) {
            found.push([one.key.min(other.key), one.key.max(other.key)]);
        }
    }
}

/// Pairs that are sorted as they are; more are dealt out first.
const FEW: usize = 1 << 11;

/// Deals of pairs by their first number.
const DEALS: usize = 1 << 12;

/// Sorts pairs of numbers below `len` from one list into another.
fn sort_pairs(from: &mut [[u32; 2]], to: &mut Vec<[u32; 2]>, len: usize) {
    to.clear();
    if from.len() <= FEW {
        from.sort_unstable();
        to.extend_from_slice(from);
        return;
    }
    let shift = len.next_power_of_two().ilog2().saturating_sub(DEALS.ilog2());
    let deal = |pair: [u32; 2]| (pair[0] >> shift) as usize;
    to.resize(from.len(), [0; 2]);
    crate::hierarchy::scatter::<DEALS, [u32; 2]>(from, to, deal);
    let mut rest = to.as_mut_slice();
    let mut deals = Vec::new();
    while let Some(&first) = rest.first() {
        // A deal ends where the next begins; few are long.
        let end = rest.iter().position(|&pair| deal(pair) != deal(first)).unwrap_or(rest.len());
        let (own, after) = rest.split_at_mut(end);
        deals.push(own);
        rest = after;
    }
    deals
        .into_par_iter()
        .with_min_len(64)
        .for_each(|deal| deal.sort_unstable_by_key(|pair| u64::from(pair[0]) << 32 | u64::from(pair[1])));
}
