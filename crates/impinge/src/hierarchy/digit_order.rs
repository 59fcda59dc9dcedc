//! A lazy radix sort of boxes along a Morton curve, from the leading digit of their codes on.
//!
//! Source: Knuth, *The Art of Computer Programming* 3, 5.2.5. Ours sorts a range by its next digit
//! when a builder reaches it, and finishes that range before the next. So the sorted range is in
//! the cache, and small ranges are never sorted.

use std::slice::IterMut;
use std::sync::Arc;

use bytemuck::Zeroable;
use fearless_simd::Simd;
use rayon::prelude::*;

use super::boxes::{Boxes, Center, lanes_of_eight};
use super::curve::{Curve, DIGITS, Eight, LEADING};
use super::radix::add_up;
use crate::simd::{LANES, dispatch_widest, widest_level};
use crate::volume::Aabb;

/// The order of a range of centers: all are in one cell of a curve, and they are sorted by their
/// digit `place`.
#[derive(Clone, Debug)]
pub(super) struct DigitOrder {
    curve: Curve,
    /// Index of the digit by which the range is sorted.
    place: u32,
    /// For each digit the end of its centers, counted from the start of the range that was sorted.
    ends: Arc<[u32; DIGITS]>,
    /// The first and the last digit that occurs in the range.
    first: usize,
    last: usize,
}

impl DigitOrder {
    /// Writes the centers of all boxes, sorted by their leading digit along a curve over all of
    /// them. There must be at least one box. Each thread sorts a share.
    pub(super) fn of<B: Boxes + ?Sized>(boxes: &B, centers: &mut [Center]) -> Self {
        let curve = Curve::over(&boxes.twice_reach()).unwrap_or(Curve::ONE_CELL);
        let share = centers.len().div_ceil(rayon::current_num_threads());
        let shares: Vec<_> = (0..centers.len()).step_by(share).map(|at| at..centers.len().min(at + share)).collect();
        let counts: Vec<[u32; DIGITS]> = shares
            .par_iter()
            .map(|share| {
                let mut counts = [0; DIGITS];
                dispatch_widest!(widest_level(), simd => curve.for_each_eight(
                    simd,
                    LEADING,
                    share.clone(),
                    #[inline(always)]
                    |first| boxes.eight(simd, first),
                    #[inline(always)]
                    |eight| count(&mut counts, eight),
                ));
                counts
            })
            .collect();
        let mut places: Vec<Vec<IterMut<'_, Center>>> = counts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
        let (mut left, mut ends, mut end) = (centers, [0; DIGITS], 0);
        for digit in 0..DIGITS {
            for (counts, places) in counts.iter().zip(&mut places) {
                let (place, after) = left.split_at_mut(counts[digit] as usize);
                places.push(place.iter_mut());
                (left, end) = (after, end + counts[digit]);
            }
            ends[digit] = end;
        }
        shares.into_par_iter().zip(places).for_each(|(share, mut places)| {
            dispatch_widest!(widest_level(), simd => curve.for_each_eight(
                simd,
                LEADING,
                share,
                #[inline(always)]
                |first| boxes.eight(simd, first),
                #[inline(always)]
                |eight| {
                    if eight.is_same {
                        // A local iterator cannot alias the centers, so it stays in registers.
                        let mut place = std::mem::take(&mut places[eight.digit(0)]);
                        for lane in 0..LANES {
                            put(&mut place, eight, lane);
                        }
                        places[eight.digit(0)] = place;
                    } else {
                        for lane in 0..eight.count {
                            put(&mut places[eight.digit(lane)], eight, lane);
                        }
                    }
                },
            ));
        });
        Self::with_ends(curve, LEADING, ends)
    }

    fn with_ends(curve: Curve, place: u32, ends: [u32; DIGITS]) -> Self {
        let (mut first, mut last) = (0, DIGITS - 1);
        while first < last && ends[first] == 0 {
            first += 1;
        }
        while first < last && ends[last] == ends[last - 1] {
            last -= 1;
        }
        Self { curve, place, ends: Arc::new(ends), first, last }
    }

    /// Sorts a range that lies in one cell by its next digit, until it lies in several cells. If
    /// the digits run out, it continues along a new curve over the range. Returns `None` if all
    /// centers coincide, or if their extent is too large for a curve.
    pub(super) fn refined(mut self, centers: &mut [Center], spare: &mut Vec<Center>) -> Option<Self> {
        while self.first == self.last {
            if let Some(place) = self.place.checked_sub(1) {
                self = Self::sorted_by(self.curve, place, centers, spare);
                continue;
            }
            let bounds = centers
                .iter()
                .fold(Aabb::EMPTY, |bounds, &Center { twice, .. }| bounds.union(Aabb { min: twice, max: twice }));
            let own = Self::sorted_by(Curve::over(&bounds)?, LEADING, centers, spare);
            return (own.first < own.last).then_some(own);
        }
        Some(self)
    }

    /// Sorts the centers by a digit. Centers with the same digit keep their order.
    fn sorted_by(curve: Curve, place: u32, centers: &mut [Center], spare: &mut Vec<Center>) -> Self {
        spare.clear();
        spare.extend_from_slice(centers);
        // Eight centers are read at a time.
        spare.extend([Center::zeroed(); LANES]);
        let (all, mut next) = (0..centers.len(), [0; DIGITS]);
        dispatch_widest!(widest_level(), simd => {
            curve.for_each_eight(
                simd,
                place,
                all.clone(),
                #[inline(always)]
                |first| lanes_of_eight(simd, &spare[first..]),
                #[inline(always)]
                |eight| count(&mut next, eight),
            );
            add_up(&mut next);
            curve.for_each_eight(
                simd,
                place,
                all,
                #[inline(always)]
                |first| lanes_of_eight(simd, &spare[first..]),
                #[inline(always)]
                |eight| {
                    let from = &spare[eight.first..][..eight.count];
                    if eight.is_same {
                        let next = &mut next[eight.digit(0)];
                        centers[*next as usize..][..LANES].copy_from_slice(from);
                        *next += LANES as u32;
                        return;
                    }
                    for (lane, center) in from.iter().enumerate() {
                        let next = &mut next[eight.digit(lane)];
                        centers[*next as usize] = *center;
                        *next += 1;
                    }
                },
            );
        });
        Self::with_ends(curve, place, next)
    }

    /// Splits a range at a boundary of the curve's cells. Returns the number of centers in the
    /// first part, and the order of both parts. The range must lie in several cells.
    pub(super) fn split(self) -> (usize, Self, Self) {
        let ends = &self.ends;
        let top_bit = 1 << (self.first ^ self.last).ilog2();
        let boundary = self.last & !(top_bit - 1);
        let middle = ends[boundary - 1];
        let start = if self.first == 0 { 0 } else { ends[self.first - 1] };
        let is_there = |digit: &usize| ends[*digit] > ends[digit - 1];
        let last = (self.first + 1..boundary).rev().find(is_there).unwrap_or(self.first);
        let first = (boundary..self.last).find(is_there).unwrap_or(self.last);
        let low = Self { last, ..self.clone() };
        ((middle - start) as usize, low, Self { first, ..self })
    }
}

/// Writes one of eight centers at the next slot of its digit.
#[inline(always)]
fn put<S: Simd>(place: &mut IterMut<'_, Center>, eight: &Eight<S>, lane: usize) {
    if let Some(center) = place.next() {
        center.set(eight.twice(lane), (eight.first + lane) as u32);
    }
}

/// Counts eight digits. If neighbors have the same digit, eight single increments would wait for
/// each other.
#[inline(always)]
fn count<S: Simd>(counts: &mut [u32; DIGITS], eight: &Eight<S>) {
    if eight.is_same {
        counts[eight.digit(0)] += LANES as u32;
    } else {
        for lane in 0..eight.count {
            counts[eight.digit(lane)] += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    /// Splits a range down to single cells and returns the number of splits.
    fn split_all(digits: DigitOrder, centers: &mut [Center], spare: &mut Vec<Center>) -> usize {
        if centers.len() < 2 {
            return 0;
        }
        let Some(digits) = digits.refined(centers, spare) else { return 0 };
        let (middle, low, high) = digits.split();
        let (low_centers, high_centers) = centers.split_at_mut(middle);
        assert!(!low_centers.is_empty() && !high_centers.is_empty());
        1 + split_all(low, low_centers, spare) + split_all(high, high_centers, spare)
    }

    #[test]
    fn boxes_split_down_to_cells_lie_along_the_curve() {
        let mut rng = Rng::new(143);
        let mut shared = 0;
        for (len, spread) in [(1, 1), (2, 1), (300, 3), (5_000, 4), (5_000, 1_024), (20_000, 40), (70_000, 100_000)] {
            // In the middle of cells, on the borders between two, and crowded in a corner of a
            // large cube.
            let mut boxes: Vec<Aabb> = (0..len)
                .map(|_| [0; 3].map(|_| rng.integer(0, spread) as f32))
                .map(|center| Aabb { min: center, max: center })
                .collect();
            boxes.push(Aabb { min: [4_096.0; 3], max: [4_096.0; 3] });
            let [dealt, again] = [1, 3].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                let mut centers = vec![Center::zeroed(); boxes.len()];
                let digits = pool.install(|| DigitOrder::of(&boxes[..], &mut centers));
                (digits, centers)
            });
            assert_eq!(dealt.1, again.1, "the number of threads changes the result");
            let (digits, mut centers) = dealt;
            let curve = digits.curve;
            let splits = split_all(digits, &mut centers, &mut Vec::new());
            let mut numbers: Vec<u32> = centers.iter().map(|center| center.index).collect();
            for pair in centers.windows(2) {
                let [before, after] = [pair[0], pair[1]].map(|center| curve.code(center.twice));
                assert!(before <= after, "{len}, {spread}");
                // Centers that coincide keep their order.
                assert!(pair[0].twice != pair[1].twice || pair[0].index < pair[1].index, "{len}, {spread}");
                shared += usize::from(before == after && pair[0].twice != pair[1].twice);
            }
            let places = centers.chunk_by(|a, b| a.twice == b.twice).count();
            assert_eq!(splits, places - 1, "{len}, {spread}: each place is split from the others");
            numbers.sort_unstable();
            assert!(numbers.iter().enumerate().all(|(at, &number)| at == number as usize), "{len}, {spread}");
        }
        assert!(shared > 100, "{shared}: too few cells needed a curve of their own");
    }
}
