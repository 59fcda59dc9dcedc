//! `impinge man`: writes the manual pages of the command and of each subcommand.

use std::fs;
use std::path::PathBuf;

use clap::{Args, Command};

use crate::Verdict;
use crate::failure::Failure;

/// Write the manual pages to a folder
///
/// Writes impinge.1 and a page for each command, such as impinge-check.1. To read one: man -l
/// FOLDER/impinge-check.1. To install them: impinge man ~/.local/share/man/man1.
///
/// Exit code: 0 if the pages were written, 2 if not.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder to write to, which is created if it does not exist
    folder: PathBuf,
}

/// Writes the pages of `command`, the whole command line.
///
/// # Errors
/// Returns an error if the folder cannot be created or a page cannot be written.
pub(crate) fn run(arguments: &Arguments, command: Command) -> Result<Verdict, Failure> {
    let folder = &arguments.folder;
    fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(command, folder))
        .map_err(|error| Failure::from_io(&error, "the manual pages cannot be written").in_file(folder))?;
    Ok(Verdict::Clear)
}
