//! A column sorted and swept, sixteen boxes at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i16x16};

use super::record::Record;
use super::slots::Slots;

/// Copies in a vector.
const WIDE: usize = 16;

/// The copies of a column side by side, by where they begin along it, and memory to sort them in.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    /// As they came.
    unsorted: Vec<Record>,
    /// In order; here and below what is behind their number means nothing.
    sorted: Vec<Record>,
    slots: Slots,
    /// On each axis across, where they begin and end.
    across: [[Vec<i16>; 2]; 2],
    /// For each sorted copy where those end that may begin before it ends.
    ends: Vec<u32>,
    hits: Vec<Hits>,
}

/// Which part of the columns is asked for: the steps and the images of where it begins and ends along.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) steps: [u32; 2],
    pub(super) images: [f32; 2],
}

impl Lanes {
    /// Takes these copies in place of all others; `span` tells where the box of a copy is along.
    #[inline(always)]
    pub(super) fn fill<'r>(&mut self, blocks: impl Iterator<Item = &'r [Record]>, span: impl Fn(&Record) -> [f32; 2]) {
        self.unsorted.clear();
        blocks.for_each(|block| self.unsorted.extend_from_slice(block));
        let len = self.unsorted.len();
        if self.ends.len() < len {
            self.sorted.resize(2 * len, Record::default());
            self.ends.resize(2 * len, 0);
            self.across.as_flattened_mut().iter_mut().for_each(|lane| lane.resize(2 * len + WIDE, 0));
        }
        let sorted = &mut self.sorted[..len];
        self.slots.sort(&self.unsorted, sorted, |record| span(record)[0]);
        let [[x, end_x], [y, end_y]] =
            self.across.each_mut().map(|lanes| lanes.each_mut().map(|lane| &mut lane[..len]));
        for (at, record) in sorted.iter().enumerate() {
            [x[at], end_x[at]] = record.across(0);
            [y[at], end_y[at]] = record.across(1);
        }
        let ends = &mut self.ends[..len];
        if self.slots.is_full() {
            ends.iter_mut().zip(sorted).for_each(|(end, record)| *end = self.slots.full_end(span(record)[1]));
        } else {
            let slots = self.slots.ends();
            ends.iter_mut().zip(sorted).for_each(|(end, record)| *end = slots.at(record.along()[1]));
        }
    }

    /// The copies, in order.
    pub(super) fn records(&self) -> &[Record] {
        &self.sorted[..self.unsorted.len()]
    }

    /// Calls `meet` for each two copies whose images meet across, and may meet along.
    #[inline(always)]
    pub(super) fn sweep_self<S: Simd>(&mut self, simd: S, mut meet: impl FnMut(&Record, &Record)) {
        let len = self.unsorted.len();
        if len == 0 {
            return; // before there is any memory
        }
        let lanes = self.across.each_ref().map(|lanes| lanes.each_ref().map(|lane| &lane[..len + WIDE]));
        let (records, ends) = (&self.sorted[..len], &self.ends[..len]);
        let mut expand = |hits: &[Hits]| {
            for &Hits { one, first, bits } in hits {
                let one = &records[one as usize];
                let mut bits = bits;
                while bits != 0 {
                    meet(one, &records[(first + bits.trailing_zeros()) as usize]);
                    bits &= bits - 1;
                }
            }
        };
        // Room for all of one copy, so that nothing but comparisons is in the inner loop.
        let hits = &mut self.hits;
        hits.resize(MOST_HITS + len.div_ceil(WIDE) + 1, Hits::default());
        let mut count = 0;
        for one in 0..len {
            let end = ends[one] as usize;
            if count > MOST_HITS {
                expand(&hits[..count]);
                count = 0;
            }
            let splats = splats(simd, lanes.map(|lanes| lanes.map(|lane| lane[one])));
            let mut at = one + 1;
            while at < end {
                let bits = compare(simd, &lanes, at, &splats) & first_bits(end - at);
                // Written in any case and kept where there is a hit: whether there is one is hard to predict.
                hits[count] = Hits { one: one as u32, first: at as u32, bits };
                count += usize::from(bits != 0);
                at += WIDE;
            }
        }
        expand(&hits[..count]);
    }

    /// Calls `meet` for each copy whose image meets these intervals across, and may meet this span along.
    #[inline(always)]
    pub(super) fn sweep_one<S: Simd>(
        &self,
        simd: S,
        across: [[i16; 2]; 2],
        span: &Span,
        mut meet: impl FnMut(&Record),
    ) {
        let len = self.unsorted.len();
        let lanes = self.across.each_ref().map(|lanes| lanes.each_ref().map(|lane| &lane[..len + WIDE]));
        let splats = splats(simd, across);
        let (start, end) = if self.slots.is_full() {
            (self.slots.full_start(span.images[0]), self.slots.full_end(span.images[1]))
        } else {
            (self.slots.start(span.steps[0]), self.slots.end(span.steps[1]))
        };
        let end = end as usize;
        for at in (start as usize..end).step_by(WIDE) {
            let mut bits = compare(simd, &lanes, at, &splats) & first_bits(end - at);
            while bits != 0 {
                meet(&self.sorted[at + bits.trailing_zeros() as usize]);
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

/// As many bits as there are copies, or as a vector has.
#[inline(always)]
fn first_bits(count: usize) -> u32 {
    (1 << count.min(WIDE)) - 1
}

/// Where one box begins and ends on each axis across, in each lane.
type Splats<S> = [[i16x16<S>; 2]; 2];

#[inline(always)]
fn splats<S: Simd>(simd: S, across: [[i16; 2]; 2]) -> Splats<S> {
    let [[x, end_x], [y, end_y]] = across;
    [[i16x16::splat(simd, x), i16x16::splat(simd, end_x)], [i16x16::splat(simd, y), i16x16::splat(simd, end_y)]]
}

/// Which of sixteen images meet one's across.
#[inline(always)]
fn compare<S: Simd>(simd: S, lanes: &[[&[i16]; 2]; 2], at: usize, one: &Splats<S>) -> u32 {
    let meets = vector(simd, lanes[0][0], at).simd_lt(one[0][1])
        & one[0][0].simd_lt(vector(simd, lanes[0][1], at))
        & vector(simd, lanes[1][0], at).simd_lt(one[1][1])
        & one[1][0].simd_lt(vector(simd, lanes[1][1], at));
    meets.to_bitmask() as u32
}

/// Sixteen coordinates from a place on.
#[inline(always)]
fn vector<S: Simd>(simd: S, lane: &[i16], at: usize) -> i16x16<S> {
    i16x16::from_slice(simd, &lane[at..at + WIDE])
}
