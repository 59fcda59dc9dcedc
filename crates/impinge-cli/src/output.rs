//! Output files: their names are validated before any work, and they are written after it.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use same_file::is_same_file;

use crate::failure::Failure;

/// Lock that is held while a file is written.
static WRITING: Mutex<()> = Mutex::new(());

/// Whether the process is about to end, so that writes must fail.
static ABANDONED: AtomicBool = AtomicBool::new(false);

/// Validates the name of an output file before any work.
///
/// # Errors
/// Returns an error if the output is also an input, possibly under another name or link, or if its
/// folder does not exist.
pub(crate) fn validate(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    if inputs.iter().any(|input| is_same_file(input, output).unwrap_or(false)) {
        return Err(Failure::new("output", "the output would overwrite an input")
            .in_file(output)
            .hint("choose another name"));
    }
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let hint = format!("create the folder {} first", folder.display());
        return Err(Failure::new("output", "the folder of the output does not exist").in_file(output).hint(hint));
    }
    Ok(())
}

/// Validates the name of a page before any work: it ends in `.html`, and as [`validate`] does.
///
/// # Errors
/// Returns an error if the name is invalid.
pub(crate) fn validate_page(page: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    if extension(page) == "html" { validate(page, inputs) } else { Err(unknown_extension(page, ".html")) }
}

/// Returns the extension in lower case.
pub(crate) fn extension(output: &Path) -> String {
    output.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Builds the failure for an output whose extension is not in `known`.
pub(crate) fn unknown_extension(output: &Path, known: &str) -> Failure {
    Failure::new("output", "unknown extension for an output file")
        .in_file(output)
        .hint(format!("use a name that ends in {known}"))
}

/// Writes a file. An existing file is replaced only after the new one is complete.
///
/// # Errors
/// Returns an error if the file cannot be written, or the write is [abandoned](abandon). The old
/// file is then unchanged.
pub(crate) fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    // Take no lock for a pipe: if nobody reads it, `abandon` would wait forever.
    let is_file = path.metadata().map_or(true, |found| found.is_file());
    let _writing = is_file.then(|| WRITING.lock().unwrap_or_else(PoisonError::into_inner));
    let written = impinge_files::replace_file(path, |out| content(&mut Abandonable(out)));
    written.map_err(|error| Failure::from_io(&error, "cannot be written").in_file(path))
}

/// Makes the running write fail, if there is one, and waits until its temporary file is removed.
/// Later writes never start: the process is about to end.
pub(crate) fn abandon() {
    ABANDONED.store(true, Ordering::SeqCst);
    std::mem::forget(WRITING.lock());
}

/// A writer that fails once writes are abandoned.
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
