//! Building programs with Cargo, and where they are afterwards.

use std::io::BufReader;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::{Artifact, Message};

/// Returns the command that runs the Cargo that runs this chore.
pub(crate) fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a build command of Cargo, `build` or `test --no-run` with their arguments, and returns the
/// artifacts that are programs.
///
/// One command builds the common dependencies of its programs once. Two commands might build them
/// twice, because Cargo unites the features that all programs of a command need.
///
/// # Errors
/// Returns an error if Cargo cannot be started or the build fails. Cargo has then printed the
/// reason.
pub(crate) fn programs(root: &Path, arguments: &[&str]) -> Result<Vec<Artifact>> {
    let mut build = cargo()
        .args(arguments)
        .args(["--message-format", "json-render-diagnostics"])
        .current_dir(root)
        .stdout(Stdio::piped())
        .spawn()
        .context("starting cargo")?;
    let messages = BufReader::new(build.stdout.take().context("the messages of cargo are piped")?);
    let mut programs = Vec::new();
    for message in Message::parse_stream(messages) {
        if let Message::CompilerArtifact(artifact) = message?
            && artifact.executable.is_some()
        {
            programs.push(artifact);
        }
    }
    ensure!(build.wait()?.success(), "the build failed");
    Ok(programs)
}
