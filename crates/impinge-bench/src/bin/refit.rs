//! Refitting compared with building, and the aging of trees under animations.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin refit`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::path::Path;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::hierarchy::Builder;
use impinge::mesh::PlacedMesh;
use impinge::{InputError, Mesh, Pose, Positions, query};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_testkit::animation::{ANIMATIONS, Animation};
use impinge_testkit::env_rob::data_folder;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

/// Numbers of quads along and around the knots: 20,000 to 2,000,000 triangles.
const SIZES: [[u32; 2]; 3] = [[200, 50], [632, 158], [2000, 500]];

/// Twists of the knot about its axis, in radians per unit of length along the axis.
const TWISTS: [f64; 6] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0];

/// Number of frames of the twist as an animation. Each frame is turned further by
/// [`TWIST_OF_FRAME`].
const FRAMES_OF_TWIST: u32 = 40;
const TWIST_OF_FRAME: f64 = 0.1;

/// Number of frames per printed row.
const EVERY: u32 = 10;

/// Times refits and rebuilds, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Number of threads for building, refitting and queries
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Number of runs of each
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Print only one JSON object for each frame of a twisted knot and of the recorded animations
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let Arguments { threads, repeats, json } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    if json {
        let twists: Vec<f64> = (1..=FRAMES_OF_TWIST).map(|frame| f64::from(frame) * TWIST_OF_FRAME).collect();
        print_json("twist", &twisted(&twists, repeats)?);
    } else {
        let knots = growth(repeats)?;
        println!("{knots}");
        knots.record("knots", 1)?;
        let names = TWISTS.map(|twist| twist.to_string());
        let table = aging_table("twist, rad", names.into_iter().zip(twisted(&TWISTS, repeats)?));
        println!("{table}");
        table.record("knot", 1)?;
    }
    let Some(folder) = data_folder() else { return Ok(()) };
    for name in ANIMATIONS {
        let frames = animated(&folder, name, repeats)?;
        if json {
            print_json(name, &frames);
        } else {
            let numbered = (1..).zip(frames).filter(|(number, _)| number % EVERY == 0);
            let named = numbered.map(|(number, frame)| (number.to_string(), frame));
            let table = aging_table("frame", named);
            println!("{name}\n{table}");
            table.record(name, 1)?;
        }
    }
    Ok(())
}

/// Times builds, refits in place, and refits of a copy.
fn growth(repeats: usize) -> Result<Table<6>> {
    let mut table = Table::new(["triangles", "build", "refit", "refitted", "build / refit", "ns a triangle"]);
    for [along, around] in SIZES {
        let knot = torus_knot(along, around, TREFOIL);
        let surface = Surface { positions: Positions::F64(knot.vertices), faces: knot.faces };
        let (mut mesh, build) = surface.build_with(Builder::Morton, repeats)?;
        let refit = Samples::take(repeats, || {
            let positions = surface.positions.clone();
            let (seconds, aging) = timed(|| mesh.refit(positions));
            ensure!(aging?.ratio() == 1.0, "the same places are another tree");
            Ok(seconds)
        })?;
        let refitted = Samples::take(repeats, || {
            let positions = surface.positions.clone();
            let (seconds, other) = timed(|| mesh.refitted(positions));
            ensure!(other?.parts() == mesh.parts(), "the same places are another tree");
            Ok(seconds)
        })?;
        let triangles = surface.faces.len();
        table.row([
            triangles.to_string(),
            time(build.min()),
            time(refit.min()),
            time(refitted.min()),
            format!("{:.1}", build.min() / refit.min()),
            format!("{:.1}", refit.min() / triangles as f64 * 1e9),
        ]);
    }
    Ok(table)
}

/// One of three methods to follow a mesh that moves: the cost of its hierarchy by the surface area
/// heuristic, and the times of the update and of a query.
struct Way {
    cost: f64,
    update: f64,
    query: f64,
}

/// Frame of a motion, with the three methods.
struct Frame {
    pairs: usize,
    /// Aging ratio of the mesh that is only refitted.
    ratio: f64,
    /// Number of faces rebuilt by the watched mesh.
    faces: usize,
    refitted: Way,
    watched: Way,
    rebuilt: Way,
}

/// Follows a mesh by refits only, by refits with partial rebuilds on aging, and by a build in each
/// frame. Each is queried in turn for its pairs with another mesh, and the answers are compared.
fn follow(
    still: &Mesh,
    frames: impl IntoIterator<Item = Positions>,
    other: PlacedMesh<'_>,
    repeats: usize,
) -> Result<Vec<Frame>> {
    let (mut refitted, mut watched) = (still.clone(), still.clone());
    let mut followed = Vec::new();
    for positions in frames {
        let [first, second] = [positions.clone(), positions.clone()];
        let (refit, aging) = timed_ok(|| refitted.refit(first))?;
        let (watch, faces) = timed_ok(|| {
            let is_aged = watched.refit(second)?.is_worth_rebuilding();
            Ok::<usize, InputError>(if is_aged { watched.rebuild_aged() } else { 0 })
        })?;
        let faces_of = still.faces().to_vec();
        let (build, rebuilt) = timed_ok(|| Mesh::with_builder(positions, faces_of, Builder::Morton))?;
        let meshes = [&refitted, &watched, &rebuilt];
        let pairs = query::intersecting_pairs(&rebuilt, other);
        let mut queries = [f64::INFINITY; 3];
        for _ in 0..repeats.max(1) {
            for (least, mesh) in queries.iter_mut().zip(meshes) {
                let (seconds, found) = timed(|| query::intersecting_pairs(mesh, other));
                ensure!(found == pairs, "{} pairs, and {} of a new tree", found.len(), pairs.len());
                *least = least.min(seconds);
            }
        }
        let way = |at: usize, update| Way { cost: meshes[at].aging().cost, update, query: queries[at] };
        let [refitted, watched, rebuilt] = [way(0, refit), way(1, watch), way(2, build)];
        followed.push(Frame { pairs: pairs.len(), ratio: aging.ratio(), faces, refitted, watched, rebuilt });
    }
    Ok(followed)
}

/// Returns rows of frames by their names.
fn aging_table(first: &'static str, frames: impl IntoIterator<Item = (String, Frame)>) -> Table<8> {
    let mut table =
        Table::new([first, "ratio of costs", "to new", "pairs", "refitted", "watched", "rebuilt", "faces rebuilt"]);
    for (name, frame) in frames {
        table.row([
            name,
            format!("{:.3}", frame.ratio),
            format!("{:.3}", frame.refitted.cost / frame.rebuilt.cost),
            frame.pairs.to_string(),
            time(frame.refitted.query),
            time(frame.watched.query),
            time(frame.rebuilt.query),
            frame.faces.to_string(),
        ]);
    }
    table
}

/// Follows a knot of 200,000 triangles that is twisted more and more about its axis. Its queries
/// are against the original knot.
fn twisted(twists: &[f64], repeats: usize) -> Result<Vec<Frame>> {
    let knot = torus_knot(632, 158, TREFOIL);
    let still = Mesh::with_builder(Positions::F64(knot.vertices.clone()), knot.faces, Builder::Morton)?;
    let frames = twists.iter().map(|twist| {
        let turned = |v: &[f64; 3]| {
            let (s, c) = (twist * v[2]).sin_cos();
            [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2] + 0.01]
        };
        Positions::F64(knot.vertices.iter().map(turned).collect())
    });
    follow(&still, frames, (&still).into(), repeats)
}

/// Follows a recorded animation. Its queries are against a moved copy of its first frame.
fn animated(folder: &Path, name: &str, repeats: usize) -> Result<Vec<Frame>> {
    let Animation { frames, faces } = Animation::read(folder, name)?;
    let still = Mesh::with_builder(Positions::F32(frames[0].clone()), faces, Builder::Morton)?;
    let xs = || frames[0].iter().map(|v| f64::from(v[0]));
    let width = xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min);
    let aside = Pose::from_translation([0.25 * width, 0.0, 0.0])?;
    follow(&still, frames.into_iter().map(Positions::F32), still.at(aside), repeats)
}

/// Prints the JSON that `bench/animation.py` reads: one line per frame.
fn print_json(name: &str, frames: &[Frame]) {
    let way =
        |way: &Way| serde_json::json!({ "cost": way.cost, "update_seconds": way.update, "query_seconds": way.query });
    for (number, frame) in (1..).zip(frames) {
        println!(
            "{}",
            serde_json::json!({
                "animation": name,
                "frame": number,
                "pairs": frame.pairs,
                "ratio": frame.ratio,
                "faces_rebuilt": frame.faces,
                "refitted": way(&frame.refitted),
                "watched": way(&frame.watched),
                "rebuilt": way(&frame.rebuilt),
            })
        );
    }
}

fn timed_ok<T, E: std::error::Error + Send + Sync + 'static>(run: impl FnOnce() -> Result<T, E>) -> Result<(f64, T)> {
    let (seconds, result) = timed(run);
    Ok((seconds, result?))
}
