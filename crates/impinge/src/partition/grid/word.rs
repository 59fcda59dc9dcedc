//! A box as it is seen from a cell, in a word: small enough that what a cell holds is in a line of memory.

use bytemuck::{Pod, Zeroable};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, u8x32, u16x16, u64x4};

use super::frame::seen_step;
use super::lines::HELD;
use super::together::TOGETHER;

/// Bits of an axis, of two steps; the mark is in as many above all axes.
const AXIS: u32 = 16;
const MARK: u32 = 3 * AXIS;
const ALL: u64 = (1 << MARK) - 1;

/// How far above the first step of an axis is the other one.
const END: u32 = 8;

/// The first step of each axis.
const FIRST: u64 = 0x00ff_00ff_00ff;

/// Where in a mark three bits of the cell along each axis are, and one that is always set. No byte of a mark is full.
const MARKS: [u32; 3] = [0, 3, 8];
const IS_THERE: u16 = 1 << 6;

/// Cells along an axis of which no two have the same mark.
pub(super) const MARKED_APART: i64 = 8;

/// Where a box begins and ends as seen from a cell, in steps along the three axes, and a mark of the cell. The ends are told
/// from behind, so that a larger box has lesser steps throughout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Word(u64);

/// A box that words are compared with: the greatest steps that a box may have that it meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe(u64);

/// What is seen of a box that moves from a cell, for finding what may begin to meet it, or cease to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen([u64; KINDS]);

/// The words of [`Seen`]: the box where it goes; between which bytes are those of what may meet the box at the one place or the
/// other and is to be found in this cell; and up to which are those of what meets it at both.
const KINDS: usize = 4;
const AFTER: usize = 0;
const LEAST: usize = 1;
const MOST: usize = 2;
const WITHIN: usize = 3;

impl Word {
    /// What stands where there is no box.
    pub(super) const NONE: Self = Self(0);

    /// What is told of one axis: where the box begins and ends, from 0, before the cell, to 255, behind it, and the place of the
    /// cell. A word is all three.
    #[inline(always)]
    pub(super) fn along(axis: usize, [begin, end]: [u8; 2], cell: i64) -> Self {
        let steps = u64::from(steps(u16::from(begin), u16::from(u8::MAX - end)));
        Self(steps << (AXIS * axis as u32) | u64::from(mark(axis, cell)) << MARK)
    }

    #[inline]
    pub(super) fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    #[inline]
    pub(super) fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Whether both are seen from the same cell, or from two that look alike.
    #[inline]
    pub(super) fn is_marked_as(self, other: Self) -> bool {
        (self.0 ^ other.0) & !ALL == 0
    }

    /// Whether the box begins before the cell along an axis.
    #[inline]
    pub(super) fn begins_before(self, axis: usize) -> bool {
        self.0 >> (AXIS * axis as u32) & 0xff == 0
    }

    /// The box as others are compared with it.
    #[inline]
    pub(super) fn probe(self) -> Probe {
        let steps = !self.0;
        Probe(!ALL | steps >> END & FIRST | (steps & FIRST) << END)
    }
}

/// Two steps of an axis together.
#[inline(always)]
fn steps(first: u16, second: u16) -> u16 {
    first | second << END
}

#[inline(always)]
fn mark(axis: usize, cell: i64) -> u16 {
    ((cell & (MARKED_APART - 1)) as u16) << MARKS[axis] | IS_THERE
}

impl Probe {
    /// Unless it does, the boxes are apart: steps that are in strict order belong to coordinates in strict order. Only of use for a
    /// word that is seen from the same cell.
    #[inline]
    pub(super) fn may_meet(self, word: Word) -> bool {
        let (most, bytes) = (self.0.to_ne_bytes(), word.0.to_ne_bytes());
        let over: [u8; 8] = std::array::from_fn(|at| bytes[at].saturating_sub(most[at]));
        u64::from_ne_bytes(over) == 0
    }
}

impl Seen {
    /// What is seen along an axis of boxes that come from where the first parts of cells say that they begin and end, and go to
    /// where the others do, all counted from the first cell about the way, `low`; one of the ends is in the `nth` cell or behind
    /// it. Boxes that begin before a cell are found in another one, if it is not the first along the axis.
    #[inline(always)]
    pub(super) fn along<S: Simd>(
        simd: S,
        axis: usize,
        parts: &[[i16; TOGETHER]; 4],
        low: &[i64; TOGETHER],
        nth: usize,
    ) -> [Self; TOGETHER] {
        let (mut slices, mut marks) = ([[0; TOGETHER]; KINDS], [[0; TOGETHER]; KINDS]);
        for lane in 0..TOGETHER {
            let step = |end: usize| seen_step(parts[end][lane], nth) as u16;
            let ([begin, end], [next_begin, next_end]) = ([step(0), step(1)], [step(2), step(3)]);
            slices[AFTER][lane] = steps(next_begin, 255 - next_end);
            slices[LEAST][lane] = nth.min(1) as u16;
            slices[MOST][lane] = steps(end.max(next_end), 255 - begin.min(next_begin));
            // What is not less than both: all bits of the mark where nothing is, as no mark is.
            let (first, second) = (end.min(next_end), 255 - begin.max(next_begin));
            slices[WITHIN][lane] = !steps(first.wrapping_sub(1), second.wrapping_sub(1));
            marks[WITHIN][lane] = if (first == 0) | (second == 0) { u16::MAX } else { 0 };
        }
        for lane in 0..TOGETHER {
            let mark = mark(axis, low[lane] + nth as i64);
            (marks[AFTER][lane], marks[LEAST][lane], marks[MOST][lane]) = (mark, mark, mark);
        }
        let mut seen = [Self::default(); TOGETHER];
        let quarters = interleaved(simd, &slices).into_iter().zip(interleaved(simd, &marks));
        for (seen, (slices, marks)) in seen.chunks_exact_mut(TOGETHER / 4).zip(quarters) {
            let (slices, marks) = (slices.widen(), marks.widen());
            for (seen, (slices, marks)) in seen.chunks_exact_mut(2).zip([(slices.0, marks.0), (slices.1, marks.1)]) {
                let (slices, marks) = (slices.widen(), marks.widen());
                for (seen, (slice, mark)) in seen.iter_mut().zip([(slices.0, marks.0), (slices.1, marks.1)]) {
                    ((slice << (AXIS * axis as u32)) | (mark << MARK)).store_slice(&mut seen.0);
                }
            }
        }
        seen
    }

    /// As many lanes.
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> u64x4<S> {
        u64x4::from_slice(simd, &self.0)
    }

    /// Of three axes together, from what is seen along any of them.
    #[inline(always)]
    pub(super) fn all<S: Simd>(simd: S, any: u64x4<S>) -> Self {
        let mut words = [0; KINDS];
        (any ^ u64x4::from_slice(simd, &[0, 0, 0, u64::MAX])).store_slice(&mut words);
        Self(words)
    }

    /// The box where it goes.
    #[inline(always)]
    pub(super) fn after(&self) -> Word {
        Word(self.0[AFTER])
    }

    /// Which of the boxes of a line may begin to meet the one that moves, or cease to: a bit each.
    #[inline(always)]
    pub(super) fn compare<S: Simd>(&self, simd: S, words: &[Word; HELD]) -> u32 {
        let bytes = |kind: usize| u64x4::splat(simd, self.0[kind]).bitcast::<u8x32<S>>();
        let (least, most, within) = (bytes(LEAST), bytes(MOST), bytes(WITHIN));
        let [one, two, three, four, five] = words.map(|word| word.0);
        let mut open = 0;
        // What is no box has no mark.
        for (words, shift) in [([one, two, three, four], 0), ([five, 0, 0, 0], 4)] {
            let words = u64x4::from_slice(simd, &words);
            let bytes = words.bitcast::<u8x32<S>>();
            let is_near = bytes.max(least).min(most).bitcast::<u64x4<S>>().simd_eq(words);
            let meets = bytes.min(within).bitcast::<u64x4<S>>().simd_eq(words);
            open |= (is_near & !meets).to_bitmask() << shift;
        }
        open as u32
    }
}

/// All kinds of each lane, four lanes after the other.
#[inline(always)]
fn interleaved<S: Simd>(simd: S, kinds: &[[u16; TOGETHER]; KINDS]) -> [u16x16<S>; 4] {
    let [one, two, three, four] = kinds;
    let even = u16x16::from_slice(simd, one).interleave(u16x16::from_slice(simd, three));
    let odd = u16x16::from_slice(simd, two).interleave(u16x16::from_slice(simd, four));
    let (low, high) = (even.0.interleave(odd.0), even.1.interleave(odd.1));
    [low.0, low.1, high.0, high.1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::dispatch_every;
    use fearless_simd::Level;
    use impinge_testkit::generate::Rng;

    type Ends = [[u8; 3]; 2];

    fn word([min, max]: Ends, cell: [i64; 3]) -> Word {
        (0..3).fold(Word::NONE, |word, k| word.with(Word::along(k, [min[k], max[k]], cell[k])))
    }

    fn draw(rng: &mut Rng) -> Ends {
        let most = rng.choose(&[3, 255]);
        let ends = [0; 3].map(|_: i32| [0; 2].map(|_: i32| rng.integer(0, most) as u8));
        [ends.map(|[one, other]| one.min(other)), ends.map(|[one, other]| one.max(other))]
    }

    #[test]
    fn words_say_of_steps_what_comparing_them_one_by_one_says() {
        let mut rng = Rng::new(91);
        let mut apart = 0;
        for _ in 0..100_000 {
            let cell = [0; 3].map(|_: i32| rng.integer(-20, 20));
            let (one, other) = (draw(&mut rng), draw(&mut rng));
            let [word, seen] = [one, other].map(|ends| word(ends, cell));
            let may_meet = (0..3).all(|k| one[0][k] <= other[1][k] && other[0][k] <= one[1][k]);
            assert_eq!(seen.probe().may_meet(word), may_meet);
            assert_eq!([0, 1, 2].map(|axis| word.begins_before(axis)), one[0].map(|step| step == 0));
            assert!(!word.is_none() && word.is_marked_as(seen) && !word.is_marked_as(Word::NONE));
            apart += u32::from(!may_meet);
        }
        assert!((20_000..95_000).contains(&apart), "{apart} apart");
    }

    /// Parts of a cell, of which many are about one of the ends of the `nth`.
    fn draw_parts(rng: &mut Rng, nth: usize) -> [i16; 2] {
        let about = 256 * nth as i64 + rng.choose(&[0, 256]);
        let [one, other] = [0; 2].map(|_: i32| match rng.integer(0, 1) {
            0 => rng.integer(0, 1023) as i16,
            _ => rng.integer((about - 2).max(0), (about + 2).min(1023)) as i16,
        });
        [one.min(other), one.max(other)]
    }

    #[test]
    fn what_a_move_may_change_is_told_by_steps_one_by_one() {
        let mut rng = Rng::new(93);
        let (mut open, mut decided) = (0, 0);
        for _ in 0..4_000 {
            let nth = [0; 3].map(|_: i32| rng.integer(0, 3) as usize);
            let (mut parts, mut low) = ([[[0; TOGETHER]; 4]; 3], [[0; TOGETHER]; 3]);
            for (axis, lane) in (0..3).flat_map(|axis| (0..TOGETHER).map(move |lane| (axis, lane))) {
                let ends = [draw_parts(&mut rng, nth[axis]), draw_parts(&mut rng, nth[axis])];
                ends.as_flattened().iter().zip(&mut parts[axis]).for_each(|(&end, parts)| parts[lane] = end);
                low[axis][lane] = rng.integer(-20, 20);
            }
            let [seen, others_seen] = [Level::fallback(), crate::simd::best_level()].map(|level| {
                dispatch_every!(level, simd => {
                    let along = [0, 1, 2].map(|axis| Seen::along(simd, axis, &parts[axis], &low[axis], nth[axis]));
                    std::array::from_fn::<Seen, TOGETHER, _>(|lane| {
                        let [x, y, z] = along.each_ref().map(|seen| seen[lane].lanes(simd));
                        Seen::all(simd, x | y | z)
                    })
                })
            });
            assert_eq!(seen, others_seen);
            for (lane, seen) in seen.into_iter().enumerate() {
                let cell = [0, 1, 2].map(|axis| low[axis][lane] + nth[axis] as i64);
                let step = |axis: usize, end: usize| seen_step(parts[axis][end][lane], nth[axis]) as u8;
                let [from, to] =
                    [0, 2].map(|begin| [begin, begin + 1].map(|end| [0, 1, 2].map(|axis| step(axis, end))));
                if (0..3).any(|k| from[1][k].max(to[1][k]) == 0) {
                    continue;
                }
                assert_eq!(seen.after(), word(to, cell));
                let others = [0; HELD].map(|_: i32| draw(&mut rng));
                let elsewhere = rng.integer(0, 3 * HELD as i64) as usize;
                let words = std::array::from_fn(|at| match elsewhere {
                    other if other == at => word(others[at], [cell[0], cell[1] + 1, cell[2]]),
                    other if other == at + HELD => Word::NONE,
                    _ => word(others[at], cell),
                });
                let expected = (0..HELD).filter(|&at| {
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
                    let meets = axes().all(
                        |(step, k, end)| {
                            if end == 1 { Some(step) < least(k, 1) } else { Some(step) > most(k, 0) }
                        },
                    );
                    let is_here = (0..3).all(|k| nth[k] == 0 || other[0][k] > 0);
                    elsewhere != at && elsewhere != at + HELD && is_near && !meets && is_here
                });
                let expected = expected.fold(0, |bits, at| bits | 1 << at);
                for level in [Level::fallback(), crate::simd::best_level()] {
                    let open = dispatch_every!(level, simd => seen.compare(simd, &words));
                    assert_eq!(open, expected, "{level:?}: {seen:?}, {words:?}");
                }
                open += expected.count_ones();
                decided += HELD as u32 - expected.count_ones();
            }
        }
        assert!(open > 10_000 && decided > 100_000, "{open} are open, {decided} are not");
    }

    #[test]
    fn marks_tell_neighbouring_cells_apart() {
        let word = |cell| word([[1; 3], [9; 3]], cell);
        for axis in 0..3 {
            for away in 1..MARKED_APART {
                let mut cell = [-3, 1 << 40, 0];
                let here = word(cell);
                cell[axis] += away;
                assert!(!word(cell).is_marked_as(here));
            }
        }
    }
}
