//! What a batch returns: a value and a status for each row.

use crate::input::{InputError, InputErrorKind};

/// How a row was answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[repr(u8)]
pub enum Status {
    /// The answer is the truth.
    #[default]
    Ok = 0,
    /// An entry of a pose is NaN or infinite. The answer is the safe one.
    NonFinite = 1,
    /// An entry of a pose is out of range. The answer is the safe one.
    OutOfRange = 2,
    /// The last row of a pose is not 0, 0, 0, 1. The answer is the safe one.
    NotAffine = 3,
    /// The linear part of a pose has no inverse. The answer is the safe one.
    Singular = 4,
    /// Nothing was proved. The answer is the safe one.
    Undecided = 5,
    /// A pose is more than 1e-4 from a rigid motion, and the shape is round. The answer is the safe one.
    NotRigid = 6,
}

/// The answers to a question about many poses, in row-major order of the leading axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers<T> {
    /// The leading axes; none if a single pose was asked about.
    pub shape: Vec<usize>,
    /// The answer of each row.
    pub values: Vec<T>,
    /// The status of each row.
    pub status: Vec<Status>,
}

impl Status {
    /// Returns the status of a row with a faulty pose.
    pub(crate) fn of(error: &InputError) -> Self {
        match error.kind() {
            InputErrorKind::NonFinite { .. } => Self::NonFinite,
            InputErrorKind::OutOfRange { .. } => Self::OutOfRange,
            InputErrorKind::NotAffine { .. } => Self::NotAffine,
            InputErrorKind::NotRigid { .. } => Self::NotRigid,
            // A matrix has no other faults.
            _ => Self::Singular,
        }
    }
}

impl<T> Answers<T> {
    /// Returns the same with each answer made into another.
    #[must_use]
    pub fn map<U>(self, of: impl FnMut(T) -> U) -> Answers<U> {
        Answers { shape: self.shape, values: self.values.into_iter().map(of).collect(), status: self.status }
    }

    /// Gives the answers that `is_undecided` that status.
    pub(crate) fn judged(mut self, is_undecided: impl Fn(&T) -> bool) -> Self {
        for (status, value) in self.status.iter_mut().zip(&self.values) {
            if *status == Status::Ok && is_undecided(value) {
                *status = Status::Undecided;
            }
        }
        self
    }
}
