//! A column sorted and swept, sixteen boxes at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u8x32, u32x8};

use super::record::{Record, Verdict, probe};
use super::slots::Slots;

/// Copies that are compared at a time, and in a vector.
const WIDE: usize = 16;
const VECTOR: usize = 8;

/// The copies of a column, by where they begin along it, and memory to sort them in.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    /// As they came.
    unsorted: Vec<Record>,
    /// In order; here and below what is behind their number means nothing.
    sorted: Vec<Record>,
    slots: Slots,
    /// Of each where it is across, in four bytes.
    words: Vec<u32>,
    /// Where those end that may begin before a copy ends, for each; only where they are sorted in full.
    ends: Vec<u32>,
    hits: Vec<Hits>,
    /// Pairs of which images are not certain.
    open: Vec<[u32; 2]>,
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
        if self.sorted.len() < len {
            self.sorted.resize(2 * len, Record::default());
            self.words.resize(2 * len + WIDE, 0);
            self.ends.resize(2 * len, 0);
        }
        let sorted = &mut self.sorted[..len];
        self.slots.sort(&self.unsorted, sorted, |record| span(record)[0]);
        self.words.iter_mut().zip(&*sorted).for_each(|(word, record)| *word = record.word());
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

    /// Adds each two copies to `found` whose boxes meet: as `judge` says, or `decide` where it is not certain.
    #[inline(always)]
    pub(super) fn sweep_self<S: Simd>(
        &mut self,
        simd: S,
        found: &mut Vec<[u32; 2]>,
        judge: impl Fn(&Record, &Record) -> Verdict,
        decide: impl Fn([u32; 2]) -> bool,
    ) {
        let len = self.unsorted.len();
        if len == 0 {
            return; // before there is any memory
        }
        let words = &self.words[..len + WIDE];
        let (records, ends) = (&self.sorted[..len], &self.ends[..len]);
        let open = &mut self.open;
        // Each has one hit taken at a time, so that how many it has is no branch, nor what is judged of it.
        let mut expand = |hits: &mut [Hits]| {
            let mut left = hits.len();
            while left > 0 {
                let before = found.len();
                found.resize(before + left, [0; 2]);
                open.resize(open.len().max(left), [0; 2]);
                let (met, asked) = (&mut found[before..], &mut open[..left]);
                let (mut kept, mut certain, mut uncertain) = (0, 0, 0);
                for at in 0..left {
                    let Hits { one, first, bits } = hits[at];
                    let (one_record, other) =
                        (&records[one as usize], &records[(first + bits.trailing_zeros()) as usize]);
                    let Verdict { is_apart, is_certain } = judge(one_record, other);
                    let pair = [one_record.key.min(other.key), one_record.key.max(other.key)];
                    (met[certain], asked[uncertain]) = (pair, pair);
                    certain += usize::from(is_certain & !is_apart);
                    uncertain += usize::from(!is_certain & !is_apart);
                    let bits = bits & (bits - 1);
                    hits[kept] = Hits { one, first, bits };
                    kept += usize::from(bits != 0);
                }
                found.truncate(before + certain);
                found.extend(open[..uncertain].iter().filter(|&&pair| decide(pair)));
                left = kept;
            }
        };
        // Room for all of one copy, so that nothing but comparisons is in the inner loop.
        let hits = &mut self.hits;
        hits.resize(MOST_HITS + len.div_ceil(WIDE) + 1, Hits::default());
        let mut count = 0;
        for one in 0..=len {
            // Called from here alone, the last time too, so that it is compiled with the vector unit.
            if count > MOST_HITS || one == len {
                expand(&mut hits[..count]);
                count = 0;
            }
            let Some(&end) = ends.get(one) else { break };
            let end = end as usize;
            let most = u32x8::splat(simd, probe(words[one]));
            let mut at = one + 1;
            while at < end {
                let bits = compare(simd, words, at, most) & first_bits(end - at);
                // Written in any case and kept where there is a hit: whether there is one is hard to predict.
                hits[count] = Hits { one: one as u32, first: at as u32, bits };
                count += usize::from(bits != 0);
                at += WIDE;
            }
        }
    }

    /// Calls `meet` for each copy whose image may meet one that has this word across, and may meet this span along.
    #[inline(always)]
    pub(super) fn sweep_one<S: Simd>(&self, simd: S, word: u32, span: &Span, mut meet: impl FnMut(&Record)) {
        let words = &self.words[..self.unsorted.len() + WIDE];
        let most = u32x8::splat(simd, probe(word));
        let (start, end) = if self.slots.is_full() {
            (self.slots.full_start(span.images[0]), self.slots.full_end(span.images[1]))
        } else {
            (self.slots.start(span.steps[0]), self.slots.end(span.steps[1]))
        };
        let end = end as usize;
        for at in (start as usize..end).step_by(WIDE) {
            let mut bits = compare(simd, words, at, most) & first_bits(end - at);
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

/// As many bits as there are copies, or as are compared at a time.
#[inline(always)]
fn first_bits(count: usize) -> u32 {
    (1 << count.min(WIDE)) - 1
}

/// Which words from a place on have no byte that is more than one's.
#[inline(always)]
fn compare<S: Simd>(simd: S, words: &[u32], at: usize, most: u32x8<S>) -> u32 {
    let most = most.bitcast::<u8x32<S>>();
    let words = &words[at..at + WIDE];
    let mut bits = 0;
    for vector in 0..WIDE / VECTOR {
        let words = u32x8::from_slice(simd, &words[vector * VECTOR..][..VECTOR]);
        let is_near = words.bitcast::<u8x32<S>>().min(most).bitcast::<u32x8<S>>().simd_eq(words);
        bits |= (is_near.to_bitmask() as u32) << (vector * VECTOR);
    }
    bits
}
