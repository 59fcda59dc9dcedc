//! A column sorted and swept, eight boxes at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::Record;
use super::slots::Slots;
use crate::simd::{LANES, by_axis};

/// The copies of a column side by side, by where they begin along it, and memory to sort them in.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    /// As they came.
    records: Vec<Record>,
    slots: Slots,
    min: [Vec<f32>; 3],
    max: [Vec<f32>; 3],
    /// Where the sorted ones are among those that came.
    places: Vec<u32>,
    /// For each sorted copy the slot in which it ends.
    last_slots: Vec<u32>,
    hits: Vec<Hits>,
}

impl Lanes {
    /// Takes these copies in place of all others, sorted along an axis.
    #[inline(always)]
    pub(super) fn fill<'r>(&mut self, along: usize, blocks: impl Iterator<Item = &'r [Record]>) {
        self.records.clear();
        blocks.for_each(|block| self.records.extend_from_slice(block));
        self.slots.sort(self.records.iter().map(|record| record.min[along % 3]));
        let len = self.records.len();
        let padded = len + LANES;
        for lane in self.min.iter_mut().chain(&mut self.max) {
            lane.resize(padded, f32::NAN);
            // A vector that starts at the last copy reads what no comparison with holds.
            lane[len..].fill(f32::NAN);
        }
        self.places.resize(len, 0);
        let [x, y, z] = self.min.each_mut().map(|lane| &mut lane[..len]);
        let [end_x, end_y, end_z] = self.max.each_mut().map(|lane| &mut lane[..len]);
        let places = &mut self.places[..len];
        self.slots.each_place(
            #[inline(always)]
            |from, to| {
                let record = &self.records[from];
                [x[to], y[to], z[to]] = record.min;
                [end_x[to], end_y[to], end_z[to]] = record.max;
                places[to] = from as u32;
            },
        );
        self.last_slots.resize(len, 0);
        for (slot, &end) in self.last_slots.iter_mut().zip(&self.max[along % 3][..len]) {
            *slot = self.slots.of(end);
        }
    }

    /// The copies, as they came.
    pub(super) fn records(&self) -> &[Record] {
        &self.records
    }

    /// Calls `meet` for each two copies whose images meet.
    #[inline(always)]
    pub(super) fn sweep_self<S: Simd>(&mut self, simd: S, mut meet: impl FnMut(&Record, &Record)) {
        let len = self.records.len();
        let (min, max) = (
            self.min.each_ref().map(|lane| &lane[..len + LANES]),
            self.max.each_ref().map(|lane| &lane[..len + LANES]),
        );
        let (records, places, last_slots) = (&self.records[..], &self.places[..len], &self.last_slots[..len]);
        let mut expand = |hits: &[Hits]| {
            for &Hits { one, first, bits } in hits {
                let one = &records[places[one as usize] as usize];
                let mut bits = bits;
                while bits != 0 {
                    meet(one, &records[places[(first + bits.trailing_zeros()) as usize] as usize]);
                    bits &= bits - 1;
                }
            }
        };
        let hits = &mut self.hits;
        hits.resize(MOST_HITS, Hits::default());
        let hits = &mut hits[..MOST_HITS];
        let mut count = 0;
        for one in 0..len {
            let end = self.slots.end(last_slots[one]);
            let splats = splats(simd, [0, 1, 2].map(|k| [min[k][one], max[k][one]]));
            let mut at = one + 1;
            while at < end {
                let bits = compare(simd, [&min, &max], at, &splats);
                // Written in any case and kept where there is a hit: whether there is one is hard to predict.
                hits[count % MOST_HITS] = Hits { one: one as u32, first: at as u32, bits };
                count += usize::from(bits != 0);
                if count == MOST_HITS {
                    expand(hits);
                    count = 0;
                }
                at += LANES;
            }
        }
        expand(&hits[..count]);
    }

    /// Calls `meet` for each copy whose image meets that of another column's; none of these is longer than `longest`.
    #[inline(always)]
    pub(super) fn sweep_one<S: Simd>(
        &self,
        simd: S,
        along: usize,
        one: &Record,
        longest: f32,
        mut meet: impl FnMut(&Record),
    ) {
        let len = self.records.len();
        let (min, max) = (
            self.min.each_ref().map(|lane| &lane[..len + LANES]),
            self.max.each_ref().map(|lane| &lane[..len + LANES]),
        );
        let splats = splats(simd, [0, 1, 2].map(|k| [one.min[k], one.max[k]]));
        let start = self.slots.start(self.slots.of((one.min[along % 3] - longest).next_down()));
        let end = self.slots.end(self.slots.of(one.max[along % 3]));
        for at in (start..end).step_by(LANES) {
            let mut bits = compare(simd, [&min, &max], at, &splats);
            while bits != 0 {
                meet(&self.records[self.places[at + bits.trailing_zeros() as usize] as usize]);
                bits &= bits - 1;
            }
        }
    }
}

/// Sorted copies whose images meet one's: a bit each, from `first` on.
#[derive(Clone, Copy, Debug, Default)]
struct Hits {
    one: u32,
    first: u32,
    bits: u32,
}

/// Hits that are looked at together.
const MOST_HITS: usize = 256;

/// The least and the greatest coordinates of one box, on each axis and in each lane.
type Splats<S> = [[f32x8<S>; 2]; 3];

#[inline(always)]
fn splats<S: Simd>(simd: S, bounds: [[f32; 2]; 3]) -> Splats<S> {
    by_axis!(axis => [f32x8::splat(simd, bounds[axis][0]), f32x8::splat(simd, bounds[axis][1])])
}

/// Which of eight images meet one's. What is behind the range that is asked for begins in a later slot than the one ends, or
/// is no number.
#[inline(always)]
fn compare<S: Simd>(simd: S, [min, max]: [&[&[f32]; 3]; 2], at: usize, one: &Splats<S>) -> u32 {
    let meets = vector(simd, min[0], at).simd_le(one[0][1])
        & vector(simd, max[0], at).simd_ge(one[0][0])
        & vector(simd, min[1], at).simd_le(one[1][1])
        & vector(simd, max[1], at).simd_ge(one[1][0])
        & vector(simd, min[2], at).simd_le(one[2][1])
        & vector(simd, max[2], at).simd_ge(one[2][0]);
    meets.to_bitmask() as u32
}

/// Eight coordinates from a place on.
#[inline(always)]
fn vector<S: Simd>(simd: S, lane: &[f32], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &lane[at..at + LANES])
}
