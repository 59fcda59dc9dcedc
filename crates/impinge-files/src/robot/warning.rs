//! Warnings about robot descriptions.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::error::Place;

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

    pub(super) fn add(&mut self, place: impl Into<Option<Place>>, message: String) {
        if self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(RobotWarning { path: self.path.to_owned(), place: place.into(), message });
        }
    }

    pub(super) fn into_vec(self) -> Vec<RobotWarning> {
        self.warnings
    }
}
