//! `impinge completions`: prints the script that completes arguments in a shell.

use clap::{Args, Command};
use clap_complete::Shell;

use crate::failure::Failure;
use crate::{Verdict, console};

/// Print a script that completes arguments in a shell
///
/// For bash: impinge completions bash > ~/.local/share/bash-completion/completions/impinge. For
/// zsh: write it to a file `_impinge` in a folder of `fpath`. For fish: write it to
/// ~/.config/fish/completions/impinge.fish.
///
/// Exit code: 0 if the script was printed, 2 if not.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The shell that will read the script
    shell: Shell,
}

/// Prints the completion script of `command`, the whole command line.
///
/// # Errors
/// Returns an error if standard output cannot be written.
pub(crate) fn run(arguments: &Arguments, mut command: Command) -> Result<Verdict, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "impinge", &mut script);
    console::print_answer(&String::from_utf8_lossy(&script))?;
    Ok(Verdict::Clear)
}
