//! The boxes of a cluster while it is split, as a table with a row for each box: the center in
//! small integers, and the index of the box. The table is stored by columns, so that whole vectors
//! can be read. Splits move rows. A run (consecutive rows) has room for twice its length and is
//! split within that room (see [`parting`]).
//!
//! Tests: `columns/tests.rs`, at every vector level. Benchmark: `hierarchies`.

mod layout;
mod parting;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, i16x8, i16x16, i32x8};

use super::boxes::{Center, lanes_of_eight};
use crate::simd::{LANES, by_axis, transposed};
pub(super) use layout::{MAX_PLANES, MAX_ROWS, Run};
use layout::{MAX_TOGETHER, NUMBER, ROOM, SIXTEEN, WIDTH};
use parting::{Cut, Parting};

/// A coordinate above all others. It marks slots without a row.
const BEYOND: i16 = i16::MAX;

/// Maximum coordinate of a row.
const LAST: f32 = (BEYOND - 1) as f32;

/// Maximum number of rows that are ranked by comparing each with each. More are split by counting.
const MAX_RANKED: usize = 64;

/// The rows of a cluster. The memory is reused for one cluster after another.
pub(super) struct Columns {
    columns: Box<[[i16; ROOM]; WIDTH]>,
    finished: Box<[i16; MAX_ROWS + 2 * SIXTEEN]>,
}

impl Default for Columns {
    fn default() -> Self {
        Self { columns: bytemuck::allocation::zeroed_box(), finished: bytemuck::allocation::zeroed_box() }
    }
}

impl Columns {
    /// Writes the rows of these centers; there must be at least one. If the centers coincide or
    /// their extent overflows, all rows get the same coordinates.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, centers: &[Center]) {
        let (min, max) = reach(simd, centers);
        let extent = max - min;
        let scale = LAST / extent[0].max(extent[1]).max(extent[2]);
        let is_cube = scale.is_finite() && (extent[0] + extent[1] + extent[2]).is_finite();
        let cells = is_cube.then_some((min, scale));
        let (eights, rest) = centers.as_chunks::<LANES>();
        for (first, eight) in (0..).step_by(LANES).zip(eights) {
            self.set_eight(simd, first, eight, cells);
        }
        if let Some(last) = rest.last() {
            let mut eight = [*last; LANES];
            eight[..rest.len()].copy_from_slice(rest);
            self.set_eight(simd, centers.len() - rest.len(), &eight, cells);
        }
    }

    /// Writes eight rows. `cells` is the lower corner of the cube around the centers, and the
    /// number of cells per unit of length.
    #[inline(always)]
    fn set_eight<S: Simd>(&mut self, simd: S, first: usize, eight: &[Center; LANES], cells: Option<(f32x4<S>, f32)>) {
        let [low, high] = lanes_of_eight(simd, eight);
        let [x, y, z] = match cells {
            Some((min, scale)) => {
                let twice = transposed(low, high);
                by_axis!(axis => ((twice[axis] - min[axis]) * scale).to_int::<i32x8<S>>())
            }
            None => [i32x8::splat(simd, 0); 3],
        };
        let number = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]) + first as i32;
        let ((x, y), (z, number)) = (x.saturating_narrow(y).split(), z.saturating_narrow(number).split());
        for (column, eight) in self.columns.iter_mut().zip([x, y, z, number]) {
            eight.store_slice(&mut column[first..][..LANES]);
        }
    }

    /// Splits rows by a plane through the middle of their box, across its longest axis. Returns
    /// `None` if all rows have the same coordinates, or if the run has been split by planes often
    /// enough.
    #[inline(always)]
    pub(super) fn part_by_plane<S: Simd>(&mut self, simd: S, run: Run) -> Option<(Run, Run)> {
        let planes = run.planes.checked_sub(1)?;
        let (axis, [least, greatest]) = self.widest::<MAX_TOGETHER, S>(simd, run);
        let pivot = least + (greatest - least) / 2 + 1;
        if pivot > greatest {
            return None;
        }
        let low = count_below(simd, self.along(axis, run), pivot);
        // The larger part stays, so the smaller part goes behind all rows that are still to be
        // read.
        let larger = low.max(run.len - low);
        let behind = run.at + 2 * larger + (MAX_TOGETHER << planes);
        let (low_at, high_at) = if low == larger { (run.at, behind) } else { (behind, run.at) };
        let parting = Parting { at: run.at, low: low_at, high: high_at };
        let cut = Cut { axis, from: pivot, to: pivot, wanted: 0 };
        parting.put_all(simd, &mut self.columns, run.at + run.len, cut);
        Some((Run { len: low, at: low_at, planes, ..run }, run.high(low, high_at, planes)))
    }

    /// Splits more than sixteen rows. The `low` rows that come first along the longest axis of the
    /// rows' box go to the start of the room. The others start `2 * low` slots later, so that the
    /// first part has room for twice its length too. Both parts keep their order. `low` must be a
    /// multiple of eight, and at least half of the rows.
    #[inline(always)]
    pub(super) fn part<S: Simd>(&mut self, simd: S, run: Run, low: usize) -> (Run, Run) {
        if run.len <= 2 * SIXTEEN {
            self.part_few::<2, S>(simd, run, low);
        } else if run.len <= MAX_RANKED {
            self.part_few::<4, S>(simd, run, low);
        } else {
            self.part_many(simd, run, low);
        }
        run.split(low)
    }

    /// Finishes up to sixteen rows: writes the eight rows that come first along the longest axis of
    /// their box, then the others. Both groups keep their order.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(&mut self, simd: S, run: Run) {
        let [rank] = self.ranks(simd, run);
        let (low, high) = rank.split();
        let [low, high] = [low, high].map(|rank| rank.simd_lt(LANES as i16));
        let numbers = &self.columns[NUMBER][run.at..][..SIXTEEN];
        let eights = [0, LANES].map(|at| i16x8::from_slice(simd, &numbers[at..][..LANES]));
        let finished = &mut self.finished[run.start..][..SIXTEEN + LANES];
        let mut count = 0;
        // The next store overwrites the lanes behind the chosen rows.
        for (eight, is_wanted) in [(eights[0], low), (eights[1], high), (eights[0], !low), (eights[1], !high)] {
            eight.compress(is_wanted).store_slice(&mut finished[count..][..LANES]);
            count += is_wanted.to_bitmask().count_ones() as usize;
        }
    }

    /// Returns the indices of the boxes of the finished rows, in their final order.
    pub(super) fn finished(&self) -> &[i16] {
        &self.finished[..]
    }

    /// Splits up to 64 rows by their ranks.
    #[inline(always)]
    fn part_few<const SIXTEENS: usize, S: Simd>(&mut self, simd: S, run: Run, low: usize) {
        let ranks: [i16x16<S>; SIXTEENS] = self.ranks(simd, run);
        let mut parting = Parting::of(run, low);
        for rank in ranks {
            let (rank, next) = rank.split();
            for rank in [rank, next] {
                if parting.at < run.at + run.len {
                    parting.put::<i16x8<S>, S>(simd, &mut self.columns, rank.simd_lt(low as i16));
                }
            }
        }
    }

    /// Splits more rows by counting. Whole vectors are stored, so a store may write past the end of
    /// a part. It reaches no other run: a part of at least [`MAX_TOGETHER`] rows has as many free
    /// slots behind it, and behind a smaller part lies no run.
    #[inline(always)]
    fn part_many<S: Simd>(&mut self, simd: S, run: Run, low: usize) {
        let (axis, reach) = self.widest::<MAX_TOGETHER, S>(simd, run);
        let (from, to, below) = median(simd, self.along(axis, run), reach, low, run.len);
        let cut = Cut { axis, from, to, wanted: (low - below) as u32 };
        Parting::of(run, low).put_all(simd, &mut self.columns, run.at + run.len, cut);
    }

    /// Returns the rank of each row along the longest axis of their box. Rows with the same
    /// coordinate are ranked by their slot. Slots without a row get the number of rows.
    #[inline(always)]
    fn ranks<const SIXTEENS: usize, S: Simd>(&mut self, simd: S, run: Run) -> [i16x16<S>; SIXTEENS] {
        const PLACES: [i16; MAX_RANKED] = {
            let mut places = [0; MAX_RANKED];
            let mut place = 1;
            while place < MAX_RANKED {
                places[place] = place as i16;
                place += 1;
            }
            places
        };
        let (axis, [least, greatest]) = self.widest::<SIXTEEN, S>(simd, run);
        let along = &self.columns[axis][run.at..][..SIXTEENS * SIXTEEN];
        // The keys differ: the lowest bits hold the place, and the upper bits as much of the
        // coordinate as fits.
        let shift = (greatest - least).leading_zeros() - 1;
        let mut keys = [BEYOND; MAX_RANKED];
        let mut each = [i16x16::splat(simd, 0); SIXTEENS];
        for sixteen in 0..SIXTEENS {
            let along = i16x16::from_slice(simd, &along[sixteen * SIXTEEN..][..SIXTEEN]);
            let place = i16x16::from_slice(simd, &PLACES[sixteen * SIXTEEN..][..SIXTEEN]);
            let key = ((along - least) << shift) & !(MAX_RANKED as i16 - 1) | place;
            key.store_slice(&mut keys[sixteen * SIXTEEN..][..SIXTEEN]);
        }
        keys[run.len..].fill(BEYOND);
        for sixteen in 0..SIXTEENS {
            each[sixteen] = i16x16::from_slice(simd, &keys[sixteen * SIXTEEN..][..SIXTEEN]);
        }
        let mut ranks = [i16x16::splat(simd, 0); SIXTEENS];
        for key in &keys[..SIXTEENS * SIXTEEN] {
            let key = i16x16::splat(simd, *key);
            for sixteen in 0..SIXTEENS {
                ranks[sixteen] -= key.simd_lt(each[sixteen]).to_vector();
            }
        }
        ranks
    }

    /// Returns the coordinates of a run along an axis, rounded up to whole vectors.
    #[inline(always)]
    fn along(&self, axis: usize, run: Run) -> &[i16] {
        &self.columns[axis][run.at..][..run.len.next_multiple_of(SIXTEEN)]
    }

    /// Returns the axis along which rows spread most, and their minimum and maximum there. Fills
    /// the slots behind the rows with [`BEYOND`], up to a multiple of `TOGETHER`.
    #[inline(always)]
    fn widest<const TOGETHER: usize, S: Simd>(&mut self, simd: S, run: Run) -> (usize, [i16; 2]) {
        let mut widest = (0, [0, -1]);
        for axis in 0..3 {
            let column = &mut self.columns[axis][run.at..][..run.len.next_multiple_of(TOGETHER)];
            column[run.len..].fill(BEYOND);
            let (mut least, mut after) = (i16x16::splat(simd, BEYOND), i16x16::splat(simd, i16::MIN));
            for sixteen in column.as_chunks::<SIXTEEN>().0 {
                let sixteen = i16x16::from_slice(simd, sixteen);
                least = least.min(sixteen);
                // The addition wraps `BEYOND` around to the minimum.
                after = after.max(sixteen + 1);
            }
            let [least, greatest] = [least.reduce_min(), after.reduce_max() - 1];
            let is_wider = greatest - least > widest.1[1] - widest.1[0];
            widest = if is_wider { (axis, [least, greatest]) } else { widest };
        }
        widest
    }
}

/// Returns the number of coordinates below `pivot`.
#[inline(always)]
fn count_below<S: Simd>(simd: S, along: &[i16], pivot: i16) -> usize {
    let mut counts = i16x16::splat(simd, 0);
    for sixteen in along.as_chunks::<SIXTEEN>().0 {
        counts -= i16x16::from_slice(simd, sixteen).simd_lt(pivot).to_vector();
    }
    counts.reduce_sum() as usize
}

/// Returns an interval `from..to` that holds few of the `len` coordinates, and the number of
/// coordinates below `from`. At most `low` are below `from`, and more than `low` below `to`. If
/// exactly `low` are below `from`, then `to` does not matter.
#[inline(always)]
fn median<S: Simd>(simd: S, along: &[i16], [least, greatest]: [i16; 2], low: usize, len: usize) -> (i16, i16, usize) {
    /// The interval may hold this part of the coordinates, 1/64. They are split by their order
    /// alone, which does not measurably loosen the boxes.
    const SHARE: usize = 64;
    let (mut from, mut to) = (least, greatest + 1);
    let (mut below, mut before) = (0, len);
    while to - from > 1 && below != low && (before - below) * SHARE > len {
        let middle = from + (to - from) / 2;
        let count = count_below(simd, along, middle);
        let is_low = count <= low;
        from = if is_low { middle } else { from };
        below = if is_low { count } else { below };
        to = if is_low { to } else { middle };
        before = if is_low { before } else { count };
    }
    (from, to, below)
}

/// Returns the minimum and the maximum of twice the centers, each with an arbitrary fourth lane.
#[inline(always)]
fn reach<S: Simd>(simd: S, centers: &[Center]) -> (f32x4<S>, f32x4<S>) {
    let (pairs, last) = centers.as_chunks::<2>();
    let first = centers[0].lanes(simd);
    let (mut min, mut max) = (first.combine(first), first.combine(first));
    for pair in pairs {
        let pair = f32x8::from_slice(simd, bytemuck::cast_ref::<[Center; 2], [f32; 8]>(pair));
        min = min.min(pair);
        max = max.max(pair);
    }
    let ((low_min, high_min), (low_max, high_max)) = (min.split(), max.split());
    let (mut min, mut max) = (low_min.min(high_min), low_max.max(high_max));
    for center in last {
        let center = center.lanes(simd);
        min = min.min(center);
        max = max.max(center);
    }
    (min, max)
}

#[cfg(test)]
mod tests;
