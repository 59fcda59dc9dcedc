//! Real meshes: two large CAD parts against themselves, shifted and turned, and a human against
//! itself unmoved, in which every face intersects itself and its neighbors.
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

/// CAD parts, in `big/` of the folder that `IMPINGE_DATA` names, and a thinning factor n: if a part
/// is turned, only one in n of its faces is kept.
///
/// About 5 % of the faces of the second part are slivers nearly as long as the part. If it is
/// turned, the boxes of slivers fill the part and overlap most others. The time grows with the
/// square of the number of faces, so all faces would take hours.
const PARTS: [(&str, usize); 2] = [("cad_ventilator.ply", 1), ("cad_11752.ply", 64)];

/// Translation of a part, as a fraction of the size of its bounding box.
const SHIFT: f64 = 0.01;

/// Angle by which a part is turned about (1, 2, 3), in radians.
const TURN: f64 = 0.3;

/// Maximum time per pair of faces if every face intersects some, in seconds. It is far above the
/// time on any current processor, so that only a change of method fails, and not a busy machine.
const MOST_SECONDS_A_PAIR: f64 = 2e-6;

/// Times impinge on real meshes, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Number of threads for building and queries
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Number of runs of each query, and of the build
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

/// Loads a file, and prints the time.
fn load(path: &Path) -> Result<Surface> {
    let (seconds, surface) = timed(|| Surface::load(path));
    println!("{} loaded in {}", path.file_name().unwrap_or_default().display(), time(seconds));
    surface
}

/// Times a mesh against itself at a pose, and returns a row of medians and the time per pair in
/// seconds.
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

/// Compares the pairs with those found with the narrowest vector unit and the meshes swapped. If
/// the mesh is unmoved, every face must intersect itself.
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

/// Returns a pose that turns the mesh about the middle of its box, and shifts it.
fn beside_itself(surface: &Surface, angle_rad: f64) -> Result<Pose> {
    let [low, high] = surface.bounds();
    let about_origin = Pose::from_axis_angle([1.0, 2.0, 3.0], angle_rad, [0.0; 3])?;
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    let turned = about_origin.apply(middle);
    let shift = |axis: usize| middle[axis] - turned[axis] + SHIFT * (high[axis] - low[axis]);
    Ok(Pose::new(*about_origin.linear(), std::array::from_fn(shift))?)
}
