//! Source files of the workspace, and a finding in one of them.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::Result;
use walkdir::WalkDir;

/// Broken rule and its place.
#[derive(Debug)]
pub(crate) struct Violation {
    /// File, relative to the root of the workspace if it lies below it.
    pub(crate) file: PathBuf,
    /// Line, counted from one.
    pub(crate) line: usize,
    /// Message: the text in question and the rule that forbids it.
    pub(crate) what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.what)
    }
}

/// Returns the files below `root` with one of the `extensions`, sorted. Build output,
/// packages and hidden folders are skipped.
pub(crate) fn files(root: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>> {
    let walk = WalkDir::new(root).sort_by_file_name().into_iter().filter_entry(|entry| {
        let name = entry.file_name().to_string_lossy();
        let is_output = entry.file_type().is_dir() && ["target", "node_modules"].contains(&&*name);
        entry.depth() == 0 || !(name.starts_with('.') || is_output)
    });
    let mut found = Vec::new();
    for entry in walk {
        let path = entry?.into_path();
        if path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)) {
            found.push(path);
        }
    }
    Ok(found)
}
