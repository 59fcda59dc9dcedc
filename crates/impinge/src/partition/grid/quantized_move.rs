//! Finds the quantized boxes that a moving box may begin or cease to overlap.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u8x32, u16x16, u64x4};

use super::lines::LINE_CAPACITY;
use super::move_batch::BATCH;
use super::quantization::quantized_step;
use super::quantized_box::{AXIS, CELL_KEY, QuantizedBox, cell_key, steps};

/// A moving box relative to a cell, for finding the boxes that it may begin or cease to overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct QuantizedMove([u64; KINDS]);

/// Number of words of [`QuantizedMove`]. `AFTER` is the moved box. `LOWER` and `UPPER` bound the
/// bytes of boxes found in this cell that may overlap it before or after the move.
const KINDS: usize = 4;
/// Index of the word of the box after the move.
const AFTER: usize = 0;
/// Index of the lower bounds for the bytes of boxes that may overlap before or after the move.
const LOWER: usize = 1;
/// Index of the upper bounds for the bytes of boxes that may overlap before or after the move.
const UPPER: usize = 2;
/// Index of the upper bounds for the bytes of boxes that certainly overlap before and after the
/// move.
const WITHIN: usize = 3;

impl QuantizedMove {
    /// Returns the words of one axis for a batch of moves, relative to the `nth` cell of each path.
    ///
    /// `parts` has the ends of each box before and after the move, in 1/256 of a cell. They are
    /// measured from the beginning of cell `low`, the first cell around the path. At least one of
    /// the ends must lie in the `nth` cell or behind it. Boxes that begin before a cell are found
    /// in another cell, unless the cell is the first along the axis.
    #[inline(always)]
    pub(super) fn along<S: Simd>(
        simd: S,
        axis: usize,
        parts: &[[i16; BATCH]; 4],
        low: &[i64; BATCH],
        nth: usize,
    ) -> [Self; BATCH] {
        let (mut slices, mut cell_keys) = ([[0; BATCH]; KINDS], [[0; BATCH]; KINDS]);
        for lane in 0..BATCH {
            let step = |end: usize| quantized_step(parts[end][lane], nth) as u16;
            let ([begin, end], [next_begin, next_end]) = ([step(0), step(1)], [step(2), step(3)]);
            slices[AFTER][lane] = steps(next_begin, 255 - next_end);
            slices[LOWER][lane] = nth.min(1) as u16;
            slices[UPPER][lane] = steps(end.max(next_end), 255 - begin.min(next_begin));
            // The largest bytes of a box that overlaps before and after the move, inverted because
            // `all` inverts this word. If no such box exists, all key bits are set; inverted they
            // are zero, which is no cell's key.
            let (first, second) = (end.min(next_end), 255 - begin.max(next_begin));
            slices[WITHIN][lane] = !steps(first.wrapping_sub(1), second.wrapping_sub(1));
            cell_keys[WITHIN][lane] = if (first == 0) | (second == 0) { u16::MAX } else { 0 };
        }
        for lane in 0..BATCH {
            let cell_key = cell_key(axis, low[lane] + nth as i64);
            (cell_keys[AFTER][lane], cell_keys[LOWER][lane], cell_keys[UPPER][lane]) = (cell_key, cell_key, cell_key);
        }
        let mut seen = [Self::default(); BATCH];
        let quarters = interleaved(simd, &slices).into_iter().zip(interleaved(simd, &cell_keys));
        for (seen, (slices, cell_keys)) in seen.chunks_exact_mut(BATCH / 4).zip(quarters) {
            let (slices, cell_keys) = (slices.widen(), cell_keys.widen());
            for (seen, (slices, cell_keys)) in
                seen.chunks_exact_mut(2).zip([(slices.0, cell_keys.0), (slices.1, cell_keys.1)])
            {
                let (slices, cell_keys) = (slices.widen(), cell_keys.widen());
                for (seen, (slice, cell_key)) in seen.iter_mut().zip([(slices.0, cell_keys.0), (slices.1, cell_keys.1)])
                {
                    ((slice << (AXIS * axis as u32)) | (cell_key << CELL_KEY)).store_slice(&mut seen.0);
                }
            }
        }
        seen
    }

    /// Loads the words into lanes.
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> u64x4<S> {
        u64x4::from_slice(simd, &self.0)
    }

    /// Combines the parts of three axes, given the union of their bits, and inverts the last word.
    #[inline(always)]
    pub(super) fn all<S: Simd>(simd: S, any: u64x4<S>) -> Self {
        let mut boxes = [0; KINDS];
        (any ^ u64x4::from_slice(simd, &[0, 0, 0, u64::MAX])).store_slice(&mut boxes);
        Self(boxes)
    }

    /// Returns the box after the move.
    #[inline(always)]
    pub(super) fn after(&self) -> QuantizedBox {
        QuantizedBox(self.0[AFTER])
    }

    /// Returns one bit for each box of a line: set if it may begin or cease to overlap the moving
    /// box.
    #[inline(always)]
    pub(super) fn compare<S: Simd>(&self, simd: S, boxes: &[QuantizedBox; LINE_CAPACITY]) -> u32 {
        let bytes = |kind: usize| u64x4::splat(simd, self.0[kind]).bitcast::<u8x32<S>>();
        let (least, most, within) = (bytes(LOWER), bytes(UPPER), bytes(WITHIN));
        let [one, two, three, four, five] = boxes.map(|quantized| quantized.0);
        let mut undecided = 0;
        // An empty place has no cell key, so it is never near.
        for (boxes, shift) in [([one, two, three, four], 0), ([five, 0, 0, 0], 4)] {
            let boxes = u64x4::from_slice(simd, &boxes);
            let bytes = boxes.bitcast::<u8x32<S>>();
            let is_near = bytes.max(least).min(most).bitcast::<u64x4<S>>().simd_eq(boxes);
            let overlaps = bytes.min(within).bitcast::<u64x4<S>>().simd_eq(boxes);
            undecided |= (is_near & !overlaps).to_bitmask() << shift;
        }
        undecided as u32
    }
}

/// Interleaves the words: returns all kinds of one lane next to each other, four lanes per vector.
#[inline(always)]
fn interleaved<S: Simd>(simd: S, kinds: &[[u16; BATCH]; KINDS]) -> [u16x16<S>; 4] {
    let [one, two, three, four] = kinds;
    let even = u16x16::from_slice(simd, one).interleave(u16x16::from_slice(simd, three));
    let odd = u16x16::from_slice(simd, two).interleave(u16x16::from_slice(simd, four));
    let (low, high) = (even.0.interleave(odd.0), even.1.interleave(odd.1));
    [low.0, low.1, high.0, high.1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::partition::grid::quantized_box::tests::{draw, quantized};
    use crate::simd::dispatch_every;
    use fearless_simd::Level;
    use impinge_testkit::generate::Rng;

    /// Returns parts of a cell. Many lie near one of the ends of the `nth` cell.
    fn draw_parts(rng: &mut Rng, nth: usize) -> [i16; 2] {
        let about = 256 * nth as i64 + rng.choose(&[0, 256]);
        let [one, other] = [0; 2].map(|_: i32| match rng.integer(0, 1) {
            0 => rng.integer(0, 1023) as i16,
            _ => rng.integer((about - 2).max(0), (about + 2).min(1023)) as i16,
        });
        [one.min(other), one.max(other)]
    }

    #[test]
    fn compare_agrees_with_comparing_steps_one_by_one() {
        let mut rng = Rng::new(93);
        let (mut undecided, mut decided) = (0, 0);
        for _ in 0..4_000 {
            let nth = [0; 3].map(|_: i32| rng.integer(0, 3) as usize);
            let (mut parts, mut low) = ([[[0; BATCH]; 4]; 3], [[0; BATCH]; 3]);
            for (axis, lane) in (0..3).flat_map(|axis| (0..BATCH).map(move |lane| (axis, lane))) {
                let ends = [draw_parts(&mut rng, nth[axis]), draw_parts(&mut rng, nth[axis])];
                ends.as_flattened().iter().zip(&mut parts[axis]).for_each(|(&end, parts)| parts[lane] = end);
                low[axis][lane] = rng.integer(-20, 20);
            }
            let [seen, others_seen] = [Level::fallback(), crate::simd::best_level()].map(|level| {
                dispatch_every!(level, simd => {
                    let along = [0, 1, 2].map(|axis| QuantizedMove::along(simd, axis, &parts[axis], &low[axis], nth[axis]));
                    std::array::from_fn::<QuantizedMove, BATCH, _>(|lane| {
                        let [x, y, z] = along.each_ref().map(|seen| seen[lane].lanes(simd));
                        QuantizedMove::all(simd, x | y | z)
                    })
                })
            });
            assert_eq!(seen, others_seen);
            for (lane, seen) in seen.into_iter().enumerate() {
                let cell = [0, 1, 2].map(|axis| low[axis][lane] + nth[axis] as i64);
                let step = |axis: usize, end: usize| quantized_step(parts[axis][end][lane], nth[axis]) as u8;
                let [from, to] =
                    [0, 2].map(|begin| [begin, begin + 1].map(|end| [0, 1, 2].map(|axis| step(axis, end))));
                if (0..3).any(|k| from[1][k].max(to[1][k]) == 0) {
                    continue;
                }
                assert_eq!(seen.after(), quantized(to, cell));
                let others = [0; LINE_CAPACITY].map(|_: i32| draw(&mut rng));
                let elsewhere = rng.integer(0, 3 * LINE_CAPACITY as i64) as usize;
                let boxes = std::array::from_fn(|at| match elsewhere {
                    other if other == at => quantized(others[at], [cell[0], cell[1] + 1, cell[2]]),
                    other if other == at + LINE_CAPACITY => QuantizedBox::NONE,
                    _ => quantized(others[at], cell),
                });
                let expected = (0..LINE_CAPACITY).filter(|&at| {
                    let other = others[at];
                    let axes = || (0..3).flat_map(|k| [(other[0][k], k, 1), (other[1][k], k, 0)]);
                    let least = |k: usize, end: usize| [from[end][k], to[end][k]].into_iter().min();
                    let most = |k: usize, end: usize| [from[end][k], to[end][k]].into_iter().max();
                    let is_near =
                        axes().all(
                            |(step, k, end)| {
                                if end == 1 { Some(step) <= most(k, 1) } else { Some(step) >= least(k, 0) }
                            },
                        );
                    let overlaps =
                        axes().all(
                            |(step, k, end)| {
                                if end == 1 { Some(step) < least(k, 1) } else { Some(step) > most(k, 0) }
                            },
                        );
                    let is_here = (0..3).all(|k| nth[k] == 0 || other[0][k] > 0);
                    elsewhere != at && elsewhere != at + LINE_CAPACITY && is_near && !overlaps && is_here
                });
                let expected = expected.fold(0, |bits, at| bits | 1 << at);
                for level in [Level::fallback(), crate::simd::best_level()] {
                    let undecided = dispatch_every!(level, simd => seen.compare(simd, &boxes));
                    assert_eq!(undecided, expected, "{level:?}: {seen:?}, {boxes:?}");
                }
                undecided += expected.count_ones();
                decided += LINE_CAPACITY as u32 - expected.count_ones();
            }
        }
        assert!(undecided > 10_000 && decided > 100_000, "{undecided} undecided, {decided} decided");
    }
}
