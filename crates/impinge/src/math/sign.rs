//! The sign of a real number. Exact decisions are made of signs only.

use std::cmp::Ordering;
use std::ops::Neg;

/// The sign of a real number. Signs are ordered: negative, zero, positive.
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
    /// Returns the opposite sign if `negate` is true, otherwise this sign.
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

/// Returns the sign of `x - y`, given how `x` compares to `y`.
impl From<Ordering> for Sign {
    fn from(ordering: Ordering) -> Self {
        match ordering {
            Ordering::Less => Self::Negative,
            Ordering::Equal => Self::Zero,
            Ordering::Greater => Self::Positive,
        }
    }
}
