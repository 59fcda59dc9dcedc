//! Columns sorted and swept, eight boxes at a time.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::Record;
use crate::simd::LANES;

/// Copies side by side, in the order in which they begin along the columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    min: [Vec<f32>; 3],
    max: [Vec<f32>; 3],
    names: Vec<[u32; 2]>,
}

impl Lanes {
    pub(super) fn clear(&mut self) {
        self.min.iter_mut().chain(&mut self.max).for_each(Vec::clear);
        self.names.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.names.len()
    }

    #[inline(always)]
    fn push(&mut self, record: &Record) {
        for axis in 0..3 {
            self.min[axis].push(record.min[axis]);
            self.max[axis].push(record.max[axis]);
        }
        self.names.push([record.key, record.copy]);
    }

    /// Adds what a vector that starts at the last copy reads: no comparison with it holds.
    pub(super) fn pad(&mut self) {
        let padded = self.names.len() + LANES;
        self.min.iter_mut().chain(&mut self.max).for_each(|lane| lane.resize(padded, f32::NAN));
    }

    #[inline(always)]
    pub(super) fn begin(&self, at: usize) -> f32 {
        self.min[0][at]
    }

    #[inline]
    pub(super) fn record(&self, at: usize) -> Record {
        let [key, copy] = self.names[at];
        Record { min: [0, 1, 2].map(|k| self.min[k][at]), max: [0, 1, 2].map(|k| self.max[k][at]), key, copy }
    }

    /// Calls `meet` for each two copies of a range whose images meet.
    #[inline(always)]
    pub(super) fn sweep_self<S: Simd>(&self, simd: S, range: Range<usize>, mut meet: impl FnMut(usize, usize)) {
        for at in range.clone() {
            let one = self.record(at);
            self.sweep_from::<S, false>(
                simd,
                at + 1..range.end,
                &one,
                #[inline(always)]
                |other| meet(at, other),
            );
        }
    }

    /// Calls `meet` for each copy of a range whose image meets this one.
    #[inline(always)]
    pub(super) fn sweep_one<S: Simd>(&self, simd: S, range: Range<usize>, one: &Record, meet: impl FnMut(usize)) {
        self.sweep_from::<S, true>(simd, range, one, meet);
    }

    /// Those that begin later than this one need not be asked whether they end before it begins: without `EARLIER`.
    #[inline(always)]
    fn sweep_from<S: Simd, const EARLIER: bool>(
        &self,
        simd: S,
        range: Range<usize>,
        one: &Record,
        mut meet: impl FnMut(usize),
    ) {
        let mut at = range.start;
        while at < range.end {
            let begins = vector(simd, &self.min[0], at).simd_le(f32x8::splat(simd, one.max[0]));
            let mut meets = begins
                & vector(simd, &self.min[1], at).simd_le(f32x8::splat(simd, one.max[1]))
                & vector(simd, &self.max[1], at).simd_ge(f32x8::splat(simd, one.min[1]))
                & vector(simd, &self.min[2], at).simd_le(f32x8::splat(simd, one.max[2]))
                & vector(simd, &self.max[2], at).simd_ge(f32x8::splat(simd, one.min[2]));
            if EARLIER {
                meets = meets & vector(simd, &self.max[0], at).simd_ge(f32x8::splat(simd, one.min[0]));
            }
            let mut bits = meets.to_bitmask() as u32;
            while bits != 0 {
                let other = at + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                // Behind the range other columns follow.
                if other < range.end {
                    meet(other);
                }
            }
            if begins.to_bitmask() as u32 != (1 << LANES) - 1 {
                return;
            }
            at += LANES;
        }
    }
}

/// Eight coordinates from a place on.
#[inline(always)]
fn vector<S: Simd>(simd: S, lane: &[f32], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &lane[at..at + LANES])
}

/// The columns of a level in order, one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Coarse {
    pub(super) lanes: Lanes,
    /// Where each column starts, and the last one ends.
    pub(super) starts: Vec<u32>,
    /// The greatest extent along the columns; not a number where some image has none.
    pub(super) widest: f32,
}

impl Coarse {
    pub(super) fn clear(&mut self) {
        self.lanes.clear();
        self.starts.clear();
        self.starts.push(0);
        self.widest = 0.0;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lanes.len() == 0
    }

    /// Adds a column after the others.
    pub(super) fn push(&mut self, sorter: &mut Sorter) {
        for record in &sorter.records {
            let extent = record.max[0] - record.min[0];
            // An extent that is not a number makes the widest one so, and all searches start at the first.
            self.widest = if self.widest >= extent { self.widest } else { extent };
            self.widest = if extent.is_nan() { f32::INFINITY } else { self.widest };
        }
        self.widest = self.widest.next_up();
        sorter.sort_onto(&mut self.lanes);
        self.starts.push(self.lanes.len() as u32);
    }

    pub(super) fn range(&self, column: usize) -> Range<usize> {
        self.starts[column] as usize..self.starts[column + 1] as usize
    }

    /// How many of a range begin before this.
    pub(super) fn first_from(&self, range: Range<usize>, from: f32) -> usize {
        self.lanes.min[0][range].partition_point(|&begin| begin < from)
    }
}

/// Memory to sort a column in.
#[derive(Clone, Debug, Default)]
pub(super) struct Sorter {
    records: Vec<Record>,
    /// Where copies begin, as integers in the same order, above their places.
    keys: Vec<u64>,
    dealt: Vec<u64>,
    starts: Vec<u32>,
}

/// Copies that are sorted by comparisons alone.
const FEW: usize = 32;

/// Slots at most: their counts fit the first cache.
const MOST_SLOTS: usize = 1 << 11;

/// Copies in a slot above which all are sorted by comparisons: short slots are mended by insertion, in quadratic time.
const FULLEST: u32 = 24;

impl Sorter {
    pub(super) fn len(&self) -> usize {
        self.records.len()
    }

    pub(super) fn gather<'r>(&mut self, blocks: impl Iterator<Item = &'r [Record]>) {
        self.records.clear();
        blocks.for_each(|block| self.records.extend_from_slice(block));
    }

    /// Adds the gathered copies in order.
    pub(super) fn sort_onto(&mut self, lanes: &mut Lanes) {
        self.keys.clear();
        self.keys.extend(self.records.iter().enumerate().map(|(at, r)| u64::from(ordered(r.min[0])) << 32 | at as u64));
        if self.keys.len() <= FEW || !self.deal() {
            self.keys.sort_unstable();
        }
        for &key in &self.keys {
            lanes.push(&self.records[key as u32 as usize]);
        }
    }

    /// Sorts by slots of equal length between the first and the last; whether no slot is so full that it takes too long.
    fn deal(&mut self) -> bool {
        let ends = self.records.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], record| {
            [low.min(record.min[0]), high.max(record.min[0])]
        });
        let slots = self.keys.len().next_power_of_two().min(MOST_SLOTS);
        let scale = slots as f32 / (ends[1] - ends[0]);
        // Rounded differences and products are monotone; what is not a number falls into the first slot.
        let slot = |record: &Record| (((record.min[0] - ends[0]) * scale) as usize).min(slots - 1);
        self.starts.clear();
        self.starts.resize(slots, 0);
        for record in &self.records {
            self.starts[slot(record)] += 1;
        }
        let mut before = 0;
        for start in &mut self.starts {
            if *start > FULLEST {
                return false;
            }
            (*start, before) = (before, before + *start);
        }
        self.dealt.clear();
        self.dealt.resize(self.keys.len(), 0);
        for (record, &key) in self.records.iter().zip(&self.keys) {
            let place = &mut self.starts[slot(record)];
            self.dealt[*place as usize] = key;
            *place += 1;
        }
        std::mem::swap(&mut self.keys, &mut self.dealt);
        for at in 1..self.keys.len() {
            let key = self.keys[at];
            let mut to = at;
            while to > 0 && self.keys[to - 1] > key {
                self.keys[to] = self.keys[to - 1];
                to -= 1;
            }
            self.keys[to] = key;
        }
        true
    }
}

/// Floats as integers in the same order, zeros of both signs the same.
fn ordered(x: f32) -> u32 {
    let bits = (x + 0.0).to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}
