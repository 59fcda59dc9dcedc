//! Problems of robot descriptions.

use std::fmt;

use impinge::robot::RobotError;

use crate::{pieces::PieceProblem, text::name};

/// A problem of a robot description, which names the link or joint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RobotProblem {
    /// The links and joints are not a robot.
    Tree(RobotError),
    /// A shape of a link cannot be made.
    Link {
        /// Name of the link.
        link: String,
        /// The problem of the shape.
        problem: PieceProblem,
    },
}

impl fmt::Display for RobotProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tree(error) => write!(f, "{error}"),
            Self::Link { link, problem } => write!(f, "link {:?}: {problem}", name(link.as_bytes())),
        }
    }
}
