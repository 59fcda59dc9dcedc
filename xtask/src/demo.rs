//! The command at work: a human against a torus knot of 2,000,000 triangles.

use std::path::Path;
use std::process::{Command, ExitStatus};

use anyhow::{Context, Result, ensure};

const HUMAN: &str = "data/human_makehuman_cc0.ply";
const KNOT: &str = "target/demo/torus_knot.ply";
const POSE: &str = "data/torus_knot_on_human.txt";
const CURVES: &str = "target/demo/curves.obj";

/// Generates the knot where it is not there yet, prints the command and runs it; whether it gave an answer.
pub(crate) fn run(root: &Path) -> Result<bool> {
    if !root.join(KNOT).exists() {
        println!("writing {KNOT}");
        let written = cargo(
            root,
            &["--package", "impinge-testkit", "--no-default-features", "--example", "torus_knot", "--", KNOT],
        )?;
        ensure!(written.success(), "{KNOT} could not be written");
    }
    let check = ["check", HUMAN, KNOT, "--pose-b", POSE, "--curves", CURVES];
    println!("$ impinge {}", check.join(" "));
    let status = cargo(root, &[&["--package", "impinge-cli", "--bin", "impinge", "--"], &check[..]].concat())?;
    // Clear or collision; Cargo's own failures have other codes.
    Ok(matches!(status.code(), Some(0 | 1)))
}

/// Runs a program of the workspace. The chores do not link it, so that they are there before it is built.
fn cargo(root: &Path, arguments: &[&str]) -> Result<ExitStatus> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["run", "--release", "--quiet"]).args(arguments).current_dir(root);
    command.status().context("starting cargo run")
}
