//! `cargo xtask viewer`: builds the page of reports from `viewer/`, compares it with the page in
//! the crate, and runs its tests in a headless Chromium.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::build::programs;

/// Folder of the sources.
const SOURCES: &str = "viewer";
/// Page that a build writes, relative to the sources.
const BUILT: &str = "out/page/index.html";
/// Page that the crate contains.
const ASSET: &str = "crates/impinge-report/assets/viewer.html";
/// Folder of the pages that the browser opens.
const PAGES: &str = "target/viewer";
/// Page of a report of clashes.
const REPORT: &str = "gearbox";
/// Pages that the browser opens: the name of each, the arguments of `impinge`, and its exit code.
/// Rules and configurations keep the searches short in an unoptimized build.
const COMMANDS: [(&str, &str, i32); 6] = [
    (
        REPORT,
        "clash data/cad_cycloidal_gearbox.glb --rules viewer/test/pins.toml --bcf target/viewer/gearbox.bcfzip",
        1,
    ),
    ("meet", "check data/human_makehuman_cc0.ply data/human_makehuman_cc0.ply --pose-b 0.4,0,0 --up y", 1),
    ("apart", "check data/human_makehuman_cc0.ply data/human_makehuman_cc0.ply --pose-b 2,0,0 --up y", 0),
    ("hierarchy", "inspect data/human_makehuman_cc0.ply", 0),
    (
        "configurations",
        "robot check data/robots/gantry.urdf --srdf data/robots/gantry.srdf --configs viewer/test/configurations.csv",
        1,
    ),
    ("path", "robot motion data/robots/gantry.urdf --srdf data/robots/gantry.srdf --path viewer/test/path.csv", 1),
];
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

/// Writes the pages, opens them in a browser and runs the tests. Returns whether all passed.
fn browse(root: &Path, sources: &Path) -> Result<bool> {
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let Some(browser) = named.or_else(|| BROWSERS.iter().find_map(|name| find(name))) else {
        println!("viewer: skipped: the tests in a browser, because Chromium is not installed (or name it in CHROMIUM)");
        return Ok(true);
    };
    let folder = root.join(PAGES);
    fs::create_dir_all(&folder).with_context(|| format!("making {PAGES}"))?;
    let path = |name: &str| folder.join(format!("{name}.html"));
    let programs = programs(root, &["build", "--quiet", "-p", "impinge-cli"])?;
    let impinge = programs.iter().find_map(|program| program.executable.as_ref());
    let impinge = impinge.context("the build has made no program")?;
    for (name, arguments, code) in COMMANDS {
        let mut command = Command::new(impinge);
        command.args(arguments.split(' ')).arg("--view").arg(path(name));
        let output = command.current_dir(root).output().context("starting impinge")?;
        let is_expected = output.status.code() == Some(code);
        ensure!(is_expected, "impinge {arguments}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let page = path(REPORT);
    let mut tests = Command::new("npm");
    tests.args(["test", "--silent"]).current_dir(sources);
    tests.env("IMPINGE_PAGE", &page).env("IMPINGE", impinge).env("CHROMIUM", browser);
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
