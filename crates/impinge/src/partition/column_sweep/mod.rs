//! All pairs of boxes that all move: sorted into columns and swept along them, from nothing, each time.
//!
//! Source: Tracy, Buss, Woods, *Efficient large-scale sweep and prune methods with AABB insertion and removal*, IEEE VR 2009
//! (a grid of sweeps); Ericson, 7.2 (levels for sizes). Ours departs in that nothing is kept from step to step, in columns
//! that cross space so that a sweep replaces one axis of the grid, in sixteen boxes a comparison, and in coordinates that are
//! rounded *monotonically* to whole steps of 15 bits: if a coordinate is not greater than another, neither is its step. Steps
//! that are apart thus prove boxes apart, steps that overlap by more than a touch prove that they meet, and only for a touch
//! are the boxes themselves asked.

mod columns;
mod frame;
mod lanes;
mod order;
mod record;
mod slots;

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::Simd;
use rayon::prelude::*;

use crate::simd::{best_level, dispatch};
use crate::volume::{BoundingVolume, MinMax};
use columns::Columns;
use frame::{Frame, Image, LARGEST, LEVELS, nearest};
use lanes::{Lanes, Span};
use order::sort_pairs;
use record::{Record, Verdict};

/// Finds all pairs of boxes that meet, without memory of earlier places: the quickest way where most boxes move.
///
/// Boxes about as large as each other share one level of columns, with copies in each column that they reach into; larger
/// ones have levels of their own, up to one for those that are larger than the scene. It holds no boxes and so answers no
/// questions but this; what it keeps is memory to work in.
///
/// # Complexity
/// O(n) and a sweep of each column: boxes that are spread are compared with about ten others each, and sizes over any
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
    sweepers: Vec<Sweeper>,
}

/// What a thread sweeps columns with.
#[derive(Clone, Debug, Default)]
struct Sweeper {
    lanes: Lanes,
    /// Pairs before they are sorted.
    found: Vec<[u32; 2]>,
}

/// The columns of a level one after the other.
#[derive(Clone, Debug, Default)]
struct Coarse {
    copies: Vec<CoarseCopy>,
    /// Where each column starts, and the last one ends.
    starts: Vec<u32>,
}

/// A box of a coarse level in one of its columns.
#[derive(Clone, Copy, Debug)]
struct CoarseCopy {
    image: Image,
    key: u32,
    column: [i32; 2],
    /// The columns of the finest level that it reaches into first and last.
    reach: [[i32; 2]; 2],
}

/// Boxes that a thread sorts into columns at least: of 3,000 two threads take 0.66 of the time of one, of 10,000 as much.
const SHORTEST_RUN: usize = 1 << 11;

/// Columns that a thread takes at a time: so few that no thread waits for another for long.
const TASK: usize = 4;

impl ColumnSweep {
    /// One that has no memory yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts the pairs of places in `boxes` whose boxes meet in `pairs`, in place of what is there: sorted, each once, the
    /// lesser first. Exact, and the same for any number of threads, on as many as the caller's `rayon` pool has.
    pub fn find(&mut self, boxes: &[MinMax], pairs: &mut Vec<[u32; 2]>) {
        let Some(frame) = Frame::of(boxes) else { return pairs.clear() };
        self.deal(&frame, boxes);
        self.gather_coarse(&frame, boxes);
        self.sweep(&frame, boxes);
        let Some((first, others)) = self.sweepers.split_first_mut() else { return };
        others.iter().for_each(|other| first.found.extend_from_slice(&other.found));
        sort_pairs(&mut first.found, pairs, boxes.len());
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

    fn sweep(&mut self, frame: &Frame, boxes: &[MinMax]) {
        let (runs, coarse) = (&self.runs, &self.coarse);
        let used = (0..LEVELS).filter(|&level| level == 0 || !coarse[level - 1].copies.is_empty());
        let tasks = used.flat_map(|level| {
            let places = frame.columns(level);
            places.clone().step_by(TASK).map(move |first| (level, first..places.end.min(first + TASK)))
        });
        let sweep = |Sweeper { lanes, found }: &mut Sweeper, (level, places): (usize, Range<usize>)| {
            for place in places {
                let blocks = runs.iter().flat_map(|run| run.blocks(place));
                let is_shared = runs.iter().any(|run| run.is_shared(place));
                let mut bucket = Bucket { frame, boxes, level, place, is_shared, lanes };
                bucket.find(blocks, &coarse[level..], found);
            }
        };
        self.sweepers.resize_with(runs.len(), Sweeper::default);
        self.sweepers.iter_mut().for_each(|sweeper| sweeper.found.clear());
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

/// The column of a copy, which does not say it.
fn own_column(frame: &Frame, level: usize, image: &Image, record: &Record) -> [i32; 2] {
    let [first, _] = frame.reach(image, level);
    [0, 1].map(|axis| first[axis] + (record.second() >> axis & 1) as i32)
}

/// A column at work, or several that share its place.
struct Bucket<'a> {
    frame: &'a Frame,
    boxes: &'a [MinMax],
    level: usize,
    place: usize,
    is_shared: bool,
    lanes: &'a mut Lanes,
}

impl Bucket<'_> {
    /// Finds the pairs among these copies, and of them with those of coarser levels.
    fn find<'r>(&mut self, blocks: impl Iterator<Item = &'r [Record]>, coarser: &[Coarse], found: &mut Vec<[u32; 2]>) {
        let &mut Self { frame, boxes, level, is_shared, .. } = self;
        let span = |record: &Record| {
            let image = frame.image(&boxes[record.key as usize]);
            [image.min[frame.along], image.max[frame.along]]
        };
        let column = |record: &Record| own_column(frame, level, &frame.image(&boxes[record.key as usize]), record);
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            self.lanes.fill(blocks, span);
            let judge = |one: &Record, other: &Record| {
                // Of the columns that both reach into the first reports them.
                let is_seen = one.second() & other.second() != 0;
                let Verdict { is_apart, is_certain } = one.verdict(other);
                if is_shared {
                    return Verdict { is_apart: is_seen || column(one) != column(other), is_certain: false };
                }
                Verdict { is_apart: is_seen | is_apart, is_certain }
            };
            let decide = |[one, other]: [u32; 2]| boxes[one as usize].overlaps(&boxes[other as usize]);
            self.lanes.sweep_self(simd, found, judge, decide);
        }));
        if !self.lanes.records().is_empty() && coarser.iter().any(|coarse| !coarse.copies.is_empty()) {
            self.find_coarser(coarser, found);
        }
    }

    /// A coarse copy that comes near these is swept against them: there are few.
    fn find_coarser(&self, coarser: &[Coarse], found: &mut Vec<[u32; 2]>) {
        let &Self { frame, boxes, level, is_shared, .. } = self;
        let column = |record: &Record| own_column(frame, level, &frame.image(&boxes[record.key as usize]), record);
        let mut columns: Vec<[i32; 2]> = Vec::new();
        if is_shared {
            columns.extend(self.lanes.records().iter().map(column));
            columns.sort_unstable();
            columns.dedup();
        } else {
            columns.push(frame.column_at(level, self.place));
        }
        // A little more than the sizes of a level, for the rounding of differences.
        let longest = LARGEST * 1.001 * (1_u32 << (2 * level)) as f32;
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
                    // The column that reports a pair holds the least corner of what the two share.
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
                                meet(one, &record, boxes, found);
                            } else if column(one) == own && are_met(one, &record, boxes) {
                                found.push(pair(one, &record));
                            }
                        });
                    }));
                }
            }
        }
    }
}

/// Reports a pair whose images meet across, if the boxes themselves meet.
#[inline(always)]
fn meet(one: &Record, other: &Record, boxes: &[MinMax], found: &mut Vec<[u32; 2]>) {
    let verdict = one.verdict(other);
    if !verdict.is_apart && (verdict.is_certain || are_met(one, other, boxes)) {
        found.push(pair(one, other));
    }
}

/// Whether the boxes of two copies meet.
fn are_met(one: &Record, other: &Record, boxes: &[MinMax]) -> bool {
    boxes[one.key as usize].overlaps(&boxes[other.key as usize])
}

fn pair(one: &Record, other: &Record) -> [u32; 2] {
    [one.key.min(other.key), one.key.max(other.key)]
}
