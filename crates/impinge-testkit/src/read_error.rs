//! Error of reading a file.

use std::fmt;
use std::path::{Path, PathBuf};

/// Error of reading a file of cases or data.
#[derive(Debug)]
pub struct ReadError {
    /// File or folder that could not be read.
    pub path: PathBuf,
    /// Description of the error and its place.
    pub message: String,
}

impl ReadError {
    pub(crate) fn new(path: &Path, message: impl ToString) -> Self {
        Self { path: path.to_owned(), message: message.to_string() }
    }
}

/// Reads the text of a file.
pub(crate) fn read_text(path: &Path) -> Result<String, ReadError> {
    std::fs::read_to_string(path).map_err(|error| ReadError::new(path, error))
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.message)
    }
}

impl std::error::Error for ReadError {}
