//! Errors about robots and their configurations.

use std::error::Error;
use std::fmt;

use crate::input::InputError;

/// The error that links and joints are not a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RobotError {
    /// There are no links.
    NoLinks,
    /// Two links have the same name.
    LinkNameTaken {
        /// The name.
        link: String,
    },
    /// Two joints have the same name.
    JointNameTaken {
        /// The name.
        joint: String,
    },
    /// A joint names a link that does not exist.
    UnknownLink {
        /// Name of the joint.
        joint: String,
        /// Name of the missing link.
        link: String,
    },
    /// A link is the child of two joints.
    TwoParents {
        /// Name of the link.
        link: String,
        /// Names of two joints whose child it is.
        joints: [String; 2],
    },
    /// Joints form a cycle.
    Cycle {
        /// Name of a link of the cycle.
        link: String,
    },
    /// More than one link has no parent.
    SeveralRoots {
        /// Names of the links without a parent.
        links: Vec<String>,
    },
    /// The axis of a joint is zero, NaN or infinite.
    Axis {
        /// Name of the joint.
        joint: String,
    },
    /// A limit is NaN, or the lower limit is above the upper limit.
    Limits {
        /// Name of the joint.
        joint: String,
        /// The limits.
        limits: [f64; 2],
    },
    /// The pose of a joint is not rigid.
    Origin {
        /// Name of the joint.
        joint: String,
        /// The error of the pose.
        error: InputError,
    },
    /// A joint follows a joint that does not exist.
    UnknownMimic {
        /// Name of the joint.
        joint: String,
        /// Name of the missing joint.
        followed: String,
    },
    /// A joint follows itself, directly or through other joints.
    MimicCycle {
        /// Name of the joint.
        joint: String,
    },
    /// A joint that does not have exactly one coordinate follows another or is followed.
    MimicKind {
        /// Name of the joint.
        joint: String,
    },
    /// A factor or an offset of a joint that follows another is NaN or infinite.
    MimicNumber {
        /// Name of the joint.
        joint: String,
    },
    /// Too many links have a shape.
    TooManyShapes {
        /// Maximum number of links with a shape.
        limit: usize,
    },
}

impl RobotError {
    /// Returns the name of the link or joint at fault, with the noun: `link "arm"`. Returns `None`
    /// if the whole robot is at fault.
    #[must_use]
    pub fn subject(&self) -> Option<String> {
        let (noun, name) = match self {
            Self::NoLinks | Self::SeveralRoots { .. } | Self::TooManyShapes { .. } => return None,
            Self::LinkNameTaken { link } | Self::TwoParents { link, .. } | Self::Cycle { link } => ("link", link),
            Self::JointNameTaken { joint }
            | Self::UnknownLink { joint, .. }
            | Self::Axis { joint }
            | Self::Limits { joint, .. }
            | Self::Origin { joint, .. }
            | Self::UnknownMimic { joint, .. }
            | Self::MimicCycle { joint }
            | Self::MimicKind { joint }
            | Self::MimicNumber { joint } => ("joint", joint),
        };
        Some(format!("{noun} {name:?}"))
    }
}

impl fmt::Display for RobotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(subject) = self.subject() {
            write!(f, "{subject}: ")?;
        }
        match self {
            Self::NoLinks => f.write_str("the robot has no links"),
            Self::LinkNameTaken { .. } => f.write_str("another link has the same name"),
            Self::JointNameTaken { .. } => f.write_str("another joint has the same name"),
            Self::UnknownLink { link, .. } => write!(f, "there is no link {link:?}"),
            Self::TwoParents { joints: [a, b], .. } => {
                write!(f, "it is the child of the joints {a:?} and {b:?}; a link has one parent")
            }
            Self::Cycle { .. } => f.write_str("the joints above it form a cycle; they must form a tree"),
            Self::SeveralRoots { links } => {
                let shown: Vec<String> = links.iter().take(4).map(|link| format!("{link:?}")).collect();
                let more = if links.len() > shown.len() { ", ..." } else { "" };
                write!(f, "{} links have no parent: {}{more}; add joints between them", links.len(), shown.join(", "))
            }
            Self::Axis { .. } => f.write_str("its axis has no direction: it is zero, NaN or infinite"),
            Self::Limits { limits: [lower, upper], .. } => {
                write!(f, "invalid limits: lower {lower}, upper {upper}; the lower one must not be above the upper one")
            }
            Self::Origin { error, .. } => write!(f, "its origin: {error}"),
            Self::UnknownMimic { followed, .. } => write!(f, "it follows the joint {followed:?}, which does not exist"),
            Self::MimicCycle { .. } => f.write_str("it follows itself"),
            Self::MimicKind { .. } => f.write_str("only joints with one coordinate can follow or be followed"),
            Self::MimicNumber { .. } => f.write_str("its multiplier or offset is NaN or infinite"),
            Self::TooManyShapes { limit } => write!(f, "a robot has at most {limit} links with a shape"),
        }
    }
}

impl Error for RobotError {}

/// The error that a configuration is invalid.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConfigurationError {
    /// The number of values is not a multiple of the number of coordinates.
    Count {
        /// Number of values.
        count: usize,
        /// Number of coordinates of the robot.
        coordinates: usize,
    },
    /// A value is NaN or infinite.
    NonFinite {
        /// Index of the configuration.
        row: usize,
        /// Index of the coordinate.
        coordinate: usize,
    },
    /// An angle is above 2^20 in magnitude, or a length is above 2^128.
    OutOfRange {
        /// Index of the configuration.
        row: usize,
        /// Index of the coordinate.
        coordinate: usize,
    },
    /// All four numbers of a quaternion are zero.
    ZeroQuaternion {
        /// Index of the configuration.
        row: usize,
        /// Index of the first coordinate of the quaternion.
        coordinate: usize,
    },
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { count, coordinates } => {
                write!(f, "{count} values are not rows of {coordinates}, the number of coordinates of the robot")
            }
            Self::NonFinite { row, coordinate } => {
                write!(f, "configuration {row}, coordinate {coordinate}: NaN or infinite")
            }
            Self::OutOfRange { row, coordinate } => {
                write!(f, "configuration {row}, coordinate {coordinate}: an angle above 2^20 or a length above 2^128")
            }
            Self::ZeroQuaternion { row, coordinate } => {
                write!(f, "configuration {row}, coordinate {coordinate}: the quaternion is zero")
            }
        }
    }
}

impl Error for ConfigurationError {}
