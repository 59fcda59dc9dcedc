//! Intervals of time that come from halving the motion.

/// Maximum number of times that an interval with proved first contact is halved. It gives the time
/// to 2^-40 of the motion.
pub(super) const CONTACT_LEVEL: u32 = 40;

/// The times from `index` to `index + 1`, in units of `2^-level` of the motion.
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

    /// Returns the first time, rounded down.
    pub(super) fn low(self) -> f64 {
        down(self.index, self.level)
    }

    /// Returns the first time, rounded up.
    pub(super) fn low_above(self) -> f64 {
        up(self.index, self.level)
    }

    /// Returns the last time, rounded up.
    pub(super) fn high(self) -> f64 {
        up(self.index + 1, self.level)
    }
}

/// Returns `index / 2^level`, rounded down to 53 bits.
fn down(index: u128, level: u32) -> f64 {
    let excess = (75 - index.leading_zeros() as i32).max(0);
    ((index >> excess) << excess) as f64 * f64::from_bits(u64::from(1023 - level) << 52)
}

/// Returns `index / 2^level`, rounded up to 53 bits.
fn up(index: u128, level: u32) -> f64 {
    let below = down(index, level);
    let excess = (75 - index.leading_zeros() as i32).max(0);
    if index >> excess << excess == index { below } else { below.next_up() }
}
