//! Sorts a column and sweeps it, sixteen boxes at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u8x32, u32x8};

use super::found::Found;
use super::record::{Record, Verdict, probe};
use super::slots::Slots;

/// Number of copies compared at a time.
const COMPARED: usize = 16;
/// Number of copies in a vector.
const VECTOR_LANES: usize = 8;

/// The copies of a column, sorted by their beginnings along it, and memory to sort them in.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    /// Copies in the order in which they were added.
    unsorted: Vec<Record>,
    /// Sorted copies. In this and the following lists only the first entries, one per copy, are
    /// meaningful.
    sorted: Vec<Record>,
    slots: Slots,
    /// Word of each sorted copy, its interval across in four bytes: [`Record::word`].
    words: Vec<u32>,
    /// For each sorted copy, the index after the last copy that may begin before it ends.
    ends: Vec<u32>,
    hits: Vec<Hits>,
    /// Pairs whose images do not decide whether the boxes overlap.
    undecided: Vec<[u32; 2]>,
}

/// The part of a column that is searched: the steps, and the more precise images, of its beginning
/// and its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) steps: [u32; 2],
    pub(super) images: [f32; 2],
}

impl Lanes {
    /// Replaces all copies by these. `span` returns the images between which the box of a copy lies
    /// along the column.
    #[inline(always)]
    pub(super) fn fill<'r>(&mut self, blocks: impl Iterator<Item = &'r [Record]>, span: impl Fn(&Record) -> [f32; 2]) {
        self.unsorted.clear();
        blocks.for_each(|block| self.unsorted.extend_from_slice(block));
        let len = self.unsorted.len();
        if self.sorted.len() < len {
            self.sorted.resize(2 * len, Record::default());
            self.words.resize(2 * len + COMPARED, 0);
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

    /// Returns the copies in sorted order.
    pub(super) fn records(&self) -> &[Record] {
        &self.sorted[..self.unsorted.len()]
    }

    /// Adds each pair of copies whose boxes overlap to `found`. `reserve` reserves memory for a
    /// number of pairs, or returns `false` if the sweep must end. `classify` compares the images of
    /// two copies; `decide` compares the boxes if that is not certain.
    #[inline(always)]
    pub(super) fn sweep_self<S: Simd>(
        &mut self,
        simd: S,
        found: &mut Found,
        reserve: impl Fn(&mut Found, usize) -> bool,
        classify: impl Fn(&Record, &Record) -> Verdict,
        decide: impl Fn([u32; 2]) -> bool,
    ) {
        let len = self.unsorted.len();
        if len == 0 {
            return; // no memory is allocated yet
        }
        let words = &self.words[..len + COMPARED];
        let (records, ends) = (&self.sorted[..len], &self.ends[..len]);
        let undecided = &mut self.undecided;
        // Each round takes one hit of every entry. The number of hits of an entry and the verdict
        // about a hit thus cause no branches.
        let mut expand = |hits: &mut [Hits]| {
            let mut left = hits.len();
            while left > 0 {
                if !reserve(found, left) {
                    return false;
                }
                let found = &mut found.pairs;
                let before = found.len();
                found.resize(before + left, [0; 2]);
                undecided.resize(undecided.len().max(left), [0; 2]);
                let (met, asked) = (&mut found[before..], &mut undecided[..left]);
                let (mut kept, mut certain, mut uncertain) = (0, 0, 0);
                for at in 0..left {
                    let Hits { one, first, bits } = hits[at];
                    let (one_record, other) =
                        (&records[one as usize], &records[(first + bits.trailing_zeros()) as usize]);
                    let Verdict { is_apart, is_certain } = classify(one_record, other);
                    let pair = [one_record.key.min(other.key), one_record.key.max(other.key)];
                    (met[certain], asked[uncertain]) = (pair, pair);
                    certain += usize::from(is_certain & !is_apart);
                    uncertain += usize::from(!is_certain & !is_apart);
                    let bits = bits & (bits - 1);
                    hits[kept] = Hits { one, first, bits };
                    kept += usize::from(bits != 0);
                }
                found.truncate(before + certain);
                found.extend(undecided[..uncertain].iter().filter(|&&pair| decide(pair)));
                left = kept;
            }
            true
        };
        // Reserves room for all hits of one copy, so that the inner loop contains nothing but
        // comparisons.
        let hits = &mut self.hits;
        hits.resize(HITS_PER_BATCH + len.div_ceil(COMPARED) + 1, Hits::default());
        let mut count = 0;
        for one in 0..=len {
            // The only call, also for the remaining hits, so that it is inlined and compiled for
            // the vector unit.
            if count > HITS_PER_BATCH || one == len {
                if !expand(&mut hits[..count]) {
                    return;
                }
                count = 0;
            }
            let Some(&end) = ends.get(one) else { break };
            let end = end as usize;
            let limits = u32x8::splat(simd, probe(words[one]));
            let mut at = one + 1;
            while at < end {
                let bits = compare(simd, words, at, limits) & first_bits(end - at);
                // Always written, and kept only if there is a hit: a branch would be hard to
                // predict.
                hits[count] = Hits { one: one as u32, first: at as u32, bits };
                count += usize::from(bits != 0);
                at += COMPARED;
            }
        }
    }

    /// Calls `visit` for each copy whose image may overlap both a box with this word across the
    /// column and this span along it.
    #[inline(always)]
    pub(super) fn sweep_one<S: Simd>(&self, simd: S, word: u32, span: &Span, mut visit: impl FnMut(&Record)) {
        let words = &self.words[..self.unsorted.len() + COMPARED];
        let limits = u32x8::splat(simd, probe(word));
        let (start, end) = if self.slots.is_full() {
            (self.slots.full_start(span.images[0]), self.slots.full_end(span.images[1]))
        } else {
            (self.slots.start(span.steps[0]), self.slots.end(span.steps[1]))
        };
        let end = end as usize;
        for at in (start as usize..end).step_by(COMPARED) {
            let mut bits = compare(simd, words, at, limits) & first_bits(end - at);
            while bits != 0 {
                visit(&self.sorted[at + bits.trailing_zeros() as usize]);
                bits &= bits - 1;
            }
        }
    }
}

/// Sorted copies whose images overlap that of the copy `one`: one bit each, counted from index
/// `first`.
#[derive(Clone, Copy, Debug, Default)]
struct Hits {
    one: u32,
    first: u32,
    bits: u32,
}

/// Number of hits that are expanded together.
const HITS_PER_BATCH: usize = 256;

/// Returns one bit for each of `count` copies, at most the number compared at a time.
#[inline(always)]
fn first_bits(count: usize) -> u32 {
    (1 << count.min(COMPARED)) - 1
}

/// Returns one bit for each word from index `at` on: set if none of its bytes exceeds the byte in
/// `limits`.
#[inline(always)]
fn compare<S: Simd>(simd: S, words: &[u32], at: usize, limits: u32x8<S>) -> u32 {
    let limits = limits.bitcast::<u8x32<S>>();
    let words = &words[at..at + COMPARED];
    let mut bits = 0;
    for vector in 0..COMPARED / VECTOR_LANES {
        let words = u32x8::from_slice(simd, &words[vector * VECTOR_LANES..][..VECTOR_LANES]);
        let is_near = words.bitcast::<u8x32<S>>().min(limits).bitcast::<u32x8<S>>().simd_eq(words);
        bits |= (is_near.to_bitmask() as u32) << (vector * VECTOR_LANES);
    }
    bits
}
