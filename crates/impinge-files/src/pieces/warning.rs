//! Warnings about descriptions of robots and scenes.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::error::Place;

/// Content of the description of a robot or a scene that was skipped, guessed, or may surprise a
/// user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DescriptionWarning {
    /// The file.
    pub path: PathBuf,
    /// The place in it, if the warning has one.
    pub place: Option<Place>,
    /// Description for people.
    pub message: String,
}

impl fmt::Display for DescriptionWarning {
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
pub(crate) struct Notes<'p> {
    path: &'p Path,
    warnings: Vec<DescriptionWarning>,
}

impl<'p> Notes<'p> {
    pub(crate) fn new(path: &'p Path) -> Self {
        Self { path, warnings: Vec::new() }
    }

    /// Adds a warning about an element, whose line `place` returns.
    pub(crate) fn add(&mut self, place: impl FnOnce() -> Place, message: String) {
        // Finding a line takes time linear in the size of the file.
        if self.warnings.len() < MAX_WARNINGS {
            self.push(Some(place()), message);
        }
    }

    /// Adds a warning about the whole file.
    pub(crate) fn add_about_all(&mut self, message: String) {
        self.push(None, message);
    }

    fn push(&mut self, place: Option<Place>, message: String) {
        self.warnings.push(DescriptionWarning { path: self.path.to_owned(), place, message });
    }

    pub(crate) fn into_vec(self) -> Vec<DescriptionWarning> {
        self.warnings
    }
}
