//! Demonstration of the command: a human against a torus knot of 2,000,000 triangles.

use std::path::Path;
use std::process::{Command, ExitStatus};

use anyhow::{Context, Result, ensure};
use cargo_metadata::Artifact;

use crate::build::programs;

const HUMAN: &str = "data/human_makehuman_cc0.ply";
const KNOT: &str = "target/demo/torus_knot.ply";
const POSE: &str = "data/torus_knot_on_human.txt";
const CURVES: &str = "target/demo/curves.obj";

/// Arguments of Cargo that select the command and the generator of the knot.
const PROGRAMS: [&str; 11] = [
    "build",
    "--release",
    "--package",
    "impinge-cli",
    "--bin",
    "impinge",
    "--package",
    "impinge-testkit",
    "--no-default-features",
    "--example",
    "torus_knot",
];

/// Builds the command, generates the knot if its file does not exist yet, prints a command line and
/// runs it. Returns `true` if the command gave an answer.
pub(crate) fn run(root: &Path) -> Result<bool> {
    println!("building, which takes a few minutes the first time");
    let programs = programs(root, &PROGRAMS)?;
    if !root.join(KNOT).exists() {
        println!("writing {KNOT}");
        let written = status(root, &programs, "torus_knot", &[KNOT])?;
        ensure!(written.success(), "{KNOT} could not be written");
    }
    let check = ["check", HUMAN, KNOT, "--pose-b", POSE, "--curves", CURVES];
    println!("$ impinge {}", check.join(" "));
    // Exit code 0 means clear and 1 means a collision. Other codes are failures.
    Ok(matches!(status(root, &programs, "impinge", &check)?.code(), Some(0 | 1)))
}

/// Runs one of the programs. This crate does not link them, so that xtask builds without them.
fn status(root: &Path, programs: &[Artifact], name: &str, arguments: &[&str]) -> Result<ExitStatus> {
    let program = programs.iter().find(|program| program.target.name == name);
    let path =
        program.and_then(|program| program.executable.as_ref()).with_context(|| format!("{name} was not built"))?;
    Command::new(path).args(arguments).current_dir(root).status().with_context(|| format!("starting {name}"))
}
