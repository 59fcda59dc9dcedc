//! Intervals of time that come from halving the motion.

/// How often an interval that is proved to hold the first contact is halved: time is known to 2^-40 of the motion.
pub(super) const MEETS_LEVEL: u32 = 40;

/// The times from `index` to `index + 1`, in units of `2^-level`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) level: u32,
    pub(super) index: u128,
}

impl Span {
    pub(super) const WHOLE: Self = Self { level: 0, index: 0 };

    pub(super) fn halves(self) -> [Self; 2] {
        let (level, index) = (self.level + 1, 2 * self.index);
        [Self { level, index }, Self { level, index: index + 1 }]
    }

    /// The first time, or a float before it.
    pub(super) fn low(self) -> f64 {
        down(self.index, self.level)
    }

    /// The first time, or a float after it.
    pub(super) fn low_above(self) -> f64 {
        up(self.index, self.level)
    }

    /// The last time, or a float after it.
    pub(super) fn high(self) -> f64 {
        up(self.index + 1, self.level)
    }
}

/// `index / 2^level` with all bits beyond the first 53 left out.
fn down(index: u128, level: u32) -> f64 {
    let excess = (75 - index.leading_zeros() as i32).max(0);
    ((index >> excess) << excess) as f64 * f64::from_bits(u64::from(1023 - level) << 52)
}

/// `index / 2^level`, or the next multiple of its 53rd bit.
fn up(index: u128, level: u32) -> f64 {
    let below = down(index, level);
    let excess = (75 - index.leading_zeros() as i32).max(0);
    if index >> excess << excess == index { below } else { below.next_up() }
}
