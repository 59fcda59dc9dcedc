//! Reasons why a search for clashes has no answer.

use std::error::Error;
use std::fmt;

use crate::budget::Stopped;
use crate::input::InputError;

/// The error that a search for clashes has no answer.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ClashError {
    /// A label is empty, has a slash, or belongs to two scenes.
    Label {
        /// The label.
        label: String,
    },
    /// A tolerance or a clearance is negative or not finite.
    Length {
        /// Name of the length.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// A rule names a set that is not defined.
    UnknownSet {
        /// Name of the set.
        set: String,
        /// Name of the rule.
        rule: String,
        /// Names of the sets that are defined.
        known: Vec<String>,
    },
    /// A set of a rule has no parts.
    EmptySet {
        /// Name of the set.
        set: String,
        /// Name of the first rule that uses the set.
        rule: String,
        /// Types of the parts of all scenes, sorted. Types that are empty are left out.
        types: Vec<String>,
    },
    /// A part cannot be placed at its pose.
    Part {
        /// Name of the part.
        name: String,
        /// The error of the pose.
        error: InputError,
    },
    /// The search was canceled, or memory ran out.
    Stopped(Stopped),
}

/// Maximum number of types in the text of an error. More would hide its beginning.
const MAX_TYPES: usize = 12;

impl fmt::Display for ClashError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Label { label } => write!(
                f,
                "the label {label:?} is empty, has a slash, or belongs to two scenes: give each scene its own label"
            ),
            Self::Length { name, value } => {
                write!(f, "the {name} is {value}: it must be a finite number of at least 0")
            }
            Self::UnknownSet { set, rule, known } => {
                write!(f, "rule {rule:?} names the set {set:?}, which is not defined: the sets are {}", list(known))
            }
            Self::EmptySet { set, rule, types } if types.is_empty() => {
                write!(f, "the set {set:?} of rule {rule:?} has no parts: no part of the scenes has a type")
            }
            Self::EmptySet { set, rule, types } => {
                write!(f, "the set {set:?} of rule {rule:?} has no parts: the types of the scenes are {}", list(types))
            }
            Self::Part { name, error } => write!(f, "part {name:?}: {error}"),
            Self::Stopped(stopped) => write!(f, "{stopped}"),
        }
    }
}

fn list(names: &[String]) -> String {
    let shown = names.iter().take(MAX_TYPES).map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_TYPES) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

impl Error for ClashError {}

impl From<Stopped> for ClashError {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}
