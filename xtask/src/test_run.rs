//! `cargo xtask test`: builds and runs every test of the workspace, and prints the slowest tests
//! and the counts last.

use std::fmt;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use crate::build::{self, cargo};
use crate::python_tests;
use crate::slowest::Slowest;

/// Prefix of a test's output if the data for the test is missing. The test harness itself counts
/// such a test as passed.
const SKIPPED: &str = "skipped: ";

/// Arguments of Cargo that select every test program. The benchmark programs have no tests, and
/// would take minutes to build.
const PROGRAMS: [&str; 10] =
    ["--workspace", "--exclude", "impinge-python", "--lib", "--bin", "impinge", "--bin", "xtask", "--test", "*"];

/// Runs all tests of Rust and of the Python package. Prints their output, the slowest tests and the
/// summed counts. Returns `true` if all passed.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let mut tests = Tests::default();
    for program in programs(root, &PROGRAMS)? {
        println!("     Running {}", program.name);
        tests.run(&mut program.command())?;
    }
    // The extension module has no examples, and its features would compile the engine once more.
    let mut examples = cargo();
    examples.args(["test", "--workspace", "--exclude", "impinge-python", "--doc", "--no-fail-fast"]);
    tests.run_examples(examples.current_dir(root))?;
    let python = python_tests::run(root)?;
    tests.slowest.extend(python.slowest);
    tests.counts.passed += python.passed;
    tests.counts.failed += python.failed;
    tests.counts.skipped += python.skipped;
    println!("{}", tests.slowest);
    println!("{}", tests.counts);
    Ok(tests.all_passed())
}

/// Program that runs tests, and the folder to start it in.
pub(crate) struct Program {
    name: String,
    path: PathBuf,
    folder: PathBuf,
    /// Whether its tests are the unit tests of a library.
    is_of_units: bool,
}

impl Program {
    /// Returns the command that runs it.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        command.current_dir(&self.folder);
        command
    }

    /// Reports whether its tests are the unit tests of a library.
    pub(crate) fn is_of_units(&self) -> bool {
        self.is_of_units
    }
}

/// Builds test programs and returns them in the order of their names.
///
/// # Errors
/// Returns an error if Cargo cannot be started or the build fails. Cargo has then printed the
/// reason.
pub(crate) fn programs(root: &Path, selection: &[&str]) -> Result<Vec<Program>> {
    let built = build::programs(root, &[&["test", "--no-run"], selection].concat())?;
    let mut programs = Vec::new();
    for artifact in built.into_iter().filter(|artifact| artifact.profile.test) {
        let folder = artifact.manifest_path.parent().context("a manifest lies in a folder")?;
        let name = format!("{}: {}", folder.file_name().unwrap_or_default(), artifact.target.name);
        let is_of_units = artifact.target.is_lib();
        let path = artifact.executable.context("a program has a path")?.into();
        programs.push(Program { name, path, folder: folder.into(), is_of_units });
    }
    programs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(programs)
}

/// Results of the tests that have run so far.
pub(crate) struct Tests {
    pub(crate) counts: Counts,
    /// Whether every program ended without an error. A program that crashes prints no counts.
    succeeded: bool,
    pub(crate) slowest: Slowest,
}

impl Default for Tests {
    fn default() -> Self {
        Self { counts: Counts::default(), succeeded: true, slowest: Slowest::default() }
    }
}

impl Tests {
    /// Reports whether every program ended without an error, at least one test passed, and none
    /// failed.
    pub(crate) fn all_passed(&self) -> bool {
        self.succeeded && self.counts.failed == 0 && self.counts.passed > 0
    }

    /// Runs a test program and reads its output.
    pub(crate) fn run(&mut self, program: &mut Command) -> Result<()> {
        // The time of each test is an unstable option of the harness. This variable allows it on a
        // stable compiler.
        program.env("RUSTC_BOOTSTRAP", "1").args(["-Zunstable-options", "--report-time"]);
        self.read(program.args(["--show-output", "--color", "never"]))
    }

    /// Runs the examples in the documentation, which Cargo must start, and reads their output.
    fn run_examples(&mut self, cargo: &mut Command) -> Result<()> {
        self.read(cargo.args(["--", "--show-output", "--color", "never"]))
    }

    fn read(&mut self, command: &mut Command) -> Result<()> {
        let mut child = command.stdout(Stdio::piped()).spawn().with_context(|| format!("starting {command:?}"))?;
        let output = child.stdout.take().context("the output of a test program is piped")?;
        for line in BufReader::new(output).split(b'\n') {
            let line = line?;
            let line = String::from_utf8_lossy(&line); // a test may print any bytes
            println!("{line}");
            self.counts.read(&line);
            self.slowest.read(&line);
        }
        self.succeeded &= child.wait()?.success();
        Ok(())
    }
}

/// Sums over all test programs so far.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Counts {
    passed: usize,
    failed: usize,
    skipped: usize,
    /// Number of tests of the running program that printed that they were skipped.
    said_skipped: usize,
    /// Whether the current test has printed that it was skipped.
    said: bool,
}

impl Counts {
    fn read(&mut self, line: &str) {
        if let Some(result) = line.strip_prefix("test result: ") {
            let words: Vec<&str> = result.split([' ', ';']).filter(|word| !word.is_empty()).collect();
            for pair in words.windows(2) {
                let Ok(count) = pair[0].parse::<usize>() else { continue };
                match pair[1] {
                    "passed" => self.passed += count.saturating_sub(self.said_skipped),
                    "failed" => self.failed += count,
                    "ignored" => self.skipped += count + self.said_skipped,
                    _ => {}
                }
            }
            self.said_skipped = 0;
        } else if line.starts_with("---- ") && line.ends_with(" stdout ----") {
            self.said = false;
        } else if line.starts_with(SKIPPED) && !self.said {
            self.said = true;
            self.said_skipped += 1;
        }
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(output: &str) -> Counts {
        let mut counts = Counts::default();
        output.lines().for_each(|line| counts.read(line));
        counts
    }

    #[test]
    fn counts_are_summed_over_binaries() {
        let counts = counts(
            "test a ... ok\n\
             test result: ok. 5 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s\n\
             test result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured; 7 filtered out; finished in 1.25s\n",
        );
        assert_eq!(counts.to_string(), "8 passed, 2 failed, 1 skipped");
    }

    #[test]
    fn a_test_that_says_it_skipped_is_not_counted_as_passed() {
        let counts = counts(
            "---- scans stdout ----\nskipped: IMPINGE_DATA is not set\nskipped: IMPINGE_DATA is not set\n\
             ---- parts stdout ----\nskipped: IMPINGE_DATA is not set\n\
             test result: ok. 5 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n\
             test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n",
        );
        assert_eq!(counts.to_string(), "5 passed, 0 failed, 2 skipped");
    }
}
