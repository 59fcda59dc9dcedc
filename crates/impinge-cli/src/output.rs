//! Files that are written: judged before any work, written after it.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::failure::Failure;

/// Refuses an output that would overwrite one of the inputs.
///
/// # Errors
/// Where `output` and an input are one file.
pub(crate) fn spare(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    let Ok(real) = fs::canonicalize(output) else { return Ok(()) }; // it does not exist yet
    if inputs.iter().any(|input| fs::canonicalize(input).is_ok_and(|input| input == real)) {
        return Err(Failure::new("output", "would overwrite an input").in_file(output).hint("choose another name"));
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

/// Writes a file, replacing what was there.
///
/// # Errors
/// Where the system refuses; what was written so far stays.
pub(crate) fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let written = File::create(path).and_then(|file| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        content(&mut out)?;
        out.flush()
    });
    written.map_err(|error| Failure::from_io(&error, "cannot be written").in_file(path))
}
