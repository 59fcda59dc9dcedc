//! Errors of worlds.

use std::collections::TryReserveError;
use std::fmt;

use super::body::BodyId;
use crate::input::InputError;
use crate::partition::Unfinished;

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
    /// The interrupt ended the step.
    Interrupted,
    /// The memory for the pairs of a step cannot be allocated.
    OutOfMemory(TryReserveError),
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
            Self::Interrupted => write!(f, "the step was interrupted"),
            Self::OutOfMemory(_) => {
                write!(f, "not enough memory for the pairs of the world: spread its bodies, or filter their pairs")
            }
            Self::Full => write!(f, "the world has no free places for bodies (at most 2^32 - 1): remove some first"),
        }
    }
}

impl std::error::Error for WorldError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input { error, .. } => Some(error),
            Self::OutOfMemory(error) => Some(error),
            _ => None,
        }
    }
}

impl From<Unfinished> for WorldError {
    fn from(unfinished: Unfinished) -> Self {
        match unfinished {
            Unfinished::Interrupted => Self::Interrupted,
            Unfinished::OutOfMemory(error) => Self::OutOfMemory(error),
        }
    }
}

impl From<TryReserveError> for WorldError {
    fn from(error: TryReserveError) -> Self {
        Self::OutOfMemory(error)
    }
}

impl From<InputError> for WorldError {
    /// Returns an error that refers to no body in the world.
    fn from(error: InputError) -> Self {
        Self::Input { body: None, error }
    }
}
