//! Splits a run of rows into two, within the room that the run has.
//!
//! Source: Polychroniou, Raghavan, Ross, *Rethinking SIMD vectorization for in-memory databases*,
//! SIGMOD 2015: the lanes of a vector that belong to one part are compressed and stored as a whole
//! vector. Ours splits in place: one of the parts starts where the run does, and its end never
//! passes the rows that are still to be read.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i16x8, i16x32};

use super::layout::{ROOM, Run, SIXTEEN, WIDTH};

/// The slot of the next rows to read (`at`), and the slots to which the next rows of either part
/// go. No slot that is written lies among the unread rows of the run.
pub(super) struct Parting {
    pub(super) at: usize,
    pub(super) low: usize,
    pub(super) high: usize,
}

/// Selects the rows of the low part: the rows below the interval `from..to` along an axis, and the
/// first `wanted` rows in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) axis: usize,
    pub(super) from: i16,
    pub(super) to: i16,
    pub(super) wanted: u32,
}

impl Parting {
    /// Starts to split a run whose low part is at least half of it.
    pub(super) fn of(run: Run, low: usize) -> Self {
        Self { at: run.at, low: run.at, high: run.split(low).1.at }
    }

    /// Moves all rows up to `end`, as many at a time as one instruction or shuffle can compress.
    /// The slots behind them, up to [`MAX_TOGETHER`](super::layout::MAX_TOGETHER), must hold
    /// coordinates beyond the interval. Either part must have room for as many more.
    #[inline(always)]
    pub(super) fn put_all<S: Simd>(self, simd: S, columns: &mut [[i16; ROOM]; WIDTH], end: usize, cut: Cut) {
        // Only vectors of 512 bits have the instruction. On others, bytes of 128 bits are shuffled.
        if <S::i16s as SimdBase<S>>::LEN > SIXTEEN {
            self.put_each::<i16x32<S>, S>(simd, columns, end, cut);
        } else {
            self.put_each::<i16x8<S>, S>(simd, columns, end, cut);
        }
    }

    #[inline(always)]
    fn put_each<V: SimdInt<S, Element = i16>, S: Simd>(
        mut self,
        simd: S,
        columns: &mut [[i16; ROOM]; WIDTH],
        end: usize,
        Cut { axis, from, mut to, mut wanted }: Cut,
    ) {
        while self.at < end {
            let along = V::from_slice(simd, &columns[axis][self.at..][..V::LEN]);
            let (below, before) = (along.simd_lt(from), along.simd_lt(to));
            let between = (before & !below).to_bitmask();
            let mut is_low = before;
            if between.count_ones() <= wanted {
                wanted -= between.count_ones();
            } else {
                is_low = V::Mask::from_bitmask(simd, below.to_bitmask() | first_bits(between, wanted));
                // The other rows in the interval belong to the high part.
                (wanted, to) = (0, from);
            }
            self.put::<V, S>(simd, columns, is_low);
        }
    }

    /// Moves the next rows to their parts.
    #[inline(always)]
    pub(super) fn put<V: SimdInt<S, Element = i16>, S: Simd>(
        &mut self,
        simd: S,
        columns: &mut [[i16; ROOM]; WIDTH],
        is_low: V::Mask,
    ) {
        for column in columns {
            let rows = V::from_slice(simd, &column[self.at..][..V::LEN]);
            rows.compress(is_low).store_slice(&mut column[self.low..][..V::LEN]);
            rows.compress(!is_low).store_slice(&mut column[self.high..][..V::LEN]);
        }
        let count = is_low.to_bitmask().count_ones() as usize;
        self.at += V::LEN;
        self.low += count;
        self.high += V::LEN - count;
    }
}

/// Returns the lowest `count` bits that are set. There must be at least `count`.
#[inline(always)]
fn first_bits(bits: u64, count: u32) -> u64 {
    let mut others = bits;
    for _ in 0..count {
        others &= others - 1;
    }
    bits ^ others
}
