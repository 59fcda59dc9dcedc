//! Errors of rigs: the problem and its place.

use std::fmt;

/// The error for a rig that cannot be animated: the problem, and the bone, joint, vertex or key
/// that causes it.
#[derive(Clone, Debug, PartialEq)]
pub struct RigError {
    kind: RigErrorKind,
    place: RigPlace,
}

/// The ways in which a rig can be invalid.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RigErrorKind {
    /// A number is NaN or infinite.
    NonFinite {
        /// Name of the value, such as `"translation"` or `"key"`.
        what: &'static str,
    },
    /// A number is finite but so large that products could overflow: its magnitude exceeds 2^64, or
    /// 2^100 after bones are composed.
    OutOfRange {
        /// Name of the value.
        what: &'static str,
    },
    /// An index refers to something that does not exist.
    Missing {
        /// Kind of the missing thing, such as `"bone"`, `"joint"` or `"vertex"`.
        what: &'static str,
        /// The index.
        index: usize,
        /// Number of existing things of this kind.
        len: usize,
    },
    /// A bone is its own ancestor.
    Cyclic,
    /// A scale is zero on some axis, so everything attached to the bone would have no size.
    ZeroScale,
    /// A quaternion is zero and gives no rotation.
    ZeroRotation,
    /// Weights do not sum to one.
    WeightSum {
        /// The sum of the weights.
        sum: f64,
    },
    /// A weight is negative.
    NegativeWeight,
    /// The times of keys do not increase.
    TimesNotIncreasing,
    /// A list has the wrong length.
    OtherCount {
        /// Kind of the listed things.
        what: &'static str,
        /// The actual length.
        count: usize,
        /// The expected length.
        expected: usize,
    },
    /// There is nothing to bound, because there are no faces or no parts.
    Empty,
    /// A count exceeds the limit for a rig of this size.
    TooMany {
        /// Kind of the counted things.
        what: &'static str,
        /// The actual number.
        count: u64,
        /// The maximum number.
        limit: u64,
    },
    /// The speed of a motion between two keys has no bound, so nothing can be proved about it.
    UnboundedMotion,
}

/// The place in a rig that an error is about. All indices count from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RigPlace {
    /// A bone of the skeleton.
    Bone(usize),
    /// A joint of the skin.
    Joint(usize),
    /// A vertex of the skin.
    Vertex(usize),
    /// A face of the skin.
    Face(usize),
    /// A morph target of the skin.
    Morph(usize),
    /// A key of an animation channel: its time or its values.
    Key {
        /// Index of the animation.
        animation: usize,
        /// Index of the channel in the animation.
        channel: usize,
        /// Index of the key in the channel.
        key: usize,
    },
    /// A channel of an animation.
    Channel {
        /// Index of the animation.
        animation: usize,
        /// Index of the channel in the animation.
        channel: usize,
    },
    /// The rig as a whole.
    Rig,
}

impl RigError {
    /// Builds an error of this kind at this place.
    #[must_use]
    pub fn new(kind: RigErrorKind, place: RigPlace) -> Self {
        Self { kind, place }
    }

    /// Returns the kind of the error, for programs.
    #[must_use]
    pub fn kind(&self) -> &RigErrorKind {
        &self.kind
    }

    /// Returns which bone, joint, vertex, face, morph target, channel or key the error is about.
    #[must_use]
    pub fn place(&self) -> RigPlace {
        self.place
    }
}

impl fmt::Display for RigErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { what } => write!(f, "the {what} has a number that is NaN or infinite"),
            Self::OutOfRange { what } => write!(f, "the {what} has a number that is out of range: scale the rig down"),
            Self::Missing { what, index, len } => write!(f, "refers to {what} {index}, but there are only {len}"),
            Self::Cyclic => write!(f, "is its own ancestor: remove the cycle of parents"),
            Self::ZeroScale => write!(f, "the scale is zero on an axis: use a small nonzero scale"),
            Self::ZeroRotation => {
                write!(f, "the rotation is a zero quaternion: use 1, 0, 0, 0 (w, x, y, z) for no rotation")
            }
            Self::WeightSum { sum } => write!(f, "the weights sum to {sum}, not to 1: normalize them"),
            Self::NegativeWeight => write!(f, "a weight is negative: weights must be 0 or more"),
            Self::TimesNotIncreasing => {
                write!(f, "the times of the keys do not increase: sort them and remove duplicates")
            }
            Self::OtherCount { what, count, expected } => write!(f, "has {count} {what}, but {expected} are needed"),
            Self::Empty => write!(f, "nothing to bound: at least one face and one part are needed"),
            Self::TooMany { what, count, limit } => {
                write!(f, "has {count} {what}, but at most {limit} are possible: remove keys, or simplify the mesh")
            }
            Self::UnboundedMotion => {
                write!(f, "the speed between two keys has no bound, as when a spline of rotations nears zero: add keys")
            }
        }
    }
}

impl fmt::Display for RigPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bone(i) => write!(f, "bone {i}"),
            Self::Joint(i) => write!(f, "joint {i}"),
            Self::Vertex(i) => write!(f, "vertex {i}"),
            Self::Face(i) => write!(f, "face {i}"),
            Self::Morph(i) => write!(f, "morph target {i}"),
            Self::Key { animation, channel, key } => write!(f, "animation {animation}, channel {channel}, key {key}"),
            Self::Channel { animation, channel } => write!(f, "animation {animation}, channel {channel}"),
            Self::Rig => write!(f, "the rig"),
        }
    }
}

impl fmt::Display for RigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.kind)
    }
}

impl std::error::Error for RigError {}

/// Maximum magnitude of the numbers of a rig: 2^64.
const LIMIT: f64 = (1_u128 << 64) as f64;

/// Checks that the numbers of one value are finite and in range. `what` names the value in the
/// error.
pub(super) fn check_numbers(numbers: &[f64], what: &'static str, place: RigPlace) -> Result<(), RigError> {
    if !numbers.iter().all(|x| x.is_finite()) {
        return Err(RigError::new(RigErrorKind::NonFinite { what }, place));
    }
    if !numbers.iter().all(|x| x.abs() <= LIMIT) {
        return Err(RigError::new(RigErrorKind::OutOfRange { what }, place));
    }
    Ok(())
}
