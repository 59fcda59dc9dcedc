//! The answers of a batch: a value and a status for each row.

use crate::input::{InputError, InputErrorKind};

/// Status of the answer of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[repr(u8)]
pub enum Status {
    /// The poses are valid, and the answer is proved.
    #[default]
    Ok = 0,
    /// A pose of this row is invalid: an entry is NaN or infinite. The row has the safe answer that
    /// its query documents.
    NonFinite = 1,
    /// A pose of this row is invalid: an entry is out of range. The row has the safe answer that
    /// its query documents.
    OutOfRange = 2,
    /// A pose of this row is invalid: the last row of its matrix is not 0, 0, 0, 1. The row has the
    /// safe answer that its query documents.
    NotAffine = 3,
    /// A pose of this row is invalid: its linear part has no inverse. The row has the safe answer
    /// that its query documents.
    Singular = 4,
    /// The poses are valid, but the answer is not proved, for example because round shapes nearly
    /// touch. The row has the answer that its query returns then, such as `true` or a lower bound
    /// of zero.
    Undecided = 5,
    /// A pose of this row is invalid for a round shape: it is more than 1e-4 from a rigid motion.
    /// The row has the safe answer that its query documents.
    NotRigid = 6,
    /// A limit of the [`Budget`](crate::Budget) was reached before the answer was complete. The row
    /// has the safe answer that its query documents.
    OutOfBudget = 7,
}

/// Answers of a query at many poses, in row-major order of the leading axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers<T> {
    /// Length of each leading axis of the answers; the number of rows is the product. Empty for a
    /// single row of single poses.
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
