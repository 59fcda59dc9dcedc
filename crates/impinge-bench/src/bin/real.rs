//! Real meshes: two large CAD parts against themselves shifted and turned, and a human against itself unmoved, where
//! every face meets itself and its neighbours.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin real`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Parser;
use flate2::read::MultiGzDecoder;
use impinge::mesh::Options;
use impinge::simd::Level;
use impinge::{Mesh, Pose, query};
use impinge_bench::questions::ask_impinge;
use impinge_bench::samples::timed;
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_testkit::env_rob::data_folder;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The CAD parts, in `big/` of the folder that `IMPINGE_DATA` names.
const PARTS: [&str; 2] = ["cad_ventilator.ply", "cad_11752.ply"];

/// How far a part is shifted, as a share of its bounding box.
const SHIFT: f64 = 0.01;

/// Seconds that a pair of faces may take where every face meets some: ten times what it should.
const MOST_SECONDS_A_PAIR: f64 = 2e-6;

/// Times impinge on real meshes, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Threads to build and to ask with
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Runs of each question, and of the build
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<()> {
    let Arguments { threads, repeats } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let mut table = Table::new(["", "triangles", "load", "build", "pairs", "all pairs", "first hit", "a pair"]);
    let human = Path::new(ROOT).join("data/human_makehuman_cc0.ply");
    let (row, seconds_a_pair) = measure("human, itself", &human, repeats, |_| Ok(Pose::IDENTITY))?;
    table.row(row);
    if let Some(folder) = data_folder() {
        for name in PARTS {
            let path = unpacked(&folder.join("big").join(format!("{name}.gz")), name)?;
            let (row, _) = measure(name, &path, repeats, |surface| beside_itself(&surface.bounds()))?;
            table.row(row);
        }
    }
    print!("{table}");
    ensure!(
        seconds_a_pair < MOST_SECONDS_A_PAIR,
        "the human against itself takes {} a pair, more than {}",
        time(seconds_a_pair),
        time(MOST_SECONDS_A_PAIR)
    );
    Ok(())
}

/// Times a mesh against itself at a pose; returns a row of medians, and the seconds that each pair takes.
fn measure(
    name: &str,
    path: &Path,
    repeats: usize,
    world_from_b: impl FnOnce(&Surface) -> Result<Pose>,
) -> Result<([String; 8], f64)> {
    let (load, surface) = timed(|| Surface::load(path));
    let surface = surface?;
    let (mesh, build) = surface.build(repeats)?;
    let world_from_b = world_from_b(&surface)?;
    check(&mesh, world_from_b).with_context(|| name.to_owned())?;
    let asked = ask_impinge(repeats, (&mesh).into(), mesh.at(world_from_b), &Options::default())
        .with_context(|| name.to_owned())?;
    ensure!(asked.pairs > 0, "{name} does not meet itself, and so measures nothing");
    let seconds_a_pair = asked.all_pairs.median() / asked.pairs as f64;
    let row = [
        name.to_owned(),
        mesh.faces().len().to_string(),
        time(load),
        time(build.median()),
        asked.pairs.to_string(),
        time(asked.all_pairs.median()),
        time(asked.first_hit.median()),
        time(seconds_a_pair),
    ];
    Ok((row, seconds_a_pair))
}

/// Compares the pairs with those found without vector units and from the other side; unmoved, no face may miss itself.
fn check(mesh: &Mesh, world_from_b: Pose) -> Result<()> {
    let pairs = query::intersecting_pairs(mesh, mesh.at(world_from_b));
    let plainly = Options { level: Level::fallback(), ..Options::default() };
    let mut swapped = query::intersecting_pairs_with(mesh.at(world_from_b), mesh, &plainly);
    swapped.iter_mut().for_each(|pair| pair.reverse());
    swapped.sort_unstable();
    ensure!(pairs == swapped, "{} pairs found, and {} from the other side", pairs.len(), swapped.len());
    if world_from_b == Pose::IDENTITY {
        let met = pairs.iter().filter(|[a, b]| a == b).count();
        ensure!(met == mesh.faces().len(), "only {met} of {} faces meet themselves", mesh.faces().len());
    }
    Ok(())
}

/// Turned by 0.3 rad about (1, 2, 3) through the middle of the box, and shifted.
fn beside_itself([low, high]: &[[f64; 3]; 2]) -> Result<Pose> {
    let about_origin = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.3, [0.0; 3])?;
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    let turned = about_origin.apply(middle);
    let shift = |axis: usize| middle[axis] - turned[axis] + SHIFT * (high[axis] - low[axis]);
    Ok(Pose::new(*about_origin.linear(), std::array::from_fn(shift))?)
}

/// The file's content, unpacked where that was not done before; it is renamed at the end, so that what is there is whole.
fn unpacked(packed: &Path, name: &str) -> Result<PathBuf> {
    let folder = Path::new(ROOT).join("target/bench");
    let path = folder.join(name);
    if !path.exists() {
        fs::create_dir_all(&folder)?;
        let partial = folder.join(format!("{name}.part"));
        let mut content = MultiGzDecoder::new(File::open(packed).with_context(|| packed.display().to_string())?);
        io::copy(&mut content, &mut File::create(&partial)?).with_context(|| packed.display().to_string())?;
        fs::rename(&partial, &path)?;
    }
    Ok(path)
}
