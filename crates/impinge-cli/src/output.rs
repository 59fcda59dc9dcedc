//! Files that the command writes: refused before any work, written after it.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use same_file::is_same_file;

use crate::failure::Failure;

/// Held while a file is written.
static WRITING: Mutex<()> = Mutex::new(());

/// Whether what is being written is wanted no more.
static ABANDONED: AtomicBool = AtomicBool::new(false);

/// Refuses an output that is one of the inputs, also by another name or link, or whose folder does
/// not exist.
///
/// # Errors
/// As said.
pub(crate) fn judge(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    if inputs.iter().any(|input| is_same_file(input, output).unwrap_or(false)) {
        return Err(Failure::new("output", "would overwrite an input").in_file(output).hint("choose another name"));
    }
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let hint = format!("create the folder {} first", folder.display());
        return Err(Failure::new("output", "its folder does not exist").in_file(output).hint(hint));
    }
    Ok(())
}

/// The extension in lower case.
pub(crate) fn extension(output: &Path) -> String {
    output.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The output's name ends in none of the extensions that say what to write.
pub(crate) fn unknown_extension(output: &Path, known: &str) -> Failure {
    Failure::new("output", "its extension does not say what to write")
        .in_file(output)
        .hint(format!("end it in {known}"))
}

/// Writes a file, or replaces it when the new one is complete.
///
/// # Errors
/// The system refuses, or the write is [abandoned](abandon). The old file stays.
pub(crate) fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    // Nobody waits for a pipe that is not read.
    let is_file = path.metadata().map_or(true, |found| found.is_file());
    let _writing = is_file.then(|| WRITING.lock().unwrap_or_else(PoisonError::into_inner));
    let written = impinge_files::replace_file(path, |out| content(&mut Abandonable(out)));
    written.map_err(|error| Failure::from_io(&error, "cannot be written").in_file(path))
}

/// Ends the write that is under way, if there is one, and waits until nothing is left of it. No file is written after
/// this: the process is about to end.
pub(crate) fn abandon() {
    ABANDONED.store(true, Ordering::SeqCst);
    std::mem::forget(WRITING.lock());
}

/// Refuses bytes once they are wanted no more.
struct Abandonable<'a>(&'a mut dyn Write);

impl Write for Abandonable<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if ABANDONED.load(Ordering::SeqCst) {
            return Err(io::Error::other("interrupted"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
