//! `cargo xtask viewer`: builds the page of reports from `viewer/`, compares it with the page in
//! the crate, and runs its tests in a headless Chromium.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::build::cargo;

/// Folder of the sources.
const SOURCES: &str = "viewer";
/// Page that a build writes, relative to the sources.
const BUILT: &str = "out/page/index.html";
/// Page that the crate contains.
const ASSET: &str = "crates/impinge-report/assets/viewer.html";
/// Model of the page that the browser opens.
const MODEL: &str = "data/cad_cycloidal_gearbox.glb";
/// Rules of the search in the model.
const RULES: &str = "viewer/test/pins.toml";
/// Page that the browser opens.
const PAGE: &str = "target/viewer/gearbox.html";
/// Least major version of Node that builds and tests the page.
const MIN_NODE: u32 = 18;
/// Names of Chromium on different systems.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// Checks the page, or replaces it with `write`. Returns whether all checks passed. A check whose
/// programs are not installed prints `viewer: skipped` with the reason, and counts as passed.
///
/// # Errors
/// Returns an error if a program cannot be started or a file cannot be read.
pub(crate) fn run(root: &Path, write: bool) -> Result<bool> {
    let sources = root.join(SOURCES);
    if node_version().is_none_or(|version| version < MIN_NODE) || find("npm").is_none() {
        println!("viewer: skipped: Node {MIN_NODE} or later and npm are not installed");
        return Ok(true);
    }
    let steps: [&[&str]; 3] =
        [&["ci", "--ignore-scripts", "--no-audit", "--no-fund"], &["run", "check"], &["run", "build"]];
    for step in steps {
        if !npm(&sources, step)? {
            println!("viewer: npm {} failed", step.join(" "));
            return Ok(false);
        }
    }
    let built = fs::read(sources.join(BUILT)).context("reading the page that was built")?;
    let asset = root.join(ASSET);
    if write {
        fs::write(&asset, &built).with_context(|| format!("writing {ASSET}"))?;
        println!("viewer: wrote {ASSET} ({} kB)", built.len() / 1000);
        return Ok(true);
    }
    let is_current = fs::read(&asset).with_context(|| format!("reading {ASSET}"))? == built;
    println!(
        "viewer: {ASSET} is {}",
        if is_current { "current" } else { "not what viewer/ builds: run cargo xtask viewer --write" }
    );
    Ok(is_current && browse(root, &sources)?)
}

/// Opens the page of a model in a browser and runs the tests. Returns whether all passed.
fn browse(root: &Path, sources: &Path) -> Result<bool> {
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let Some(browser) = named.or_else(|| BROWSERS.iter().find_map(|name| find(name))) else {
        println!("viewer: skipped: the tests in a browser, because Chromium is not installed (or name it in CHROMIUM)");
        return Ok(true);
    };
    let page = root.join(PAGE);
    fs::create_dir_all(page.parent().context("the page has a folder")?)?;
    let mut clash = cargo();
    clash
        .args(["run", "--quiet", "-p", "impinge-cli", "--", "clash", MODEL, "--rules", RULES, "--view"])
        .arg(&page)
        .current_dir(root);
    let output = clash.output().context("starting impinge clash")?;
    let has_clashes = output.status.code() == Some(1);
    ensure!(has_clashes, "impinge clash {MODEL}: {}", String::from_utf8_lossy(&output.stderr));
    let mut tests = Command::new("npm");
    tests.args(["test", "--silent"]).current_dir(sources).env("IMPINGE_PAGE", &page).env("CHROMIUM", browser);
    let passed = tests.status().context("starting npm test")?.success();
    println!("viewer: the tests in a browser {}", if passed { "passed" } else { "failed" });
    Ok(passed)
}

/// Runs npm quietly; if it fails, prints what it printed.
fn npm(folder: &Path, arguments: &[&str]) -> Result<bool> {
    let output = Command::new("npm").args(arguments).current_dir(folder).output().context("starting npm")?;
    if !output.status.success() {
        println!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    }
    Ok(output.status.success())
}

/// Returns the major version of Node, or `None` if it is not installed.
fn node_version() -> Option<u32> {
    let output = Command::new("node").arg("--version").output().ok()?;
    String::from_utf8_lossy(&output.stdout).trim().trim_start_matches('v').split('.').next()?.parse().ok()
}

/// Returns the program with a name in the folders of `PATH`.
fn find(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| path.is_file())
}
