//! Errors of worlds.

use std::collections::TryReserveError;
use std::fmt;

use super::body::BodyId;
use crate::budget::Stopped;
use crate::input::InputError;

/// The reason why a world refused a call. The world is unchanged.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WorldError {
    /// The body is not in this world, or was removed from it.
    Stale {
        /// The handle that was passed.
        body: BodyId,
    },
    /// A step was asked to move a static body.
    Static {
        /// Handle of the body.
        body: BodyId,
    },
    /// The pose, the shape or the mesh is invalid for the body.
    Input {
        /// Handle of the body, or `None` if the body was to be inserted.
        body: Option<BodyId>,
        /// The error of the input.
        error: InputError,
    },
    /// The body is not a mesh, so it cannot be refitted.
    NotAMesh {
        /// Handle of the body.
        body: BodyId,
    },
    /// All 2^32 - 1 slots for bodies are in use, or have used up their handles.
    Full,
    /// The budget of the step was spent, or the memory for its pairs cannot be allocated.
    Stopped(Stopped),
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stale { body } => write!(f, "body {body} is not in this world (any more)"),
            Self::Static { body } => write!(f, "body {body} is static, so a step cannot move it: set its pose instead"),
            Self::Input { body: Some(body), error } => write!(f, "body {body}: {error}"),
            Self::Input { body: None, error } => write!(f, "the body cannot be inserted: {error}"),
            Self::NotAMesh { body } => {
                write!(f, "body {body} is not a mesh, so it cannot be refitted: set its shape instead")
            }
            Self::Stopped(Stopped::Memory) => {
                write!(f, "not enough memory for the pairs of the world: spread its bodies, or filter their pairs")
            }
            Self::Stopped(reason) => write!(f, "{reason}"),
            Self::Full => write!(f, "the world has no free places for bodies (at most 2^32 - 1): remove some first"),
        }
    }
}

impl std::error::Error for WorldError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input { error, .. } => Some(error),
            Self::Stopped(reason) => Some(reason),
            _ => None,
        }
    }
}

impl From<Stopped> for WorldError {
    fn from(reason: Stopped) -> Self {
        Self::Stopped(reason)
    }
}

impl From<TryReserveError> for WorldError {
    fn from(error: TryReserveError) -> Self {
        Self::Stopped(error.into())
    }
}

impl From<InputError> for WorldError {
    /// Returns an error that refers to no body in the world.
    fn from(error: InputError) -> Self {
        Self::Input { body: None, error }
    }
}
