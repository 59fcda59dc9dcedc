//! The answers of a batch: a value and a status for each row.

use crate::input::{InputError, InputErrorKind};

/// Status of the answer of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[repr(u8)]
pub enum Status {
    /// The answer is proved.
    #[default]
    Ok = 0,
    /// A pose is invalid: an entry is NaN or infinite. The answer is the safe one.
    NonFinite = 1,
    /// A pose is invalid: an entry is out of range. The answer is the safe one.
    OutOfRange = 2,
    /// A pose is invalid: the last row of the matrix is not 0, 0, 0, 1. The answer is the safe one.
    NotAffine = 3,
    /// A pose is invalid: its linear part has no inverse. The answer is the safe one.
    Singular = 4,
    /// The answer is undecided, so it is the safe one.
    Undecided = 5,
    /// A pose is invalid for a round shape: it is more than 1e-4 from a rigid motion. The answer is
    /// the safe one.
    NotRigid = 6,
}

/// Answers of a query at many poses, in row-major order of the leading axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers<T> {
    /// Leading axes of the answers. Empty for a single row of single poses.
    pub shape: Vec<usize>,
    /// Answer of each row.
    pub values: Vec<T>,
    /// Status of each row.
    pub status: Vec<Status>,
}

impl Status {
    /// Returns the status of a row with an invalid pose.
    pub(crate) fn of(error: &InputError) -> Self {
        match error.kind() {
            InputErrorKind::NonFinite { .. } => Self::NonFinite,
            InputErrorKind::OutOfRange { .. } => Self::OutOfRange,
            InputErrorKind::NotAffine { .. } => Self::NotAffine,
            InputErrorKind::NotRigid { .. } => Self::NotRigid,
            // A matrix can have no other errors.
            _ => Self::Singular,
        }
    }
}

impl<T> Answers<T> {
    /// Returns these answers with each value mapped by `of`. The status of each row stays.
    #[must_use]
    pub fn map<U>(self, of: impl FnMut(T) -> U) -> Answers<U> {
        Answers { shape: self.shape, values: self.values.into_iter().map(of).collect(), status: self.status }
    }

    /// Sets the status of each row whose answer `is_undecided` to `Undecided`. A row with an
    /// invalid pose keeps its status.
    pub(crate) fn mark_undecided(mut self, is_undecided: impl Fn(&T) -> bool) -> Self {
        for (status, value) in self.status.iter_mut().zip(&self.values) {
            if *status == Status::Ok && is_undecided(value) {
                *status = Status::Undecided;
            }
        }
        self
    }
}
