//! What is wrong with a rig, and where in it.

use std::fmt;

/// A rig that cannot be animated: what is wrong, and at which of its bones, joints, vertices or keys.
#[derive(Clone, Debug, PartialEq)]
pub struct RigError {
    kind: RigErrorKind,
    place: RigPlace,
}

/// The ways in which a rig can be wrong.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RigErrorKind {
    /// A number is NaN or infinite.
    NonFinite {
        /// What the number belongs to: `"translation"`, `"key"`.
        what: &'static str,
    },
    /// A number is finite but too large for products of it to stay so: beyond 2^64, or 2^100 where bones are composed.
    OutOfRange {
        /// What the number belongs to.
        what: &'static str,
    },
    /// Something names another thing that does not exist.
    Missing {
        /// What is named: `"bone"`, `"joint"`, `"vertex"`.
        what: &'static str,
        /// Its number.
        index: usize,
        /// How many there are.
        len: usize,
    },
    /// A bone that is its own ancestor.
    Cyclic,
    /// A scale of zero on some axis: what hangs on the bone has no size.
    ZeroScale,
    /// A quaternion that names no rotation.
    ZeroRotation,
    /// Weights that do not sum up to one.
    WeightSum {
        /// What they sum up to.
        sum: f64,
    },
    /// A weight below zero.
    NegativeWeight,
    /// Times of keys that do not increase.
    TimesNotIncreasing,
    /// Another number of something than there has to be.
    OtherCount {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there have to be.
        expected: usize,
    },
    /// There is nothing to bound: no face.
    Empty,
    /// A motion whose speed between two keys has no bound, so that nothing can be promised about it.
    UnboundedMotion,
}

/// Where in a rig.
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
    /// A key of a channel of an animation, counted from zero; times and values alike.
    Key {
        /// The animation.
        animation: usize,
        /// The channel in it.
        channel: usize,
        /// The key in that.
        key: usize,
    },
    /// A channel of an animation.
    Channel {
        /// The animation.
        animation: usize,
        /// The channel in it.
        channel: usize,
    },
    /// The rig as a whole.
    Rig,
}

impl RigError {
    /// An error of this kind at this place.
    #[must_use]
    pub fn new(kind: RigErrorKind, place: RigPlace) -> Self {
        Self { kind, place }
    }

    /// What is wrong, for a program.
    #[must_use]
    pub fn kind(&self) -> &RigErrorKind {
        &self.kind
    }

    /// Where.
    #[must_use]
    pub fn place(&self) -> RigPlace {
        self.place
    }
}

impl fmt::Display for RigErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { what } => write!(f, "a number of the {what} is not finite"),
            Self::OutOfRange { what } => write!(f, "a number of the {what} is out of range"),
            Self::Missing { what, index, len } => write!(f, "names {what} {index}, but there are {len}"),
            Self::Cyclic => write!(f, "is its own ancestor"),
            Self::ZeroScale => write!(f, "the scale is zero"),
            Self::ZeroRotation => write!(f, "the quaternion is zero"),
            Self::WeightSum { sum } => write!(f, "the weights sum up to {sum}, not to 1"),
            Self::NegativeWeight => write!(f, "a weight is negative"),
            Self::TimesNotIncreasing => write!(f, "the times do not increase"),
            Self::OtherCount { what, count, expected } => write!(f, "{count} {what} in place of {expected}"),
            Self::Empty => write!(f, "has no faces"),
            Self::UnboundedMotion => write!(f, "the motion between two keys has no bound"),
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

/// Numbers of a rig are within 2^64.
const LIMIT: f64 = (1_u128 << 64) as f64;

/// Judges the numbers of one thing.
pub(super) fn judge(numbers: &[f64], what: &'static str, place: RigPlace) -> Result<(), RigError> {
    if !numbers.iter().all(|x| x.is_finite()) {
        return Err(RigError::new(RigErrorKind::NonFinite { what }, place));
    }
    if !numbers.iter().all(|x| x.abs() <= LIMIT) {
        return Err(RigError::new(RigErrorKind::OutOfRange { what }, place));
    }
    Ok(())
}
