//! Finds all pairs of boxes if most boxes move: it sorts the boxes into columns and sweeps along
//! them, from scratch on every call.
//!
//! Source: Tracy, Buss, Woods, *Efficient large-scale sweep and prune methods with AABB insertion
//! and removal*, IEEE VR 2009 (a grid of sweeps); Ericson, 7.2 (levels for sizes). Ours departs in
//! four ways:
//! - Nothing is kept from step to step.
//! - Columns cross the whole space, so that a sweep replaces one axis of the grid.
//! - Sixteen boxes are compared at a time.
//! - Coordinates are rounded *monotonically* to whole steps of 15 bits: if a coordinate is not
//!   greater than another, neither is its step. Steps that are apart therefore prove that boxes are
//!   apart. Steps that overlap by more than a touch prove that they overlap. Only if steps touch
//!   are the boxes themselves compared.
//!
//! Guarded by `tests/it/partition/columns.rs`, measured by the benchmark `partitions`.

mod columns;
mod found;
mod frame;
mod lanes;
mod order;
mod record;
mod slots;

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::Simd;
use rayon::prelude::*;

use crate::budget::{Budget, Stopped};
use crate::simd::{best_level, dispatch};
use crate::volume::{BoundingVolume, MinMax};
use columns::Columns;
use found::Found;
use frame::{Frame, Image, LEVELS, MAX_EXTENT, nearest};
use lanes::{Lanes, Span};
use order::sort_pairs;
use record::{Record, Verdict};

/// Finds all pairs of boxes that overlap, without memory of earlier positions. It is the fastest
/// kind if most boxes move.
///
/// Boxes of similar size share one level of columns, with a copy in each column that they reach
/// into. Larger boxes use coarser levels, up to a single column for boxes larger than the scene.
/// This type stores no boxes, so it has no other queries; it only keeps memory to work in.
///
/// # Complexity
/// O(n) and a sweep of each column. Boxes that are spread in space are compared with about ten
/// others each. Sizes of any ratio add one comparison for each level; a level covers a factor of
/// four. Many long thin boxes side by side in one column are all compared with each other: use a
/// [`BoxTree`](super::BoxTree) for them.
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
    /// Columns of each run of consecutive boxes; one thread fills a run.
    runs: Vec<Columns>,
    /// Columns of each level but the finest.
    coarse: Vec<Coarse>,
    sweepers: Vec<Sweeper>,
}

/// Working memory with which a thread sweeps columns.
#[derive(Clone, Debug, Default)]
struct Sweeper {
    lanes: Lanes,
    found: Found,
}

/// The columns of one coarse level, one after the other.
#[derive(Clone, Debug, Default)]
struct Coarse {
    copies: Vec<CoarseCopy>,
    /// Index in `copies` at which each column starts, and the end of the last column.
    starts: Vec<u32>,
}

/// Copy of a box of a coarse level in one of its columns.
#[derive(Clone, Copy, Debug)]
struct CoarseCopy {
    image: Image,
    key: u32,
    column: [i32; 2],
    /// First and last column of the finest level that the box reaches into.
    reach: [[i32; 2]; 2],
}

/// Minimum number of boxes that a thread sorts into columns. With 3,000 boxes and with 10,000
/// boxes, two threads take 0.66 times as long as one thread.
const MIN_RUN: usize = 1 << 11;

/// Number of columns that a thread takes at a time. It is small, so that no thread waits long for
/// another at the end.
const COLUMNS_PER_TASK: usize = 4;

impl ColumnSweep {
    /// Returns a sweep that has no working memory yet; [`find`](Self::find) allocates it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Replaces the contents of `pairs` by the pairs of indices in `boxes` whose boxes overlap:
    /// sorted, without duplicates, the smaller index first.
    ///
    /// Exact. The result does not depend on the number of threads. It runs on the threads of the
    /// caller's `rayon` pool.
    ///
    /// # Panics
    /// Panics if there is not enough memory for the pairs. Their number can be as large as the
    /// square of the number of boxes; [`try_find`](Self::try_find) returns an error instead.
    pub fn find(&mut self, boxes: &[MinMax], pairs: &mut Vec<[u32; 2]>) {
        let found = self.try_find(boxes, pairs, Budget::unlimited());
        assert!(found.is_ok(), "not enough memory for the pairs of {} boxes: use try_find", boxes.len());
    }

    /// Finds the pairs of [`find`](Self::find). Ends early if the budget is spent.
    ///
    /// # Errors
    /// Returns an error if the budget ended the search, or if there is not enough memory for the
    /// pairs. `pairs` is then empty.
    pub fn try_find(
        &mut self,
        boxes: &[MinMax],
        pairs: &mut Vec<[u32; 2]>,
        budget: &Budget<'_>,
    ) -> Result<(), Stopped> {
        pairs.clear();
        let Some(frame) = Frame::of(boxes) else { return Ok(()) };
        self.distribute(&frame, boxes);
        self.gather_coarse(&frame, boxes);
        self.sweep(&frame, boxes, budget);
        for sweeper in &mut self.sweepers {
            if let Some(ended) = sweeper.found.ended.take() {
                self.sweepers.iter_mut().for_each(|sweeper| sweeper.found = Found::default());
                return Err(ended);
            }
        }
        let Some((first, others)) = self.sweepers.split_first_mut() else { return Ok(()) };
        first.found.pairs.try_reserve(others.iter().map(|other| other.found.pairs.len()).sum())?;
        others.iter().for_each(|other| first.found.pairs.extend_from_slice(&other.found.pairs));
        pairs.try_reserve_exact(first.found.pairs.len())?;
        sort_pairs(&mut first.found.pairs, pairs, boxes.len());
        Ok(())
    }

    fn distribute(&mut self, frame: &Frame, boxes: &[MinMax]) {
        let run = boxes.len().div_ceil(rayon::current_num_threads()).max(MIN_RUN);
        self.runs.resize_with(boxes.len().div_ceil(run), Columns::default);
        if let [columns] = self.runs.as_mut_slice() {
            // Waking a pool that is not needed would take longer than processing a thousand boxes.
            return columns.fill(frame, boxes, 0);
        }
        self.runs.par_iter_mut().zip(boxes.par_chunks(run)).enumerate().for_each(|(at, (columns, boxes))| {
            columns.fill(frame, boxes, (at * run) as u32);
        });
    }

    /// Collects the columns of all levels but the finest, to compare finer levels with them.
    fn gather_coarse(&mut self, frame: &Frame, boxes: &[MinMax]) {
        self.coarse.resize_with(LEVELS - 1, Coarse::default);
        for (level, coarse) in (1..).zip(&mut self.coarse) {
            coarse.copies.clear();
            coarse.starts.clear();
            if self.runs.iter().all(|run| run.count(level) == 0) {
                continue;
            }
            coarse.starts.push(0);
            for place in frame.columns(level) {
                let records = self.runs.iter().flat_map(|run| run.blocks(place)).flatten();
                coarse.copies.extend(records.map(|record| {
                    let image = frame.image(&boxes[record.key as usize]);
                    let column = own_column(frame, level, &image, record);
                    let reach = [image.min, image.max].map(|corner| frame.across.map(|axis| nearest(corner[axis])));
                    CoarseCopy { image, key: record.key, column, reach }
                }));
                coarse.starts.push(coarse.copies.len() as u32);
            }
        }
    }

    fn sweep(&mut self, frame: &Frame, boxes: &[MinMax], budget: &Budget<'_>) {
        let (runs, coarse) = (&self.runs, &self.coarse);
        let used = (0..LEVELS).filter(|&level| level == 0 || !coarse[level - 1].copies.is_empty());
        let tasks = used.flat_map(|level| {
            let places = frame.columns(level);
            places
                .clone()
                .step_by(COLUMNS_PER_TASK)
                .map(move |first| (level, first..places.end.min(first + COLUMNS_PER_TASK)))
        });
        let sweep = |Sweeper { lanes, found }: &mut Sweeper, (level, places): (usize, Range<usize>)| {
            for place in places {
                if let Err(stopped) = budget.check() {
                    found.ended = Some(stopped);
                }
                if found.ended.is_some() {
                    return;
                }
                let blocks = runs.iter().flat_map(|run| run.blocks(place));
                let is_shared = runs.iter().any(|run| run.is_shared(place));
                let mut bucket = Bucket { frame, boxes, level, place, is_shared, lanes, budget };
                bucket.find(blocks, &coarse[level..], found);
            }
        };
        self.sweepers.resize_with(runs.len(), Sweeper::default);
        self.sweepers.iter_mut().for_each(|Sweeper { found, .. }| {
            found.pairs.clear();
            found.ended = None;
        });
        if let [sweeper] = self.sweepers.as_mut_slice() {
            return tasks.for_each(|task| sweep(sweeper, task));
        }
        let (tasks, taken) = (tasks.collect::<Vec<_>>(), AtomicUsize::new(0));
        self.sweepers.par_iter_mut().for_each(|sweeper| {
            while let Some(task) = tasks.get(taken.fetch_add(1, Ordering::Relaxed)) {
                sweep(sweeper, task.clone());
            }
        });
    }
}

/// Returns the column of a copy, which the record does not store.
fn own_column(frame: &Frame, level: usize, image: &Image, record: &Record) -> [i32; 2] {
    let [first, _] = frame.reach(image, level);
    [0, 1].map(|axis| first[axis] + (record.second() >> axis & 1) as i32)
}

/// A column that is being swept, or several columns that share its place in memory.
struct Bucket<'a> {
    frame: &'a Frame,
    boxes: &'a [MinMax],
    level: usize,
    place: usize,
    is_shared: bool,
    lanes: &'a mut Lanes,
    budget: &'a Budget<'a>,
}

impl Bucket<'_> {
    /// Finds the pairs among these copies, and the pairs of these copies with copies of coarser
    /// levels.
    fn find<'r>(&mut self, blocks: impl Iterator<Item = &'r [Record]>, coarser: &[Coarse], found: &mut Found) {
        let &mut Self { frame, boxes, level, is_shared, budget, .. } = self;
        let span = |record: &Record| {
            let image = frame.image(&boxes[record.key as usize]);
            [image.min[frame.along], image.max[frame.along]]
        };
        let column = |record: &Record| own_column(frame, level, &frame.image(&boxes[record.key as usize]), record);
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            self.lanes.fill(blocks, span);
            let classify = |one: &Record, other: &Record| {
                // If two columns contain both boxes, the first column reports the pair.
                let is_seen = one.second() & other.second() != 0;
                let Verdict { is_apart, is_certain } = one.verdict(other);
                if is_shared {
                    return Verdict { is_apart: is_seen || column(one) != column(other), is_certain: false };
                }
                Verdict { is_apart: is_seen | is_apart, is_certain }
            };
            let decide = |[one, other]: [u32; 2]| boxes[one as usize].overlaps(&boxes[other as usize]);
            let reserve = |found: &mut Found, count: usize| {
                if let Err(stopped) = budget.check() {
                    found.ended = Some(stopped);
                }
                found.reserve(count, budget)
            };
            self.lanes.sweep_self(simd, found, reserve, classify, decide);
        }));
        if !self.lanes.records().is_empty() && coarser.iter().any(|coarse| !coarse.copies.is_empty()) {
            self.find_coarser(coarser, found);
        }
    }

    /// Sweeps each copy of a coarser level that is near this column against the copies of this
    /// column.
    fn find_coarser(&self, coarser: &[Coarse], found: &mut Found) {
        let &Self { frame, boxes, level, is_shared, budget, .. } = self;
        let column = |record: &Record| own_column(frame, level, &frame.image(&boxes[record.key as usize]), record);
        let mut columns: Vec<[i32; 2]> = Vec::new();
        if is_shared {
            columns.extend(self.lanes.records().iter().map(column));
            columns.sort_unstable();
            columns.dedup();
        } else {
            columns.push(frame.column_at(level, self.place));
        }
        // Slightly more than the maximum extent in this level, to allow for rounded differences.
        let longest = MAX_EXTENT * 1.001 * (1_u32 << (2 * level)) as f32;
        for (coarser_level, coarse) in (level + 1..).zip(coarser).filter(|(_, coarse)| !coarse.copies.is_empty()) {
            let first = frame.columns(coarser_level).start;
            for &own in &columns {
                let about = own.map(|column| Frame::coarsened(column, level, coarser_level));
                let bucket = frame.place(coarser_level, about) as usize - first;
                for other in &coarse.copies[coarse.starts[bucket] as usize..coarse.starts[bucket + 1] as usize] {
                    let [first, last] =
                        other.reach.map(|columns| columns.map(|column| Frame::coarsened(column, 0, level)));
                    let is_near = (0..2).all(|at| (first[at] <= own[at]) & (own[at] <= last[at]));
                    if !is_near || other.column != about {
                        continue;
                    }
                    // The pair is reported by the column that contains the minimum corner of the
                    // boxes' intersection.
                    let begun = u32::from(first[0] < own[0]) | u32::from(first[1] < own[1]) << 1;
                    let record = frame.record(&other.image, level, own, other.key);
                    let [begin, end] = [other.image.min, other.image.max].map(|corner| corner[frame.along]);
                    let images = [(begin - longest).next_down(), end];
                    let span = Span { steps: images.map(|x| frame.step(x)), images };
                    dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
                        self.lanes.sweep_one(simd, record.word(), &span, #[inline(always)] |one| {
                            if one.second() & begun != 0 {
                                return;
                            }
                            if !is_shared {
                                report_overlap(one, &record, boxes, found, budget);
                            } else if column(one) == own && boxes_overlap(one, &record, boxes) {
                                found.push(pair(one, &record), budget);
                            }
                        });
                    }));
                }
            }
        }
    }
}

/// Reports a pair if its images overlap across the columns and the boxes overlap; compares the
/// boxes only if the images leave it uncertain.
#[inline(always)]
fn report_overlap(one: &Record, other: &Record, boxes: &[MinMax], found: &mut Found, budget: &Budget<'_>) {
    let verdict = one.verdict(other);
    if !verdict.is_apart && (verdict.is_certain || boxes_overlap(one, other, boxes)) {
        found.push(pair(one, other), budget);
    }
}

/// Reports whether the boxes of two copies overlap.
fn boxes_overlap(one: &Record, other: &Record, boxes: &[MinMax]) -> bool {
    boxes[one.key as usize].overlaps(&boxes[other.key as usize])
}

fn pair(one: &Record, other: &Record) -> [u32; 2] {
    [one.key.min(other.key), one.key.max(other.key)]
}
