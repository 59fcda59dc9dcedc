//! Virtual environments of Python with pinned packages, kept in `target` between runs.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// A virtual environment.
pub(crate) struct Environment {
    programs: PathBuf,
}

impl Environment {
    /// Returns the environment in `folder` with the packages of the file `requirements`, both
    /// relative to `root`. It is made again if the file has changed.
    ///
    /// # Errors
    /// If there is no Python that can make one, or if a package cannot be installed.
    pub(crate) fn prepared(root: &Path, folder: &str, requirements: &str) -> Result<Self> {
        let folder = root.join(folder);
        let environment = Self { programs: folder.join(if cfg!(windows) { "Scripts" } else { "bin" }) };
        let wanted = fs::read_to_string(root.join(requirements)).with_context(|| requirements.to_owned())?;
        let stamp = folder.join("requirements-installed.txt");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
            return Ok(environment);
        }
        let interpreter = std::env::var_os("PYTHON")
            .unwrap_or_else(|| OsString::from(if cfg!(windows) { "python" } else { "python3" }));
        let made = Command::new(&interpreter).args(["-m", "venv", "--clear"]).arg(&folder).status();
        if !made.is_ok_and(|status| status.success()) {
            bail!(
                "`{} -m venv` failed: a virtual environment of CPython 3.11 or later is needed (on Debian: apt-get \
                 install python3-venv; the variable PYTHON names another interpreter)",
                interpreter.display()
            );
        }
        environment.pip(root, &["install", "--quiet", "--requirement", requirements], &[])?;
        fs::write(stamp, wanted)?;
        Ok(environment)
    }

    /// Runs pip with some arguments and environment variables.
    ///
    /// # Errors
    /// If it fails.
    pub(crate) fn pip(&self, root: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Result<()> {
        let mut pip = self.python(root);
        pip.args(["-m", "pip"]).args(arguments).envs(variables.iter().copied());
        let status = pip.status().context("starting pip")?;
        ensure!(status.success(), "pip failed: {}", format!("{pip:?}").replace('"', ""));
        Ok(())
    }

    /// Returns the interpreter, with the environment's own programs first on the path.
    pub(crate) fn python(&self, root: &Path) -> Command {
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
