//! A box as it is seen from a cell, in a word: small enough that what a cell holds is in a line of memory.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u8x32, u64x4};

use super::lines::HELD;

/// Bytes of steps; the mark is in the two above.
const STEPS: u32 = 6;
const ALL: u64 = (1 << (8 * STEPS)) - 1;

/// How far above the first step of an axis is the other one.
const END: u32 = 24;

/// Where three bits of the cell along each axis are, and one that is always set. No byte of a mark is full.
const MARKS: [u32; 3] = [48, 51, 56];
const IS_THERE: u64 = 1 << 54;

/// Cells along an axis of which no two have the same mark.
pub(super) const MARKED_APART: i64 = 8;

/// Where a box begins and ends as seen from a cell, in steps along the three axes, and a mark of the cell. The ends are told
/// from behind, so that a larger box has lesser steps throughout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Word(u64);

/// A box that words are compared with: the greatest steps that a box may have that it meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe(u64);

/// What is seen of a box that moves from a cell, for finding what may begin to meet it, or cease to; of one axis, or all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    /// The box where it goes.
    after: u64,
    /// Between which bytes are those of what may meet the box at the one place or the other and is to be found in this cell.
    least: u64,
    most: u64,
    /// Up to which are those of what meets it at both.
    within: u64,
}

impl Word {
    /// What stands where there is no box.
    pub(super) const NONE: Self = Self(0);

    /// What is told of one axis: where the box begins and ends, from 0, before the cell, to 255, behind it, and the place of the
    /// cell. A word is all three.
    #[inline(always)]
    pub(super) fn along(axis: usize, [begin, end]: [u8; 2], cell: i64) -> Self {
        Self(steps(axis, u64::from(begin), u64::from(u8::MAX - end)) | mark(axis, cell))
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
        self.0 >> (8 * axis) & 0xff == 0
    }

    /// The box as others are compared with it.
    #[inline]
    pub(super) fn probe(self) -> Probe {
        let steps = ALL ^ (self.0 & ALL);
        Probe(!ALL | steps >> END | (steps << END & ALL))
    }
}

/// Two steps of an axis in their places.
#[inline(always)]
fn steps(axis: usize, first: u64, second: u64) -> u64 {
    (first | second << END) << (8 * axis)
}

#[inline(always)]
fn mark(axis: usize, cell: i64) -> u64 {
    ((cell & (MARKED_APART - 1)) as u64) << MARKS[axis] | IS_THERE
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
    /// What is seen along an axis of a box that comes from where the first steps say that it begins and ends, and goes to where
    /// the others do; one of them ends in the cell or behind it. Boxes that begin before it are found in another one, if it is
    /// not the first along the axis, `nth`.
    #[inline(always)]
    pub(super) fn along(axis: usize, from: [i32; 2], to: [i32; 2], cell: i64, nth: usize) -> Self {
        let ([begin, end], [next_begin, next_end]) = (from.map(|step| step as u64), to.map(|step| step as u64));
        let mark = mark(axis, cell);
        Self {
            after: steps(axis, next_begin, 255 - next_end) | mark,
            least: steps(axis, nth.min(1) as u64, 0) | mark,
            most: steps(axis, end.max(next_end), 255 - begin.min(next_begin)) | mark,
            within: Self::within(axis, end.min(next_end), 255 - begin.max(next_begin)),
        }
    }

    /// Bytes that are strictly less along an axis, and any along the others; none where nothing is, as no mark is.
    #[inline(always)]
    fn within(axis: usize, first: u64, second: u64) -> u64 {
        let less = steps(axis, first.wrapping_sub(1), second.wrapping_sub(1)) | !steps(axis, 255, 255);
        if (first == 0) | (second == 0) { 0 } else { less }
    }

    /// Of three axes together.
    #[inline(always)]
    pub(super) fn all(x: &Self, y: &Self, z: &Self) -> Self {
        Self {
            after: x.after | y.after | z.after,
            least: x.least | y.least | z.least,
            most: x.most | y.most | z.most,
            within: x.within & y.within & z.within,
        }
    }

    /// The box where it goes.
    #[inline(always)]
    pub(super) fn after(&self) -> Word {
        Word(self.after)
    }

    /// Which of the boxes of a line may begin to meet the one that moves, or cease to, and which are seen from the same cell or one
    /// that looks alike: a bit each.
    #[inline(always)]
    pub(super) fn compare<S: Simd>(&self, simd: S, words: &[Word; HELD]) -> (u32, u32) {
        let [after, least, most, within] =
            [self.after, self.least, self.most, self.within].map(|all| u64x4::splat(simd, all));
        let [least, most, within] = [least, most, within].map(|all| all.bitcast::<u8x32<S>>());
        let steps = u64x4::splat(simd, ALL);
        let [one, two, three, four, five] = words.map(|word| word.0);
        let (mut open, mut here) = (0, 0);
        // What is no box has no mark.
        for (words, shift) in [([one, two, three, four], 0), ([five, 0, 0, 0], 4)] {
            let words = u64x4::from_slice(simd, &words);
            let bytes = words.bitcast::<u8x32<S>>();
            let is_near = bytes.max(least).min(most).bitcast::<u64x4<S>>().simd_eq(words);
            let meets = bytes.min(within).bitcast::<u64x4<S>>().simd_eq(words);
            open |= (is_near & !meets).to_bitmask() << shift;
            here |= ((words ^ after) | steps).simd_eq(steps).to_bitmask() << shift;
        }
        (open as u32, here as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
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

    #[test]
    fn what_a_move_may_change_is_told_by_steps_one_by_one() {
        let mut rng = Rng::new(93);
        let (mut open, mut decided) = (0, 0);
        for _ in 0..50_000 {
            let cell = [0; 3].map(|_: i32| rng.integer(-20, 20));
            let (from, to) = (draw(&mut rng), draw(&mut rng));
            if (0..3).any(|k| from[1][k].max(to[1][k]) == 0) {
                continue;
            }
            let nth = [0; 3].map(|_: i32| rng.integer(0, 2) as usize);
            let [x, y, z] = [0, 1, 2].map(|k| {
                let [from, to] = [from, to].map(|ends| [i32::from(ends[0][k]), i32::from(ends[1][k])]);
                Seen::along(k, from, to, cell[k], nth[k])
            });
            let seen = Seen::all(&x, &y, &z);
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
                let is_near = axes().all(
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
                let (open, here) = dispatch!(level, simd => seen.compare(simd, &words));
                assert_eq!(open, expected, "{level:?}: {seen:?}, {words:?}");
                assert!((0..HELD).all(|at| words[at].is_marked_as(seen.after()) == (here >> at & 1 == 1)));
            }
            open += expected.count_ones();
            decided += HELD as u32 - expected.count_ones();
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
