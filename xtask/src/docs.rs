//! `cargo xtask docs`: builds the documentation site into `target/site`.

use std::path::Path;

use anyhow::{Context, Result};

use crate::environment::Environment;

/// Folder of the environment, kept between runs.
const ENVIRONMENT: &str = "target/docs";
/// Packages that build the site, every version pinned.
const REQUIREMENTS: &str = "docs/requirements.txt";

/// Builds the site and returns whether that worked without a warning. `mkdocs.yml` is strict: a
/// missing page, a broken link or a broken anchor is an error.
///
/// # Errors
/// If the environment cannot be made, or if the builder cannot be started.
pub(crate) fn build(root: &Path) -> Result<bool> {
    let environment = Environment::prepared(root, ENVIRONMENT, REQUIREMENTS)?;
    let mut mkdocs = environment.python(root);
    // Without `--quiet`: it hides warnings from the strict mode too.
    mkdocs.args(["-m", "mkdocs", "build"]).env("NO_MKDOCS_2_WARNING", "1");
    let output = mkdocs.output().context("starting mkdocs")?;
    let log = String::from_utf8_lossy(&output.stderr);
    for line in log.lines().filter(|line| !line.starts_with("INFO")) {
        println!("{line}");
    }
    if output.status.success() {
        println!("docs: target/site/index.html");
    }
    Ok(output.status.success())
}
