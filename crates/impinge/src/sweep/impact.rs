//! The time at which two things first touch, with proved bounds.

/// The first time in [0, 1] at which two moving sets have a point in common, as a proved interval.
///
/// Time 0 is the start of the motion and 1 its end. Touching counts as contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Lower bound of the time: nothing touches before it. It is infinite if and only if contact is
    /// disproved for all of [0, 1].
    pub t_lower: f64,
    /// Upper bound of the time: there is contact no later than it. It is infinite if that is not
    /// proved: contact was disproved, or the limit on the work of one query was reached first.
    pub t_upper: f64,
}

impl Impact {
    /// The impact of sets that do not touch in [0, 1].
    pub const NEVER: Self = Self { t_lower: f64::INFINITY, t_upper: f64::INFINITY };

    /// Reports whether contact is proved or undecided. `false` means that the sets are proved not
    /// to touch.
    #[must_use]
    pub fn hit(&self) -> bool {
        self.t_lower < f64::INFINITY
    }

    /// Reports whether contact is proved or disproved. If neither is proved, [`hit`](Self::hit)
    /// returns `true`, the safe answer.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.t_upper < f64::INFINITY || !self.hit()
    }
}
