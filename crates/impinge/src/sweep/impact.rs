//! When two things first touch, with what was proved about it.

/// The first time in [0, 1] at which two moving sets have a point in common, as an interval that is proved.
///
/// The time 0 is the start of the motion and 1 its end. Touching counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Nothing touches before this time. Infinite where contact is disproved for all of [0, 1], and only there.
    pub t_lower: f64,
    /// Something touches no later than this. Infinite where that is not proved: contact was disproved, or the work that
    /// one question may take was done before it was decided.
    pub t_upper: f64,
}

impl Impact {
    /// Nothing touches in [0, 1].
    pub const NEVER: Self = Self { t_lower: f64::INFINITY, t_upper: f64::INFINITY };

    /// Whether contact is to be reckoned with: it is proved, or not disproved.
    #[must_use]
    pub fn hit(&self) -> bool {
        self.t_lower < f64::INFINITY
    }

    /// Whether the question is settled: contact is proved or disproved. Where it is not, [`hit`](Self::hit) is the safe
    /// answer.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.t_upper < f64::INFINITY || !self.hit()
    }
}
