//! A box as a column knows it: sixteen bytes.

/// A copy of a box in a column: its image in whole steps, along the column from the frame's low end, and across from the
/// column itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    /// Where it begins and ends along the column, in 16 bits each.
    along: u32,
    /// On each axis across, in 16 bits each: twice where it begins and whether this is the second column that it reaches into,
    /// and two more than twice where it ends. So what begins no later than something ends is *less*, a comparison that
    /// vector units have, and the bit changes no comparison.
    across: [u32; 2],
    pub(super) key: u32,
}

/// Two begins or ends that differ by more than this are of different steps.
const STEP: i32 = 2;

/// The word of an axis across.
#[inline(always)]
pub(super) fn across_word(begin: i32, end: i32, is_second: bool) -> u32 {
    let low = (begin << 1 | i32::from(is_second)) as u32 & 0xffff;
    low | (((end << 1) + STEP) as u32) << 16
}

/// The same interval counted from the next column, `width` steps on, as its second one.
#[inline(always)]
pub(super) fn from_next(word: u32, width: i32) -> u32 {
    let low = (word as u16).wrapping_sub((width << 1) as u16) | 1;
    let high = ((word >> 16) as u16).wrapping_sub((width << 1) as u16);
    u32::from(low) | u32::from(high) << 16
}

impl Record {
    #[inline(always)]
    pub(super) fn new(along: u32, across: [u32; 2], key: u32) -> Self {
        Self { along, across, key }
    }

    /// Where it begins and ends along.
    #[inline(always)]
    pub(super) fn along(&self) -> [u32; 2] {
        [self.along & 0xffff, self.along >> 16]
    }

    /// Where it begins and ends on an axis across: begins are less than the ends that they are not behind.
    #[inline(always)]
    pub(super) fn across(&self, axis: usize) -> [i16; 2] {
        [self.across[axis] as i16, (self.across[axis] >> 16) as i16]
    }

    /// Whether this is the second column that the box reaches into on an axis: a bit for each.
    #[inline(always)]
    pub(super) fn second(&self) -> u32 {
        self.across[0] & 1 | (self.across[1] & 1) << 1
    }

    /// What the images say of two boxes whose intervals across are known to meet.
    #[inline(always)]
    pub(super) fn verdict(&self, other: &Self) -> Verdict {
        let ([begin, end], [other_begin, other_end]) = (self.along(), other.along());
        let is_apart = (begin > other_end) | (other_begin > end);
        let mut is_certain = (begin < other_end) & (other_begin < end);
        for axis in 0..2 {
            let ([begin, end], [other_begin, other_end]) =
                (self.across(axis).map(i32::from), other.across(axis).map(i32::from));
            is_certain &= (begin + STEP < other_end) & (other_begin + STEP < end);
        }
        Verdict { is_apart, is_certain }
    }
}

/// What is proved by images: steps in the wrong order prove boxes apart, all steps in strict order that they meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    pub(super) is_apart: bool,
    pub(super) is_certain: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons_of_words_are_those_of_steps() {
        let ends = |begin: i32, end: i32, is_second| {
            let word = across_word(begin, end, is_second);
            Record::new(5 | 9 << 16, [word, across_word(0, 4, false)], 0)
        };
        let steps = [-8193, -8192, -1, 0, 1, 2, 8191, 8192, 12_288];
        for [begin, end] in steps.iter().flat_map(|&one| steps.map(|other| [one, other])) {
            for [is_second, is_other] in [[false, false], [true, false], [false, true]] {
                let (one, other) = (ends(begin, begin + 3, is_second), ends(end - 5, end, is_other));
                assert_eq!(one.across(0)[0] < other.across(0)[1], begin <= end, "{begin} {end}");
                let meets = begin < end && end - 5 < begin + 3;
                assert_eq!(one.verdict(&other).is_certain, meets, "{begin} {end}");
                assert_eq!([one.second(), other.second()], [is_second, is_other].map(u32::from));
            }
            let word = from_next(across_word(begin, begin + 3, false), 8192);
            if begin - 8192 >= -8193 {
                assert_eq!(word, across_word(begin - 8192, begin + 3 - 8192, true));
            }
        }
        let [one, other] =
            [[2, 5], [5, 9]].map(|[begin, end]: [u32; 2]| Record::new(begin | end << 16, [1 << 16; 2], 0));
        assert!(!one.verdict(&other).is_apart && !one.verdict(&other).is_certain);
        assert!(Record::new(2 | 4 << 16, [1 << 16; 2], 0).verdict(&other).is_apart);
    }
}
