//! Problems of robot descriptions.

use std::{fmt, path::PathBuf};

use impinge::{InputError, robot::RobotError};

use crate::text::name;

/// A problem of a robot description, which names the link or joint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RobotProblem {
    /// The links and joints are not a robot.
    Tree(RobotError),
    /// The numbers of a shape are invalid, or the mesh of a link is.
    Shape {
        /// Name of the link.
        link: String,
        /// The error.
        error: InputError,
    },
    /// A factor of the scale of a mesh is zero.
    ZeroScale {
        /// Name of the link.
        link: String,
    },
    /// A link uses a mesh that does not exist.
    MissingMesh {
        /// Name of the link.
        link: String,
        /// Reference to the mesh, as it is written in the file.
        uri: String,
        /// Paths that were tried. Empty if the package is not known.
        tried: Vec<PathBuf>,
    },
    /// A package is not known, and more than one file could be meant.
    AmbiguousMesh {
        /// Name of the link.
        link: String,
        /// Reference to the mesh, as it is written in the file.
        uri: String,
        /// The files that could be meant.
        candidates: Vec<PathBuf>,
    },
    /// A mesh of a link could not be loaded.
    Mesh {
        /// Name of the link.
        link: String,
        /// The error, with the path of the mesh.
        message: String,
    },
}

/// Maximum number of paths that a message lists.
const SHOWN: usize = 4;

impl fmt::Display for RobotProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let link = |f: &mut fmt::Formatter<'_>, link: &str| write!(f, "link {:?}: ", name(link.as_bytes()));
        let list = |paths: &[PathBuf]| {
            let shown: Vec<String> = paths.iter().take(SHOWN).map(|path| path.display().to_string()).collect();
            shown.join(", ") + if paths.len() > SHOWN { ", ..." } else { "" }
        };
        match self {
            Self::Tree(error) => write!(f, "{error}"),
            Self::Shape { link: of, error } => {
                link(f, of)?;
                write!(f, "{error}")
            }
            Self::ZeroScale { link: of } => {
                link(f, of)?;
                f.write_str("a factor of the scale of a mesh is zero")
            }
            Self::MissingMesh { link: of, uri, tried } => {
                link(f, of)?;
                let uri = name(uri.as_bytes());
                if tried.is_empty() {
                    return write!(f, "the package of the mesh {uri:?} is not known; state where it is with packages");
                }
                write!(f, "the mesh {uri:?} does not exist; tried {}", list(tried))
            }
            Self::AmbiguousMesh { link: of, uri, candidates } => {
                link(f, of)?;
                let uri = name(uri.as_bytes());
                write!(f, "the mesh {uri:?} could be {}; state where its package is with packages", list(candidates))
            }
            Self::Mesh { link: of, message } => {
                link(f, of)?;
                f.write_str(message)
            }
        }
    }
}
