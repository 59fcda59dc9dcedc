//! Real meshes: two large CAD parts against themselves, shifted and turned, and a human against itself unmoved, where
//! every face meets itself and its neighbours.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin real`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::path::Path;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use impinge::mesh::Options;
use impinge::query::{self, Query};
use impinge::simd::levels;
use impinge::{Mesh, Pose};
use impinge_bench::questions::ask_impinge;
use impinge_bench::real_points::unpacked;
use impinge_bench::samples::timed;
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_testkit::env_rob::data_folder;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The CAD parts, in `big/` of the folder that `IMPINGE_DATA` names, and of how many faces one is kept where they turn.
/// About one face in twenty of the second is a sliver nearly as long as the part. Turned, the boxes of slivers fill the
/// part, and overlap most others: the time grows with the square of the faces, which for all of them makes hours.
const PARTS: [(&str, usize); 2] = [("cad_ventilator.ply", 1), ("cad_11752.ply", 64)];

/// How far a part is shifted, as a share of its bounding box.
const SHIFT: f64 = 0.01;

/// How far a part is turned about (1, 2, 3), in radians.
const TURN: f64 = 0.3;

/// Seconds that a pair of faces may take where every face meets some: far more than they do on any processor of today,
/// so that only a change of method fails, and not a busy machine.
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
    let mut table = Table::new(["", "triangles", "build", "pairs", "all pairs", "first hit", "a pair"]);
    let mut measure = |name: &str, surface: &Surface, world_from_b| {
        let (row, seconds_a_pair) = measure(name, surface, world_from_b, repeats).with_context(|| name.to_owned())?;
        table.row(row);
        anyhow::Ok(seconds_a_pair)
    };
    let human = load(&Path::new(ROOT).join("data/human_makehuman_cc0.ply"))?;
    let seconds_a_pair = measure("human, itself", &human, Pose::IDENTITY)?;
    if let Some(folder) = data_folder() {
        for (name, every) in PARTS {
            let part = load(&unpacked(&folder.join("big").join(format!("{name}.gz")), name)?)?;
            measure(&format!("{name}, shifted"), &part, beside_itself(&part, 0.0)?)?;
            let turned = beside_itself(&part, TURN)?;
            let thinned = Surface { faces: part.faces.into_iter().step_by(every).collect(), ..part };
            let share = if every == 1 { String::new() } else { format!(", one face in {every}") };
            measure(&format!("{name}{share}, turned"), &thinned, turned)?;
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

/// Loads a file, and says how long that took.
fn load(path: &Path) -> Result<Surface> {
    let (seconds, surface) = timed(|| Surface::load(path));
    println!("{} loaded in {}", path.file_name().unwrap_or_default().display(), time(seconds));
    surface
}

/// Times a mesh against itself at a pose; returns a row of medians, and the seconds that each pair takes.
fn measure(name: &str, surface: &Surface, world_from_b: Pose, repeats: usize) -> Result<([String; 7], f64)> {
    let (mesh, build) = surface.build(repeats)?;
    check(&mesh, world_from_b)?;
    let asked = ask_impinge(repeats, (&mesh).into(), mesh.at(world_from_b), &Options::default())?;
    ensure!(!asked.pairs.is_empty(), "the mesh does not meet itself, and so measures nothing");
    let seconds_a_pair = asked.all_pairs.median() / asked.pairs.len() as f64;
    let row = [
        name.to_owned(),
        mesh.faces().len().to_string(),
        time(build.median()),
        asked.pairs.len().to_string(),
        time(asked.all_pairs.median()),
        time(asked.first_hit.median()),
        time(seconds_a_pair),
    ];
    Ok((row, seconds_a_pair))
}

/// Compares the pairs with those found with the narrowest vector unit and from the other side; unmoved, no face may miss itself.
fn check(mesh: &Mesh, world_from_b: Pose) -> Result<()> {
    let pairs = query::intersecting_pairs(mesh, mesh.at(world_from_b));
    let narrowest = Options { level: levels()[0].1, ..Options::default() };
    let mut swapped = Query::new().with_options(narrowest).intersecting_pairs(mesh.at(world_from_b), mesh);
    swapped.iter_mut().for_each(|pair| pair.reverse());
    swapped.sort_unstable();
    ensure!(pairs == swapped, "{} pairs found, and {} from the other side", pairs.len(), swapped.len());
    if world_from_b == Pose::IDENTITY {
        let met = pairs.iter().filter(|[a, b]| a == b).count();
        ensure!(met == mesh.faces().len(), "only {met} of {} faces meet themselves", mesh.faces().len());
    }
    Ok(())
}

/// Turned about the middle of its box, and shifted.
fn beside_itself(surface: &Surface, angle_rad: f64) -> Result<Pose> {
    let [low, high] = surface.bounds();
    let about_origin = Pose::from_axis_angle([1.0, 2.0, 3.0], angle_rad, [0.0; 3])?;
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    let turned = about_origin.apply(middle);
    let shift = |axis: usize| middle[axis] - turned[axis] + SHIFT * (high[axis] - low[axis]);
    Ok(Pose::new(*about_origin.linear(), std::array::from_fn(shift))?)
}
