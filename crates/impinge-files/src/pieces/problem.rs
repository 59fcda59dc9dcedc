//! Problems of pieces.

use std::{fmt, path::PathBuf};

use impinge::InputError;

use super::packages::Lost;
use crate::text::name;

/// A problem of a shape in the description of a robot or of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PieceProblem {
    /// The numbers of the shape are invalid, or its mesh is.
    Shape {
        /// The error.
        error: InputError,
    },
    /// A factor of the scale of a mesh is zero.
    ZeroScale,
    /// The mesh does not exist.
    MissingMesh {
        /// Reference to the mesh, as it is written in the file.
        uri: String,
        /// Paths that were tried. Empty if the package is not known.
        tried: Vec<PathBuf>,
    },
    /// A package is not known, and more than one file could be meant.
    AmbiguousMesh {
        /// Reference to the mesh, as it is written in the file.
        uri: String,
        /// The files that could be meant.
        candidates: Vec<PathBuf>,
    },
    /// The mesh could not be loaded.
    Mesh {
        /// The error, with the path of the mesh.
        message: String,
    },
}

/// Maximum number of paths that a message lists.
const SHOWN: usize = 4;

impl PieceProblem {
    pub(super) fn lost(lost: Lost, uri: &str) -> Self {
        let uri = uri.to_owned();
        match lost {
            Lost::Missing(tried) => Self::MissingMesh { uri, tried },
            Lost::Ambiguous(candidates) => Self::AmbiguousMesh { uri, candidates },
        }
    }
}

impl fmt::Display for PieceProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |paths: &[PathBuf]| {
            let shown: Vec<String> = paths.iter().take(SHOWN).map(|path| path.display().to_string()).collect();
            shown.join(", ") + if paths.len() > SHOWN { ", ..." } else { "" }
        };
        match self {
            Self::Shape { error } => write!(f, "{error}"),
            Self::ZeroScale => f.write_str("a factor of the scale of a mesh is zero"),
            Self::MissingMesh { uri, tried } => {
                let uri = name(uri.as_bytes());
                if tried.is_empty() {
                    return write!(f, "the package of the mesh {uri:?} is not known; state where it is with packages");
                }
                write!(f, "the mesh {uri:?} does not exist; tried {}", list(tried))
            }
            Self::AmbiguousMesh { uri, candidates } => {
                let uri = name(uri.as_bytes());
                write!(f, "the mesh {uri:?} could be {}; state where its package is with packages", list(candidates))
            }
            Self::Mesh { message } => f.write_str(message),
        }
    }
}
