//! Warnings about robot descriptions.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::{
    error::Place,
    xml_tree::{Id, Tree},
};

/// Content of a robot description that was skipped, guessed, or may surprise a user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotWarning {
    /// The URDF or SRDF file.
    pub path: PathBuf,
    /// The place in it, if the warning has one.
    pub place: Option<Place>,
    /// Description for people.
    pub message: String,
}

impl fmt::Display for RobotWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(place) = &self.place {
            write!(f, ", {place}")?;
        }
        write!(f, ": {}", self.message)
    }
}

/// Maximum number of warnings that are kept for a file. A hostile file could have one for each
/// element.
const MAX_WARNINGS: usize = 1000;

/// Collects the warnings about one file.
pub(super) struct Notes<'p> {
    path: &'p Path,
    warnings: Vec<RobotWarning>,
}

impl<'p> Notes<'p> {
    pub(super) fn new(path: &'p Path) -> Self {
        Self { path, warnings: Vec::new() }
    }

    /// Adds a warning about an element.
    pub(super) fn add(&mut self, tree: &Tree<'_>, element: Id, message: String) {
        // Finding a line takes time linear in the size of the file.
        if self.warnings.len() < MAX_WARNINGS {
            self.push(Some(tree.place(element)), message);
        }
    }

    /// Adds a warning about the whole file.
    pub(super) fn add_about_all(&mut self, message: String) {
        self.push(None, message);
    }

    fn push(&mut self, place: Option<Place>, message: String) {
        self.warnings.push(RobotWarning { path: self.path.to_owned(), place, message });
    }

    pub(super) fn into_vec(self) -> Vec<RobotWarning> {
        self.warnings
    }
}
