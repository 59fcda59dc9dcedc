//! A run of rows becomes two, in the room that it has.
//!
//! Source: Polychroniou, Raghavan, Ross, *Rethinking SIMD vectorization for in-memory databases*, SIGMOD 2015: what a vector holds of
//! either part is brought together and stored as a whole. Ours parts in place: one of the parts begins where the run does, and is never
//! ahead of what is read.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i16x8, i16x32};

use super::layout::{ROOM, Run, SIXTEEN, WIDTH};

/// Where the next rows are, and where those of either part go, which is never before they were read.
pub(super) struct Parting {
    pub(super) at: usize,
    pub(super) low: usize,
    pub(super) high: usize,
}

/// Which rows are of the low part: those below the interval `from..to` along an axis, and the first `wanted` of those in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) axis: usize,
    pub(super) from: i16,
    pub(super) to: i16,
    pub(super) wanted: u32,
}

impl Parting {
    /// Of a run whose low part is half of it at least.
    pub(super) fn of(run: Run, low: usize) -> Self {
        Self { at: run.at, low: run.at, high: run.split(low).1.at }
    }

    /// Puts all rows up to `end`, as many together as one instruction or shuffle brings together: what comes after them, up to
    /// [`MOST_TOGETHER`](super::layout::MOST_TOGETHER), is beyond the interval, and either part has room for as many more.
    #[inline(always)]
    pub(super) fn put_all<S: Simd>(self, simd: S, columns: &mut [[i16; ROOM]; WIDTH], end: usize, cut: Cut) {
        // Only 512 bits have the instruction, elsewhere bytes of 128 bits are shuffled.
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
                // The others between are of the other part.
                (wanted, to) = (0, from);
            }
            self.put::<V, S>(simd, columns, is_low);
        }
    }

    /// Puts the next rows where those of their part go.
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

/// At most so many bits, the lowest ones.
#[inline(always)]
fn first_bits(bits: u64, count: u32) -> u64 {
    let mut others = bits;
    for _ in 0..count {
        others &= others - 1;
    }
    bits ^ others
}
