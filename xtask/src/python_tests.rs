//! The tests of the Python package: installed from this tree, with pinned companions, in a virtual environment of its own.

use std::ffi::OsString;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

/// The environment, kept between runs.
const ENVIRONMENT: &str = "target/python-tests";
/// What the tests need beside the package, every version pinned.
const REQUIREMENTS: &str = "python/requirements-test.txt";

/// How many tests passed, failed and were skipped.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) passed: usize,
    pub(crate) failed: usize,
    pub(crate) skipped: usize,
}

/// Installs the package and runs pytest on its tests and on the examples in its documentation.
pub(crate) fn run(root: &Path) -> Result<Outcome> {
    let environment = Environment::prepared(root)?;
    environment.install(root)?;
    let mut child = environment
        .python(root)
        .args(["-m", "pytest", "-q", "--color=no", "python/tests", "--pyargs", "impinge"])
        .stdout(Stdio::piped())
        .spawn()
        .context("starting pytest")?;
    let output = child.stdout.take().context("the output of pytest is piped")?;
    let mut outcome = Outcome::default();
    for line in BufReader::new(output).split(b'\n') {
        let line = line?;
        let line = String::from_utf8_lossy(&line); // a test may print any bytes
        println!("{line}");
        if let Some(read) = Outcome::read(&line) {
            outcome = read;
        }
    }
    let succeeded = child.wait()?.success();
    ensure!(succeeded || outcome.failed > 0, "pytest failed without a failed test");
    ensure!(outcome.passed > 0 || outcome.failed > 0, "pytest ran no test");
    Ok(outcome)
}

impl Outcome {
    /// Reads pytest's last line, `1 failed, 334 passed, 2 skipped in 33.43s`.
    fn read(line: &str) -> Option<Self> {
        let (counts, seconds) = line.trim_matches(['=', ' ']).rsplit_once(" in ")?;
        seconds.split(['s', ' ']).next()?.parse::<f64>().ok()?;
        let mut outcome = Self::default();
        for count in counts.split(", ") {
            let (number, what) = count.split_once(' ')?;
            let number: usize = number.parse().ok()?;
            match what {
                "passed" => outcome.passed += number,
                "failed" | "error" | "errors" => outcome.failed += number,
                "skipped" => outcome.skipped += number,
                _ => {}
            }
        }
        Some(outcome)
    }
}

/// A virtual environment.
struct Environment {
    programs: PathBuf,
}

impl Environment {
    /// The environment with what the requirements name, made anew where they have changed.
    fn prepared(root: &Path) -> Result<Self> {
        let folder = root.join(ENVIRONMENT);
        let environment = Self { programs: folder.join(if cfg!(windows) { "Scripts" } else { "bin" }) };
        let requirements = fs::read_to_string(root.join(REQUIREMENTS)).context(REQUIREMENTS)?;
        let stamp = folder.join("requirements-installed.txt");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == requirements) {
            return Ok(environment);
        }
        let interpreter = std::env::var_os("PYTHON")
            .unwrap_or_else(|| OsString::from(if cfg!(windows) { "python" } else { "python3" }));
        let made = Command::new(&interpreter).args(["-m", "venv", "--clear"]).arg(&folder).status();
        if !made.is_ok_and(|status| status.success()) {
            bail!(
                "`{} -m venv` failed: the Python package is tested in a virtual environment of CPython 3.11 or later \
                 (on Debian: apt-get install python3-venv; PYTHON names another interpreter)",
                interpreter.display()
            );
        }
        pip(environment.python(root).args(["-m", "pip", "install", "--quiet", "--requirement", REQUIREMENTS]))?;
        fs::write(stamp, requirements)?;
        Ok(environment)
    }

    /// Builds the package as a user would and installs it.
    fn install(&self, root: &Path) -> Result<()> {
        let mut install = self.python(root);
        install.args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-deps",
            "--no-build-isolation",
            "--force-reinstall",
            ".",
        ]);
        // A release would take minutes; much of this profile's work was done for these chores already.
        pip(install.env("MATURIN_PEP517_ARGS", "--profile dev"))
    }

    /// The interpreter, with the environment's own programs first on the path.
    fn python(&self, root: &Path) -> Command {
        let mut path = self.programs.clone().into_os_string();
        if let Some(others) = std::env::var_os("PATH") {
            path.push(if cfg!(windows) { ";" } else { ":" });
            path.push(others);
        }
        let mut python = Command::new(self.programs.join("python"));
        python.current_dir(root).env("PATH", path).env_remove("PYTHONPATH").env("PIP_DISABLE_PIP_VERSION_CHECK", "1");
        python
    }
}

fn pip(command: &mut Command) -> Result<()> {
    let status = command.status().context("starting pip")?;
    ensure!(status.success(), "pip failed: {}", format!("{command:?}").replace('"', ""));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_is_read() {
        let read = |line: &str| Outcome::read(line).map(|o| (o.passed, o.failed, o.skipped));
        assert_eq!(read("337 passed in 33.43s"), Some((337, 0, 0)));
        assert_eq!(read("= 1 failed, 334 passed, 2 skipped, 3 warnings in 0.50s ="), Some((334, 1, 2)));
        assert_eq!(read("2 errors in 75.10s (0:01:15)"), Some((0, 2, 0)));
        assert_eq!(read("no tests ran in 0.01s"), None);
        assert_eq!(read("test a passed in time"), None);
        assert_eq!(read("....F. [ 22%]"), None);
    }
}
