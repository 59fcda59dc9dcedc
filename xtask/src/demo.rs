//! The command at work: a human against a torus knot of 2,000,000 triangles.

use std::fs::{self, File};
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use impinge::Positions;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

const HUMAN: &str = "data/human_makehuman_cc0.ply";
const KNOT: &str = "target/demo/torus_knot.ply";
const POSE: &str = "data/torus_knot_on_human.txt";
const CURVES: &str = "target/demo/curves.obj";

/// Generates the knot where it is not there yet, prints the command and runs it; whether it gave an answer.
pub(crate) fn run(root: &Path) -> Result<bool> {
    if !root.join(KNOT).exists() {
        println!("writing {KNOT}");
        write_knot(&root.join(KNOT))?;
    }
    let arguments = ["run", "--release", "--quiet", "--package", "impinge-cli", "--bin", "impinge", "--"]
        .into_iter()
        .chain(["check", HUMAN, KNOT, "--pose-b", POSE, "--curves", CURVES]);
    println!("$ cargo {}", arguments.clone().collect::<Vec<_>>().join(" "));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo).args(arguments).current_dir(root).status().context("starting cargo run")?;
    // Clear or collision; Cargo's own failures have other codes.
    Ok(matches!(status.code(), Some(0 | 1)))
}

fn write_knot(path: &Path) -> Result<()> {
    let folder = path.parent().context("the knot lies in a folder")?;
    fs::create_dir_all(folder)?;
    let knot = torus_knot(2000, 500, TREFOIL);
    let single = knot.vertices.iter().map(|vertex| vertex.map(|x| x as f32)).collect();
    // Renamed when it is whole, so that a run cut short leaves nothing that looks like the knot.
    let unfinished = path.with_extension("unfinished");
    impinge_files::write_ply(File::create(&unfinished)?, &Positions::F32(single), &knot.faces)?;
    fs::rename(&unfinished, path)?;
    Ok(())
}
