//! The typed errors of bad input, which is judged once, where it enters the library.

use std::fmt;

/// What is wrong with an input, and where; its [`Display`](fmt::Display) text says both and, where it helps, what to do.
#[derive(Clone, Debug, PartialEq)]
pub struct InputError {
    kind: InputErrorKind,
    hint: Option<&'static str>,
}

/// The ways in which an input can be wrong; each names the vertex, face, row or entry that is at fault.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InputErrorKind {
    /// A number is NaN or infinite.
    NonFinite {
        /// What the number belongs to: `"vertex"`, `"pose entry"`.
        what: &'static str,
        /// Which one, counted from zero; for a pose the entry in row-major order.
        index: usize,
    },
    /// A number is finite but outside the range for which the answers are proved.
    OutOfRange {
        /// What the number belongs to.
        what: &'static str,
        /// Which one, counted from zero.
        index: usize,
        /// The bound that its magnitude must stay within.
        limit: &'static str,
    },
    /// A face names a vertex that does not exist.
    IndexOutOfBounds {
        /// The face, counted from zero.
        face: usize,
        /// The vertex that it names.
        index: u32,
        /// How many vertices there are.
        len: usize,
    },
    /// More vertices or faces than 32-bit indices can name.
    TooMany {
        /// `"vertices"` or `"faces"`.
        what: &'static str,
        /// How many were given.
        count: usize,
    },
    /// Another number of something than there has to be.
    OtherCount {
        /// `"vertices"`.
        what: &'static str,
        /// How many were given.
        count: usize,
        /// How many there have to be.
        expected: usize,
    },
    /// A matrix whose last row is not 0, 0, 0, 1.
    NotAffine {
        /// The last row as given.
        last_row: [f64; 4],
    },
    /// A matrix whose linear part has no inverse, decided exactly.
    Singular,
    /// A quaternion too short, too long or not of unit length.
    NotUnitQuaternion {
        /// Its length.
        length: f64,
    },
    /// A rotation axis of length zero.
    ZeroAxis,
    /// There is nothing to bound.
    Empty {
        /// What there is none of: `"points"`.
        what: &'static str,
    },
    /// A length that is below zero.
    Negative {
        /// What the number is: `"radius"`, `"half-extent"`.
        what: &'static str,
        /// Which one, counted from zero.
        index: usize,
    },
    /// A map that changes shapes, where only a rigid motion will do.
    NotRigid {
        /// The Frobenius norm of RᵀR - I for the linear part R, rounded up.
        deviation: f64,
    },
    /// A ray without a direction.
    ZeroDirection {
        /// Which ray, counted from zero.
        index: usize,
    },
}

impl InputError {
    /// An error of this kind, without a hint.
    #[must_use]
    pub fn new(kind: InputErrorKind) -> Self {
        Self { kind, hint: None }
    }

    /// The same error with a hint about what to do.
    #[must_use]
    pub fn with_hint(mut self, hint: &'static str) -> Self {
        self.hint = Some(hint);
        self
    }

    /// What is wrong, for a program.
    #[must_use]
    pub fn kind(&self) -> &InputErrorKind {
        &self.kind
    }

    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        self.hint
    }

    /// Judges three numbers that are not part of a mesh, such as a point that is asked about: row `index` of `what`.
    ///
    /// # Errors
    /// Where one is not finite, or beyond 2^300.
    pub(crate) fn judge_row(row: &[f64; 3], what: &'static str, index: usize) -> Result<(), Self> {
        const LIMIT: f64 = f64::from_bits((1023 + 300) << 52);
        if !row.iter().all(|x| x.is_finite()) {
            return Err(Self::new(InputErrorKind::NonFinite { what, index }));
        }
        if !row.iter().all(|x| x.abs() <= LIMIT) {
            return Err(Self::new(InputErrorKind::OutOfRange { what, index, limit: "2^300" }));
        }
        Ok(())
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            InputErrorKind::NonFinite { what, index } => write!(f, "{what} {index} is not finite")?,
            InputErrorKind::OutOfRange { what, index, limit } => {
                write!(f, "{what} {index} is out of range: its magnitude must be at most {limit}")?;
            }
            InputErrorKind::IndexOutOfBounds { face, index, len } => {
                write!(f, "face {face} names vertex {index}, but there are {len} vertices")?;
            }
            InputErrorKind::TooMany { what, count } => {
                write!(f, "{count} {what} are more than 32-bit indices can name")?
            }
            InputErrorKind::OtherCount { what, count, expected } => {
                write!(f, "{count} {what} were given where there are {expected}")?;
            }
            InputErrorKind::NotAffine { last_row } => {
                write!(f, "the last row of the matrix is {last_row:?}, not [0, 0, 0, 1]")?;
            }
            InputErrorKind::Singular => write!(f, "the linear part of the matrix is singular")?,
            InputErrorKind::NotUnitQuaternion { length } => {
                write!(f, "the quaternion has length {length}, not 1")?;
            }
            InputErrorKind::ZeroAxis => write!(f, "the rotation axis has length zero")?,
            InputErrorKind::Empty { what } => write!(f, "there are no {what}")?,
            InputErrorKind::Negative { what, index } => write!(f, "{what} {index} is negative")?,
            InputErrorKind::NotRigid { deviation } => {
                write!(f, "the map is not rigid: it deviates from a rotation by {deviation:e}")?;
            }
            InputErrorKind::ZeroDirection { index } => write!(f, "the direction of ray {index} is zero")?,
        }
        match self.hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for InputError {}
