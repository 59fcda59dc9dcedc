//! A box as it is seen from a cell, in a word: small enough that what a cell holds is in a line of memory.

/// Bits from a step to the next: eight that tell it, and one above that a difference of two borrows from.
const PITCH: u32 = 9;

/// The lowest bit of each of six steps.
const ONES: u64 = 1 | 1 << PITCH | 1 << (2 * PITCH) | 1 << (3 * PITCH) | 1 << (4 * PITCH) | 1 << (5 * PITCH);

/// The bit above each.
const ABOVE: u64 = ONES << 8;

/// All bits of the steps.
const ALL: u64 = ONES * 0xff;

/// What belongs to the three least coordinates.
const HALF: u64 = (1 << (3 * PITCH)) - 1;

/// Above the steps: three bits of the cell along each axis, and one that is always set.
const MARK: u32 = 6 * PITCH;

/// Cells along an axis of which no two have the same mark.
pub(super) const MARKED_APART: i64 = 8;

/// Where a box begins and ends as seen from a cell, in steps along the three axes, and a mark of the cell. The ends are told
/// from behind, so that a larger box has lesser steps throughout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Word(u64);

/// A box that words are compared with: the greatest steps that a box may have that it meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe(u64);

/// What steps prove about two boxes: those that are in strict order belong to coordinates in strict order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    /// Unless they do, the boxes are apart.
    pub(super) may_meet: bool,
    /// If they do, the boxes meet.
    pub(super) meet: bool,
}

impl Word {
    /// What stands where there is no box.
    pub(super) const NONE: Self = Self(0);

    /// What is told of one axis: where the box begins and ends, from 0, before the cell, to 255, behind it, and the place of the
    /// cell. A word is all three.
    #[inline]
    pub(super) fn along(axis: usize, [begin, end]: [u8; 2], cell: i64) -> Self {
        let steps = u64::from(u8::MAX - end) << (3 * PITCH) | u64::from(begin);
        let mark = 1 << 9 | ((cell & (MARKED_APART - 1)) as u64) << (3 * axis);
        Self(mark << MARK | steps << (PITCH * axis as u32))
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
        (self.0 ^ other.0) >> MARK == 0
    }

    /// Whether the box begins before the cell along an axis.
    #[inline]
    pub(super) fn begins_before(self, axis: usize) -> bool {
        self.0 >> (PITCH * axis as u32) & 0xff == 0
    }

    /// The box as others are compared with it.
    #[inline]
    pub(super) fn probe(self) -> Probe {
        let steps = self.0 & ALL;
        Probe(ALL ^ (steps >> (3 * PITCH) | (steps & HALF) << (3 * PITCH)) | ABOVE)
    }
}

impl Probe {
    /// All six steps are compared in one difference. Only of use for a word that is seen from the same cell.
    #[inline]
    pub(super) fn with(self, word: Word) -> Verdict {
        let over = self.0 - (word.0 & ALL);
        Verdict { may_meet: over & ABOVE == ABOVE, meet: (over - ONES) & ABOVE == ABOVE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    fn word(min: [u8; 3], max: [u8; 3], cell: [i64; 3]) -> Word {
        (0..3).fold(Word::NONE, |word, k| word.with(Word::along(k, [min[k], max[k]], cell[k])))
    }

    #[test]
    fn words_say_of_steps_what_comparing_them_one_by_one_says() {
        let mut rng = Rng::new(91);
        let (mut apart, mut meet) = (0, 0);
        for _ in 0..100_000 {
            let cell = [0; 3].map(|_: i32| rng.integer(-20, 20));
            let mut draw = || {
                let most = rng.choose(&[3, 255]);
                let ends = [0; 3].map(|_: i32| [0; 2].map(|_: i32| rng.integer(0, most) as u8));
                (ends.map(|[one, other]| one.min(other)), ends.map(|[one, other]| one.max(other)))
            };
            let (one, other) = (draw(), draw());
            let [word, seen] = [one, other].map(|(min, max)| word(min, max, cell));
            let verdict = seen.probe().with(word);
            let axes = || (0..3).flat_map(|k| [(one.0[k], other.1[k]), (other.0[k], one.1[k])]);
            assert_eq!(verdict.may_meet, axes().all(|(min, max)| min <= max));
            assert_eq!(verdict.meet, axes().all(|(min, max)| min < max));
            assert_eq!([0, 1, 2].map(|axis| word.begins_before(axis)), one.0.map(|step| step == 0));
            assert!(!word.is_none() && word.is_marked_as(seen) && !word.is_marked_as(Word::NONE));
            apart += u32::from(!verdict.may_meet);
            meet += u32::from(verdict.meet);
        }
        assert!(apart > 20_000 && meet > 5_000 && apart + meet < 95_000, "{apart} apart, {meet} meet");
    }

    #[test]
    fn marks_tell_neighbouring_cells_apart() {
        let word = |cell| word([1; 3], [9; 3], cell);
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
