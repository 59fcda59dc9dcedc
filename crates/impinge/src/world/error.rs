//! Why a world did not do what it was told.

use std::fmt;

use super::body::BodyId;
use crate::input::InputError;

/// Why a world refused; it is as it was before.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WorldError {
    /// The body is not, or no longer, in this world.
    Stale {
        /// The handle that was given.
        body: BodyId,
    },
    /// A step was to move a static body.
    Static {
        /// The body.
        body: BodyId,
    },
    /// The pose, the shape or the mesh does not suit the body.
    Input {
        /// The body; none where it was to be inserted.
        body: Option<BodyId>,
        /// What is wrong.
        error: InputError,
    },
    /// Only a body that is a mesh can be refitted.
    NotAMesh {
        /// The body.
        body: BodyId,
    },
    /// There are 2^32 - 1 bodies, or there were so many in one place that its handles are spent.
    Full,
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stale { body } => write!(f, "body {body} is not in this world (any more)"),
            Self::Static { body } => write!(f, "body {body} is static: a step cannot move it"),
            Self::Input { body: Some(body), error } => write!(f, "body {body}: {error}"),
            Self::Input { body: None, error } => write!(f, "the body cannot be inserted: {error}"),
            Self::NotAMesh { body } => write!(f, "body {body} is not a mesh, so it cannot be refitted"),
            Self::Full => write!(f, "there are no more handles"),
        }
    }
}

impl std::error::Error for WorldError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl From<InputError> for WorldError {
    /// An error that belongs to no body in the world.
    fn from(error: InputError) -> Self {
        Self::Input { body: None, error }
    }
}
