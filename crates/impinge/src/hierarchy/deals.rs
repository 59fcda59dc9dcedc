//! Boxes dealt out along a curve: sorted by one digit of their codes after the other, from the leading one on.
//!
//! Source: Knuth, *The Art of Computer Programming* 3, 5.2.5. Ours deals a range out by the next digit when a builder gets there,
//! and is done with it before the next: so that what is dealt is in the cache, and what few are left is never sorted.

use std::slice::IterMut;
use std::sync::Arc;

use bytemuck::Zeroable;
use fearless_simd::Simd;
use rayon::prelude::*;

use super::boxes::{Boxes, Centre, lanes_of_eight};
use super::curve::{Curve, DIGITS, Eight, LEADING};
use super::radix::add_up;
use crate::simd::{LANES, dispatch_widest, widest_level};
use crate::volume::Aabb;

/// How a range of centres lies on a curve: all of one cell of it, and in the order of their next digit.
#[derive(Clone, Debug)]
pub(super) struct Deals {
    curve: Curve,
    /// Of the digit.
    place: u32,
    /// Where those with each digit end.
    ends: Arc<[u32; DIGITS]>,
    /// The digits that there are, from the first to the last.
    first: usize,
    last: usize,
}

impl Deals {
    /// Writes the centres of all boxes, of which there is one at least, dealt out along a curve. Each thread deals out a share.
    pub(super) fn of<B: Boxes + ?Sized>(boxes: &B, centres: &mut [Centre]) -> Self {
        let curve = Curve::over(&boxes.twice_reach()).unwrap_or(Curve::ONE_CELL);
        let share = centres.len().div_ceil(rayon::current_num_threads());
        let shares: Vec<_> = (0..centres.len()).step_by(share).map(|at| at..centres.len().min(at + share)).collect();
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
        let mut places: Vec<Vec<IterMut<'_, Centre>>> = counts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
        let (mut left, mut ends, mut end) = (centres, [0; DIGITS], 0);
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
                        // At hand, and not where the centres could be for all that is known.
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

    /// Deals out by the next digit what is of one cell until it is of several: along a curve of its own where it is of one cell to
    /// the last digit. `None` where it is in one point, or reaches so far that there is no curve.
    pub(super) fn parted(mut self, centres: &mut [Centre], spare: &mut Vec<Centre>) -> Option<Self> {
        while self.first == self.last {
            if let Some(place) = self.place.checked_sub(1) {
                self = Self::again(self.curve, place, centres, spare);
                continue;
            }
            let bounds = centres
                .iter()
                .fold(Aabb::EMPTY, |bounds, &Centre { twice, .. }| bounds.union(Aabb { min: twice, max: twice }));
            let own = Self::again(Curve::over(&bounds)?, LEADING, centres, spare);
            return (own.first < own.last).then_some(own);
        }
        Some(self)
    }

    /// Deals out by a digit, those with the same one in the order in which they come.
    fn again(curve: Curve, place: u32, centres: &mut [Centre], spare: &mut Vec<Centre>) -> Self {
        spare.clear();
        spare.extend_from_slice(centres);
        // Eight are read at a time.
        spare.extend([Centre::zeroed(); LANES]);
        let (all, mut next) = (0..centres.len(), [0; DIGITS]);
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
                        centres[*next as usize..][..LANES].copy_from_slice(from);
                        *next += LANES as u32;
                        return;
                    }
                    for (lane, centre) in from.iter().enumerate() {
                        let next = &mut next[eight.digit(lane)];
                        centres[*next as usize] = *centre;
                        *next += 1;
                    }
                },
            );
        });
        Self::with_ends(curve, place, next)
    }

    /// Where the cells of the curve split what is of several: how many come before, and how the two parts lie.
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

/// Writes one of them where the next one belongs.
#[inline(always)]
fn put<S: Simd>(place: &mut IterMut<'_, Centre>, eight: &Eight<S>, lane: usize) {
    if let Some(centre) = place.next() {
        centre.set(eight.twice(lane), (eight.first + lane) as u32);
    }
}

/// One after the other, a count would wait for itself where neighbours have the same digit.
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

    /// Splits down to single cells, and counts the splits.
    fn split_all(deals: Deals, centres: &mut [Centre], spare: &mut Vec<Centre>) -> usize {
        if centres.len() < 2 {
            return 0;
        }
        let Some(deals) = deals.parted(centres, spare) else { return 0 };
        let (middle, low, high) = deals.split();
        let (low_centres, high_centres) = centres.split_at_mut(middle);
        assert!(!low_centres.is_empty() && !high_centres.is_empty());
        1 + split_all(low, low_centres, spare) + split_all(high, high_centres, spare)
    }

    #[test]
    fn what_is_split_to_the_end_lies_along_the_curve() {
        let mut rng = Rng::new(143);
        let mut shared = 0;
        for (len, spread) in [(1, 1), (2, 1), (300, 3), (5_000, 4), (5_000, 1_024), (20_000, 40), (70_000, 100_000)] {
            // In the middle of cells, and on the borders between two; a small crowd in a corner of a large cube, too.
            let mut boxes: Vec<Aabb> = (0..len)
                .map(|_| [0; 3].map(|_| rng.integer(0, spread) as f32))
                .map(|centre| Aabb { min: centre, max: centre })
                .collect();
            boxes.push(Aabb { min: [4_096.0; 3], max: [4_096.0; 3] });
            let [dealt, again] = [1, 3].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                let mut centres = vec![Centre::zeroed(); boxes.len()];
                let deals = pool.install(|| Deals::of(&boxes[..], &mut centres));
                (deals, centres)
            });
            assert_eq!(dealt.1, again.1, "threads show");
            let (deals, mut centres) = dealt;
            let curve = deals.curve;
            let splits = split_all(deals, &mut centres, &mut Vec::new());
            let mut numbers: Vec<u32> = centres.iter().map(|centre| centre.index).collect();
            for pair in centres.windows(2) {
                let [before, after] = [pair[0], pair[1]].map(|centre| curve.code(centre.twice));
                assert!(before <= after, "{len}, {spread}");
                // Those in one place stay in the order in which they came.
                assert!(pair[0].twice != pair[1].twice || pair[0].index < pair[1].index, "{len}, {spread}");
                shared += usize::from(before == after && pair[0].twice != pair[1].twice);
            }
            let places = centres.chunk_by(|a, b| a.twice == b.twice).count();
            assert_eq!(splits, places - 1, "{len}, {spread}: each place is parted from the others");
            numbers.sort_unstable();
            assert!(numbers.iter().enumerate().all(|(at, &number)| at == number as usize), "{len}, {spread}");
        }
        assert!(shared > 100, "{shared}: hardly a cell had to have a curve of its own");
    }
}
