//! The sign of a real number, the only thing that exact decisions are made of.

use std::cmp::Ordering;
use std::ops::Neg;

/// Whether a real number is below, at or above zero; ordered in that way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sign {
    /// Below zero.
    Negative,
    /// Zero itself.
    Zero,
    /// Above zero.
    Positive,
}

impl Sign {
    /// This sign, or the opposite one.
    pub(crate) fn negated_if(self, negate: bool) -> Self {
        if negate { -self } else { self }
    }
}

impl Neg for Sign {
    type Output = Self;

    fn neg(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }
}

/// The sign of `x - y`, from how `x` compares to `y`.
impl From<Ordering> for Sign {
    fn from(ordering: Ordering) -> Self {
        match ordering {
            Ordering::Less => Self::Negative,
            Ordering::Equal => Self::Zero,
            Ordering::Greater => Self::Positive,
        }
    }
}
