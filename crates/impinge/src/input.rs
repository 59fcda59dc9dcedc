//! Typed errors for invalid input. Input is validated once, where it enters the library.

use std::fmt;

/// Says which input is invalid, where, and why. The [`Display`](fmt::Display) text also says what
/// to do about it if there is a hint.
#[derive(Clone, Debug, PartialEq)]
pub struct InputError {
    kind: InputErrorKind,
    hint: Option<&'static str>,
}

/// The ways in which an input can be invalid. Each names the vertex, face, row or entry at fault.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InputErrorKind {
    /// A number is NaN or infinite.
    NonFinite {
        /// Noun for the value that holds the number, such as `"vertex"` or `"pose entry"`.
        what: &'static str,
        /// Index of that value, counted from zero. For a pose: the entry in row-major order.
        index: usize,
    },
    /// A number is finite but outside the range for which the answers are proved.
    OutOfRange {
        /// Noun for the value that holds the number, such as `"vertex"` or `"pose entry"`.
        what: &'static str,
        /// Index of that value, counted from zero.
        index: usize,
        /// Maximum magnitude that is accepted, as text.
        limit: &'static str,
    },
    /// A face names a vertex that does not exist.
    IndexOutOfBounds {
        /// Index of the face, counted from zero.
        face: usize,
        /// The vertex index that the face names.
        index: u32,
        /// Number of vertices.
        len: usize,
    },
    /// There are more elements than the library accepts.
    TooMany {
        /// Noun for the elements, such as `"vertices"`, `"faces"` or `"parts"`.
        what: &'static str,
        /// Number of elements given.
        count: usize,
        /// Maximum number of elements that is accepted.
        limit: usize,
    },
    /// The memory for the result cannot be allocated.
    OutOfMemory {
        /// Noun for the elements that need the memory, such as `"faces"`.
        what: &'static str,
        /// Number of elements given.
        count: usize,
    },
    /// The number of elements differs from the number that is needed.
    OtherCount {
        /// Noun for the elements, such as `"vertices"`.
        what: &'static str,
        /// Number of elements given.
        count: usize,
        /// Number of elements needed.
        expected: usize,
    },
    /// The last row of a matrix is not 0, 0, 0, 1.
    NotAffine {
        /// The last row as given.
        last_row: [f64; 4],
    },
    /// The linear part of a matrix has no inverse. This is decided exactly.
    Singular,
    /// A quaternion is not of unit length.
    NotUnitQuaternion {
        /// Length of the quaternion, rounded.
        length: f64,
    },
    /// The length of a rotation axis is zero.
    ZeroAxis,
    /// There are no elements, so there is nothing to bound.
    Empty {
        /// Noun for the missing elements, such as `"points"`.
        what: &'static str,
    },
    /// A mesh is open, but a closed one is required.
    Open {
        /// Number of edges along which more faces run one way than the other.
        edges: usize,
    },
    /// A length is negative.
    Negative {
        /// Noun for the length, such as `"radius"` or `"half-extent"`.
        what: &'static str,
        /// Index of the length among the lengths of that noun, counted from zero.
        index: usize,
    },
    /// A map changes shapes, but a rigid motion is required.
    NotRigid {
        /// The Frobenius norm of RᵀR - I for the linear part R, rounded up.
        deviation: f64,
    },
    /// A shape cannot be rounded, because it is not one bounded convex set.
    NotRoundable {
        /// Noun for the shape, such as `"mesh"`.
        what: &'static str,
    },
    /// The direction of a ray is the zero vector.
    ZeroDirection {
        /// Index of the ray, counted from zero.
        index: usize,
    },
}

impl InputError {
    /// Returns an error of this kind, without a hint.
    #[must_use]
    pub fn new(kind: InputErrorKind) -> Self {
        Self { kind, hint: None }
    }

    /// Returns the same error with a hint that says what to do.
    #[must_use]
    pub fn with_hint(mut self, hint: &'static str) -> Self {
        self.hint = Some(hint);
        self
    }

    /// Returns the kind of error, for programs to match on.
    #[must_use]
    pub fn kind(&self) -> &InputErrorKind {
        &self.kind
    }

    /// Returns the hint that says what to do, or `None` if there is none.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        self.hint
    }

    /// Validates three numbers that are not part of a mesh, such as a query point. `what` and
    /// `index` name the row in the error.
    ///
    /// # Errors
    /// If a number is NaN or infinite, or its magnitude exceeds 2^300.
    pub(crate) fn validate_row(row: &[f64; 3], what: &'static str, index: usize) -> Result<(), Self> {
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
            InputErrorKind::TooMany { what, count, limit } => {
                write!(f, "{count} {what} are too many: the maximum is {limit}")?;
            }
            InputErrorKind::OutOfMemory { what, count } => write!(f, "there is not enough memory for {count} {what}")?,
            InputErrorKind::OtherCount { what, count, expected } => {
                write!(f, "{count} {what} were given, but {expected} are needed")?;
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
            InputErrorKind::Open { edges } => {
                write!(f, "the mesh is open: along {edges} edges more faces run one way than the other")?;
            }
            InputErrorKind::Negative { what, index } => write!(f, "{what} {index} is negative")?,
            InputErrorKind::NotRigid { deviation } => {
                write!(f, "the map is not rigid: it deviates from a rotation by {deviation:e}")?;
            }
            InputErrorKind::NotRoundable { what } => {
                write!(f, "a {what} cannot be rounded, only one bounded convex shape can")?;
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
