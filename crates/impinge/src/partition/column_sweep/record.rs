//! A box as a column stores it, in sixteen bytes.

/// Copy of a box in a column: its image in whole steps of 15 bits. Along the column, steps are
/// counted from the frame's low end; across, from the column itself.
///
/// Ends are stored reversed, as `LAST - end`. One box begins no later than another ends exactly if
/// `begin + (LAST - end) <= LAST`. Bit 15 of the sum shows this, so one addition tests all axes at
/// once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    /// Interval on each of the two axes across, in 32 bits: the lower 16 bits hold its beginning
    /// and in bit 15 whether this is the second column that the box reaches into on that axis. The
    /// upper 16 bits hold its reversed end.
    across: u64,
    /// Interval along the column: its beginning in the lower 16 bits, its reversed end in the upper
    /// 16 bits.
    along: u32,
    pub(super) key: u32,
}

/// Largest step.
pub(super) const LAST: u32 = (1 << 15) - 1;

/// Highest bit of each of four 16-bit numbers.
const OVER: u64 = 0x8000_8000_8000_8000;

/// Lowest bit of each of four 16-bit numbers.
const ONES: u64 = 0x0001_0001_0001_0001;

/// Number of low bits of a step that the first comparison, which uses bytes, ignores.
const FINE: u32 = 7;

/// Returns an interval of steps as a record stores it. The result is meaningless if a step exceeds
/// [`LAST`].
#[inline(always)]
pub(super) fn interval(begin: u32, end: u32) -> u32 {
    begin | LAST.wrapping_sub(end) << 16
}

/// Returns the interval counted from the next column, `width` steps farther, marked as in the
/// second column.
#[inline(always)]
pub(super) fn from_next(interval: u32, width: u32) -> u32 {
    // The reversed end grows by the width, and each half stays within its 16 bits.
    as_second(interval.wrapping_sub(width).wrapping_add(width << 16))
}

/// Returns the interval, marked as in the second column that the box reaches into.
#[inline(always)]
pub(super) fn as_second(interval: u32) -> u32 {
    interval | (LAST + 1)
}

impl Record {
    #[inline(always)]
    pub(super) fn new(along: u32, [x, y]: [u32; 2], key: u32) -> Self {
        Self { across: u64::from(x) | u64::from(y) << 32, along, key }
    }

    /// Returns the first and the last step along the column.
    #[inline(always)]
    pub(super) fn along(&self) -> [u32; 2] {
        [self.along & LAST, LAST - (self.along >> 16)]
    }

    /// Returns one bit per axis across: set if this is the second column that the box reaches into
    /// on that axis.
    #[inline(always)]
    pub(super) fn second(&self) -> u32 {
        (self.across >> 15 & 1 | self.across >> 46 & 2) as u32
    }

    /// Returns the beginnings and reversed ends across, reduced to four bytes whose order follows
    /// that of the steps.
    #[inline(always)]
    pub(super) fn word(&self) -> u32 {
        let bytes = self.across >> FINE & 0x00ff_00ff_00ff_00ff;
        let pairs = (bytes | bytes >> 8) & 0x0000_ffff_0000_ffff;
        (pairs | pairs >> 16) as u32
    }

    /// Compares the images of two boxes.
    #[inline(always)]
    pub(super) fn verdict(&self, other: &Self) -> Verdict {
        const LOW: u64 = 0x0000_ffff_0000_ffff;
        let theirs = other.across & !OVER;
        let across = (self.across & !OVER) + ((theirs & LOW) << 16 | theirs >> 16 & LOW);
        let along = u64::from(self.along + other.along.rotate_left(16));
        // If a sum equals the last step, the images touch.
        Verdict { is_apart: (across | along) & OVER != 0, is_certain: ((across + ONES) | (along + ONES)) & OVER == 0 }
    }
}

/// Returns an upper bound for each byte of the word of a box that can overlap the box with this
/// word; see [`Record::word`].
#[inline(always)]
pub(super) fn probe(word: u32) -> u32 {
    const LOW: u32 = 0x00ff_00ff;
    !((word & LOW) << 8 | word >> 8 & LOW)
}

/// Facts that images prove about two boxes: steps in the wrong order prove the boxes apart; if all
/// steps are in strict order, the boxes overlap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    pub(super) is_apart: bool,
    pub(super) is_certain: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    /// Returns an interval of steps. Many steps are equal, adjacent or at the ends of the range.
    fn ends(rng: &mut Rng) -> [u32; 2] {
        let [one, other] = match rng.integer(0, 2) {
            0 => [0; 2].map(|_: i32| rng.integer(0, i64::from(LAST)) as u32),
            1 => [0; 2].map(|_: i32| rng.integer(16_380, 16_390) as u32),
            _ => [0; 2].map(|_: i32| rng.choose(&[0, 1, 2, 127, 128, LAST - 1, LAST])),
        };
        [one.min(other), one.max(other)]
    }

    #[test]
    fn sums_and_bytes_agree_with_comparing_steps_one_by_one() {
        let mut rng = Rng::new(77);
        let (mut apart, mut certain, mut passed) = (0, 0, 0);
        for _ in 0..200_000 {
            let boxes = [0; 2].map(|_: i32| [0; 3].map(|_: i32| ends(&mut rng)));
            let second = [0; 2].map(|_: i32| rng.integer(0, 3) as u32);
            let [one, other] = [0, 1].map(|at| {
                let [along, x, y] = boxes[at].map(|[begin, end]| interval(begin, end));
                let across =
                    [(x, 1), (y, 2)].map(|(word, bit)| if second[at] & bit == 0 { word } else { as_second(word) });
                Record::new(along, across, 0)
            });
            assert_eq!([one, other].map(|record| record.second()), second);
            assert_eq!([one, other].map(|record| record.along()), boxes.map(|axes| axes[0]));
            let overlap = |is_less: &dyn Fn(u32, u32) -> bool, axes: std::ops::Range<usize>| {
                axes.clone().all(|axis| {
                    is_less(boxes[0][axis][0], boxes[1][axis][1]) && is_less(boxes[1][axis][0], boxes[0][axis][1])
                })
            };
            let verdict = one.verdict(&other);
            assert_eq!(verdict.is_apart, !overlap(&|begin, end| begin <= end, 0..3), "{boxes:?}");
            assert_eq!(verdict.is_certain, overlap(&|begin, end| begin < end, 0..3), "{boxes:?}");
            let most = probe(other.word()).to_ne_bytes();
            let is_near = one.word().to_ne_bytes().iter().zip(most).all(|(&byte, most)| byte <= most);
            assert_eq!(is_near, overlap(&|begin, end| begin >> FINE <= end >> FINE, 1..3), "{boxes:?}");
            (apart, certain) = (apart + u32::from(verdict.is_apart), certain + u32::from(verdict.is_certain));
            passed += u32::from(is_near && verdict.is_apart);
        }
        assert!(
            apart > 50_000 && certain > 5_000 && passed > 1_000,
            "{apart} apart, {certain} overlap, {passed} overlap by bytes alone"
        );
    }

    #[test]
    fn intervals_of_the_next_column_are_a_width_less() {
        for [begin, end] in [[16_384, 16_384], [16_390, 32_767], [20_000, 30_000]] {
            assert_eq!(from_next(interval(begin, end), 16_384), as_second(interval(begin - 16_384, end - 16_384)));
        }
    }
}
