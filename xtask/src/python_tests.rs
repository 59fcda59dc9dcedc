//! Tests of the Python package. It is installed from this tree, with pinned dependencies, in its
//! own virtual environment.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use anyhow::{Context, Result, ensure};

use crate::environment::Environment;
use crate::slowest::Slowest;

/// Folder of the virtual environment, which is kept between runs.
const ENVIRONMENT: &str = "target/python-tests";
/// File of the dependencies of the tests, with pinned versions.
const REQUIREMENTS: &str = "python/requirements-test.txt";

/// Numbers of tests that passed, failed and were skipped, and the slowest tests.
#[derive(Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) passed: usize,
    pub(crate) failed: usize,
    pub(crate) skipped: usize,
    pub(crate) slowest: Slowest,
}

/// Installs the package, and runs pytest on its tests and on the examples in its documentation.
pub(crate) fn run(root: &Path) -> Result<Outcome> {
    let environment = Environment::prepared(root, ENVIRONMENT, REQUIREMENTS)?;
    install(&environment, root)?;
    let mut child = environment
        .python(root)
        .args(["-m", "pytest", "-q", "--color=no", "--durations=10", "python/tests", "--pyargs", "impinge"])
        .stdout(Stdio::piped())
        .spawn()
        .context("starting pytest")?;
    let output = child.stdout.take().context("the output of pytest is piped")?;
    let mut outcome = Outcome::default();
    for line in BufReader::new(output).split(b'\n') {
        let line = line?;
        let line = String::from_utf8_lossy(&line); // a test may print any bytes
        println!("{line}");
        outcome.read(&line);
    }
    let succeeded = child.wait()?.success();
    ensure!(succeeded || outcome.failed > 0, "pytest failed without a failed test");
    ensure!(outcome.passed > 0 || outcome.failed > 0, "pytest ran no test");
    Ok(outcome)
}

impl Outcome {
    /// Reads a line of pytest's report. It is a duration, `1.20s call
    /// python/tests/test_a.py::test_b`, or the last line, `1 failed, 334 passed, 2 skipped in
    /// 33.43s`. Ignores any other line.
    fn read(&mut self, line: &str) {
        if let Some((seconds, rest)) = line.trim_start().split_once("s call ") {
            if let Ok(seconds) = seconds.parse() {
                self.slowest.add(rest.trim(), seconds);
            }
        } else if let Some([passed, failed, skipped]) = counts(line) {
            (self.passed, self.failed, self.skipped) = (passed, failed, skipped);
        }
    }
}

/// Returns the numbers of passed, failed and skipped tests in the last line of pytest's report, or
/// `None` for any other line.
fn counts(line: &str) -> Option<[usize; 3]> {
    let (counts, seconds) = line.trim_matches(['=', ' ']).rsplit_once(" in ")?;
    seconds.split(['s', ' ']).next()?.parse::<f64>().ok()?;
    let [mut passed, mut failed, mut skipped] = [0; 3];
    for count in counts.split(", ") {
        let (number, what) = count.split_once(' ')?;
        let number: usize = number.parse().ok()?;
        match what {
            "passed" => passed += number,
            "failed" | "error" | "errors" => failed += number,
            "skipped" => skipped += number,
            _ => {}
        }
    }
    Some([passed, failed, skipped])
}

/// Builds the package as a user would and installs it. The profile is that of the other tests, with
/// overflow checks.
fn install(environment: &Environment, root: &Path) -> Result<()> {
    let arguments = ["install", "--quiet", "--no-deps", "--no-build-isolation", "--force-reinstall", "."];
    environment.pip(root, &arguments, &[("MATURIN_PEP517_ARGS", "--profile dev")])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_is_read() {
        assert_eq!(counts("337 passed in 33.43s"), Some([337, 0, 0]));
        assert_eq!(counts("= 1 failed, 334 passed, 2 skipped, 3 warnings in 0.50s ="), Some([334, 1, 2]));
        assert_eq!(counts("2 errors in 75.10s (0:01:15)"), Some([0, 2, 0]));
        assert_eq!(counts("no tests ran in 0.01s"), None);
        assert_eq!(counts("test a passed in time"), None);
        assert_eq!(counts("....F. [ 22%]"), None);
    }

    #[test]
    fn durations_are_read() {
        let mut outcome = Outcome::default();
        outcome.read("12.50s call     python/tests/test_a.py::test_b");
        outcome.read("2 passed in 14.00s");
        assert_eq!(outcome.slowest.to_string(), "slowest tests:\n   12.50 s  python/tests/test_a.py::test_b");
        assert_eq!((outcome.passed, outcome.failed), (2, 0));
    }
}
