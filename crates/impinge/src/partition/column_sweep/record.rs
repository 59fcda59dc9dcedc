//! A box as a column knows it: sixteen bytes.

/// A copy of a box in a column: its image in whole steps of 15 bits, along the column from the frame's low end, and across from
/// the column itself. Where it ends is told from behind, by how far the last step is from it: so what begins no later than
/// something ends has a sum with that of no more than the last step, and the bit above tells it of all axes at once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    /// On each axis across, in 16 bits each: where it begins, and in the bit above whether this is the second column that the box
    /// reaches into on that axis; and where it ends.
    across: u64,
    /// Where it begins and ends along the column, in 16 bits each.
    along: u32,
    pub(super) key: u32,
}

/// The last step.
pub(super) const LAST: u32 = (1 << 15) - 1;

/// Of four numbers of 16 bits the highest bits, and the lowest.
const OVER: u64 = 0x8000_8000_8000_8000;
const ONES: u64 = 0x0001_0001_0001_0001;

/// How many bits a step has more than the part of it that is compared first.
const FINE: u32 = 7;

/// What is told of an axis; of steps beyond the last nothing that means something.
#[inline(always)]
pub(super) fn interval(begin: u32, end: u32) -> u32 {
    begin | LAST.wrapping_sub(end) << 16
}

/// The same interval counted from the next column, `width` steps on, as its second one.
#[inline(always)]
pub(super) fn from_next(interval: u32, width: u32) -> u32 {
    // What is told from behind grows, and each stays within its half.
    as_second(interval.wrapping_sub(width).wrapping_add(width << 16))
}

/// An interval as that of the second column that a box reaches into.
#[inline(always)]
pub(super) fn as_second(interval: u32) -> u32 {
    interval | (LAST + 1)
}

impl Record {
    #[inline(always)]
    pub(super) fn new(along: u32, [x, y]: [u32; 2], key: u32) -> Self {
        Self { across: u64::from(x) | u64::from(y) << 32, along, key }
    }

    /// Where it begins and ends along.
    #[inline(always)]
    pub(super) fn along(&self) -> [u32; 2] {
        [self.along & LAST, LAST - (self.along >> 16)]
    }

    /// Whether this is the second column that the box reaches into on an axis: a bit for each.
    #[inline(always)]
    pub(super) fn second(&self) -> u32 {
        (self.across >> 15 & 1 | self.across >> 46 & 2) as u32
    }

    /// Where it begins and ends across in bytes, which are in order as the steps are.
    #[inline(always)]
    pub(super) fn word(&self) -> u32 {
        let bytes = self.across >> FINE & 0x00ff_00ff_00ff_00ff;
        let pairs = (bytes | bytes >> 8) & 0x0000_ffff_0000_ffff;
        (pairs | pairs >> 16) as u32
    }

    /// What the images say of two boxes.
    #[inline(always)]
    pub(super) fn verdict(&self, other: &Self) -> Verdict {
        const LOW: u64 = 0x0000_ffff_0000_ffff;
        let theirs = other.across & !OVER;
        let across = (self.across & !OVER) + ((theirs & LOW) << 16 | theirs >> 16 & LOW);
        let along = u64::from(self.along + other.along.rotate_left(16));
        // A sum that is the last step is a touch.
        Verdict { is_apart: (across | along) & OVER != 0, is_certain: ((across + ONES) | (along + ONES)) & OVER == 0 }
    }
}

/// The most that bytes may be of a box that meets one with these; see [`Record::word`].
#[inline(always)]
pub(super) fn probe(word: u32) -> u32 {
    const LOW: u32 = 0x00ff_00ff;
    !((word & LOW) << 8 | word >> 8 & LOW)
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
    use impinge_testkit::generate::Rng;

    /// Steps of which many are equal, next to each other or at the ends.
    fn ends(rng: &mut Rng) -> [u32; 2] {
        let [one, other] = match rng.integer(0, 2) {
            0 => [0; 2].map(|_: i32| rng.integer(0, i64::from(LAST)) as u32),
            1 => [0; 2].map(|_: i32| rng.integer(16_380, 16_390) as u32),
            _ => [0; 2].map(|_: i32| rng.choose(&[0, 1, 2, 127, 128, LAST - 1, LAST])),
        };
        [one.min(other), one.max(other)]
    }

    #[test]
    fn sums_and_bytes_say_of_steps_what_comparing_them_one_by_one_says() {
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
            let meet = |is_less: &dyn Fn(u32, u32) -> bool, axes: std::ops::Range<usize>| {
                axes.clone().all(|axis| {
                    is_less(boxes[0][axis][0], boxes[1][axis][1]) && is_less(boxes[1][axis][0], boxes[0][axis][1])
                })
            };
            let verdict = one.verdict(&other);
            assert_eq!(verdict.is_apart, !meet(&|begin, end| begin <= end, 0..3), "{boxes:?}");
            assert_eq!(verdict.is_certain, meet(&|begin, end| begin < end, 0..3), "{boxes:?}");
            let most = probe(other.word()).to_ne_bytes();
            let is_near = one.word().to_ne_bytes().iter().zip(most).all(|(&byte, most)| byte <= most);
            assert_eq!(is_near, meet(&|begin, end| begin >> FINE <= end >> FINE, 1..3), "{boxes:?}");
            (apart, certain) = (apart + u32::from(verdict.is_apart), certain + u32::from(verdict.is_certain));
            passed += u32::from(is_near && verdict.is_apart);
        }
        assert!(
            apart > 50_000 && certain > 5_000 && passed > 1_000,
            "{apart} apart, {certain} meet, {passed} by bytes alone"
        );
    }

    #[test]
    fn intervals_of_the_next_column_are_a_width_less() {
        for [begin, end] in [[16_384, 16_384], [16_390, 32_767], [20_000, 30_000]] {
            assert_eq!(from_next(interval(begin, end), 16_384), as_second(interval(begin - 16_384, end - 16_384)));
        }
    }
}
