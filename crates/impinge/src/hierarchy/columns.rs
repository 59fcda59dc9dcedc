//! The boxes of a cluster while it is halved: their centres as small integers, in columns that are read by whole vectors.
//!
//! Each run of rows has room for two, in which it is parted (see [`parting`]).

mod layout;
mod parting;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, i16x8, i16x16, i32x8};

use super::boxes::{Centre, lanes_of_eight};
use crate::simd::{LANES, by_axis, transposed};
pub(super) use layout::{MOST, PLANES, Run};
use layout::{MOST_TOGETHER, NUMBER, ROOM, SIXTEEN, WIDTH};
use parting::{Cut, Parting};

/// A coordinate beyond all others, where there is no row.
const BEYOND: i16 = i16::MAX;

/// The greatest coordinate.
const LAST: f32 = (BEYOND - 1) as f32;

/// So many rows are put in order by comparing each with each.
const FEW: usize = 64;

/// The rows of one cluster after another.
pub(super) struct Columns {
    columns: Box<[[i16; ROOM]; WIDTH]>,
    finished: Box<[i16; MOST + 2 * SIXTEEN]>,
}

impl Default for Columns {
    fn default() -> Self {
        Self { columns: bytemuck::allocation::zeroed_box(), finished: bytemuck::allocation::zeroed_box() }
    }
}

impl Columns {
    /// Writes the rows of these centres, of which there is one at least. Where they coincide or reach too far, all of them are in one
    /// place.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, centres: &[Centre]) {
        let (min, max) = reach(simd, centres);
        let extent = max - min;
        let scale = LAST / extent[0].max(extent[1]).max(extent[2]);
        let is_cube = scale.is_finite() && (extent[0] + extent[1] + extent[2]).is_finite();
        let cells = is_cube.then_some((min, scale));
        let (eights, rest) = centres.as_chunks::<LANES>();
        for (first, eight) in (0..).step_by(LANES).zip(eights) {
            self.set_eight(simd, first, eight, cells);
        }
        if let Some(last) = rest.last() {
            let mut eight = [*last; LANES];
            eight[..rest.len()].copy_from_slice(rest);
            self.set_eight(simd, centres.len() - rest.len(), &eight, cells);
        }
    }

    /// `cells` are the least corner of their cube, and how many there are for each unit of length.
    #[inline(always)]
    fn set_eight<S: Simd>(&mut self, simd: S, first: usize, eight: &[Centre; LANES], cells: Option<(f32x4<S>, f32)>) {
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

    /// Parts rows by a plane through the middle of the box about them, across the axis along which they spread most; `None` where all are
    /// in one place, or enough planes were above.
    #[inline(always)]
    pub(super) fn part_by_plane<S: Simd>(&mut self, simd: S, run: Run) -> Option<(Run, Run)> {
        let planes = run.planes.checked_sub(1)?;
        let (axis, [least, greatest]) = self.widest::<MOST_TOGETHER, S>(simd, run);
        let pivot = least + (greatest - least) / 2 + 1;
        if pivot > greatest {
            return None;
        }
        let low = count_below(simd, self.along(axis, run), pivot);
        // The larger part stays, so that the other lies behind what is still to be read.
        let larger = low.max(run.len - low);
        let behind = run.at + 2 * larger + (MOST_TOGETHER << planes);
        let (low_at, high_at) = if low == larger { (run.at, behind) } else { (behind, run.at) };
        let parting = Parting { at: run.at, low: low_at, high: high_at };
        let cut = Cut { axis, from: pivot, to: pivot, wanted: 0 };
        parting.put_all(simd, &mut self.columns, run.at + run.len, cut);
        Some((Run { len: low, at: low_at, planes, ..run }, run.high(low, high_at, planes)))
    }

    /// Parts more than sixteen rows: the `low` ones that come first along the axis along which they spread most stay in the first half of
    /// their room, the others go where the other part lies, either in the order in which they are. `low` is a multiple of eight,
    /// and half of them at least.
    #[inline(always)]
    pub(super) fn part<S: Simd>(&mut self, simd: S, run: Run, low: usize) -> (Run, Run) {
        if run.len <= 2 * SIXTEEN {
            self.part_few::<2, S>(simd, run, low);
        } else if run.len <= FEW {
            self.part_few::<4, S>(simd, run, low);
        } else {
            self.part_many(simd, run, low);
        }
        run.split(low)
    }

    /// Is done with up to sixteen rows: the eight that come first along the axis along which they spread most, then the others,
    /// either in the order in which they are.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(&mut self, simd: S, run: Run) {
        let [rank] = self.ranks(simd, run);
        let (low, high) = rank.split();
        let [low, high] = [low, high].map(|rank| rank.simd_lt(LANES as i16));
        let numbers = &self.columns[NUMBER][run.at..][..SIXTEEN];
        let eights = [0, LANES].map(|at| i16x8::from_slice(simd, &numbers[at..][..LANES]));
        let finished = &mut self.finished[run.start..][..SIXTEEN + LANES];
        let mut count = 0;
        // What follows those that are wanted is overwritten by the next.
        for (eight, is_wanted) in [(eights[0], low), (eights[1], high), (eights[0], !low), (eights[1], !high)] {
            eight.compress(is_wanted).store_slice(&mut finished[count..][..LANES]);
            count += is_wanted.to_bitmask().count_ones() as usize;
        }
    }

    /// The numbers of the rows that it is done with, by their places.
    pub(super) fn finished(&self) -> &[i16] {
        &self.finished[..]
    }

    /// Of up to sixty-four rows.
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

    /// Of more. Either part has [`MOST_TOGETHER`] rows at least, or nothing of another run lies behind it: as it has room for twice as
    /// many, and a vector more at the end, whole vectors disturb nobody.
    #[inline(always)]
    fn part_many<S: Simd>(&mut self, simd: S, run: Run, low: usize) {
        let (axis, reach) = self.widest::<MOST_TOGETHER, S>(simd, run);
        let (from, to, below) = median(simd, self.along(axis, run), reach, low, run.len);
        let cut = Cut { axis, from, to, wanted: (low - below) as u32 };
        Parting::of(run, low).put_all(simd, &mut self.columns, run.at + run.len, cut);
    }

    /// How many rows come before each of so many sixteens along the axis along which they spread most, those in one place in the order
    /// in which they are; more than there are rows, where there is none.
    #[inline(always)]
    fn ranks<const SIXTEENS: usize, S: Simd>(&mut self, simd: S, run: Run) -> [i16x16<S>; SIXTEENS] {
        const PLACES: [i16; FEW] = {
            let mut places = [0; FEW];
            let mut place = 1;
            while place < FEW {
                places[place] = place as i16;
                place += 1;
            }
            places
        };
        let (axis, [least, greatest]) = self.widest::<SIXTEEN, S>(simd, run);
        let along = &self.columns[axis][run.at..][..SIXTEENS * SIXTEEN];
        // No two are alike: the place in the lowest bits, and before it as much as there is room for.
        let shift = (greatest - least).leading_zeros() - 1;
        let mut keys = [BEYOND; FEW];
        let mut each = [i16x16::splat(simd, 0); SIXTEENS];
        for sixteen in 0..SIXTEENS {
            let along = i16x16::from_slice(simd, &along[sixteen * SIXTEEN..][..SIXTEEN]);
            let place = i16x16::from_slice(simd, &PLACES[sixteen * SIXTEEN..][..SIXTEEN]);
            let key = ((along - least) << shift) & !(FEW as i16 - 1) | place;
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

    /// Whole vectors of coordinates.
    #[inline(always)]
    fn along(&self, axis: usize, run: Run) -> &[i16] {
        &self.columns[axis][run.at..][..run.len.next_multiple_of(SIXTEEN)]
    }

    /// The axis along which rows spread most, and the least and the greatest of their coordinates; marks what comes after them, where
    /// so many are taken together.
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
                // What is beyond comes round and is the least.
                after = after.max(sixteen + 1);
            }
            let [least, greatest] = [least.reduce_min(), after.reduce_max() - 1];
            let is_wider = greatest - least > widest.1[1] - widest.1[0];
            widest = if is_wider { (axis, [least, greatest]) } else { widest };
        }
        widest
    }
}

#[inline(always)]
fn count_below<S: Simd>(simd: S, along: &[i16], pivot: i16) -> usize {
    let mut counts = i16x16::splat(simd, 0);
    for sixteen in along.as_chunks::<SIXTEEN>().0 {
        counts -= i16x16::from_slice(simd, sixteen).simd_lt(pivot).to_vector();
    }
    counts.reduce_sum() as usize
}

/// An interval such that at most `low` of `len` numbers are below it and more than as many below its end, and how many are below it:
/// so short that few are in it. Where `low` are below it, nobody looks at the end.
#[inline(always)]
fn median<S: Simd>(simd: S, along: &[i16], [least, greatest]: [i16; 2], low: usize, len: usize) -> (i16, i16, usize) {
    /// This part of them is few: told apart by their order alone, which costs no tightness that can be measured.
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

/// Twice the least and the greatest of the centres, and any fourth lanes.
#[inline(always)]
fn reach<S: Simd>(simd: S, centres: &[Centre]) -> (f32x4<S>, f32x4<S>) {
    let (pairs, last) = centres.as_chunks::<2>();
    let first = centres[0].lanes(simd);
    let (mut min, mut max) = (first.combine(first), first.combine(first));
    for pair in pairs {
        let pair = f32x8::from_slice(simd, bytemuck::cast_ref::<[Centre; 2], [f32; 8]>(pair));
        min = min.min(pair);
        max = max.max(pair);
    }
    let ((low_min, high_min), (low_max, high_max)) = (min.split(), max.split());
    let (mut min, mut max) = (low_min.min(high_min), low_max.max(high_max));
    for centre in last {
        let centre = centre.lanes(simd);
        min = min.min(centre);
        max = max.max(centre);
    }
    (min, max)
}

#[cfg(test)]
mod tests;
