//! Every test of the workspace in one run, whose counts come last.

use std::fmt;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use crate::python_tests;

/// What a test prints first when the data that it needs is not there; libtest itself would call it passed.
const SKIPPED: &str = "skipped: ";

/// Runs `cargo test --workspace` and the Python package's tests, passes their output on and prints the summed counts;
/// whether all is well.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut child = Command::new(cargo)
        .args(["test", "--workspace", "--no-fail-fast", "--", "--show-output", "--color", "never"])
        .current_dir(root)
        .stdout(Stdio::piped())
        .spawn()
        .context("starting cargo test")?;
    let output = child.stdout.take().context("the output of cargo test is piped")?;
    let mut counts = Counts::default();
    for line in BufReader::new(output).split(b'\n') {
        let line = line?;
        let line = String::from_utf8_lossy(&line); // a test may print any bytes
        println!("{line}");
        counts.read(&line);
    }
    let succeeded = child.wait()?.success();
    let python = python_tests::run(root)?;
    counts.passed += python.passed;
    counts.failed += python.failed;
    counts.skipped += python.skipped;
    println!("{counts}");
    Ok(succeeded && counts.failed == 0 && counts.passed > 0)
}

/// The sums over all test binaries so far.
#[derive(Debug, Default, PartialEq)]
struct Counts {
    passed: usize,
    failed: usize,
    skipped: usize,
    /// Tests of the binary now running that said that they skipped.
    said_skipped: usize,
    /// Whether the test whose output is being read has said so already.
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
