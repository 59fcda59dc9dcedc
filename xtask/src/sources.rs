//! The source files of the workspace, and a finding in one of them.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::Result;
use walkdir::WalkDir;

/// A broken rule and where it is broken.
#[derive(Debug)]
pub(crate) struct Violation {
    /// The file, relative to the root of the workspace where it lies below it.
    pub(crate) file: PathBuf,
    /// The line, counted from one.
    pub(crate) line: usize,
    /// What is written there and which rule forbids it.
    pub(crate) what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.what)
    }
}

/// The files below `root` with one of the `extensions`, sorted; build output and hidden folders are passed over.
pub(crate) fn files(root: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>> {
    let walk = WalkDir::new(root).sort_by_file_name().into_iter().filter_entry(|entry| {
        let name = entry.file_name().to_string_lossy();
        entry.depth() == 0 || !(name.starts_with('.') || (entry.file_type().is_dir() && name == "target"))
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
