//! Refitting beside building, how trees age under animations, and baked files beside refits.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin refit`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use impinge::hierarchy::Builder;
use impinge::mesh::{Aging, Placed};
use impinge::{Mesh, Pose, Positions, query};
use impinge_bench::real_points::unpacked;
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_files::{Baked, Provenance, write_baked};
use impinge_testkit::animation::{ANIMATIONS, Animation};
use impinge_testkit::env_rob::data_folder;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

/// Quads along and round the knots: 20,000 to 2,000,000 triangles.
const SIZES: [[u32; 2]; 3] = [[200, 50], [632, 158], [2000, 500]];

/// How far the knot is turned about its axis for each unit along it, in radians.
const TWISTS: [f64; 6] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0];

/// Frames of an animation of which one row is printed.
const EVERY: usize = 10;

/// Times refits, rebuilds and baked files, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Threads to build, refit and ask with
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Runs of each
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<()> {
    let Arguments { threads, repeats } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    println!("{}", growth(repeats)?);
    println!("{}", twisted(repeats)?);
    let Some(folder) = data_folder() else { return Ok(()) };
    for name in ANIMATIONS {
        println!("{name}\n{}", animated(&folder, name, repeats)?);
    }
    let ventilator = unpacked(&folder.join("big/cad_ventilator.ply.gz"), "cad_ventilator.ply")?;
    println!("{}", baked(&Surface::load(&ventilator)?, repeats)?);
    Ok(())
}

/// Builds, refits in place and beside a clone, and rebuilds.
fn growth(repeats: usize) -> Result<Table<6>> {
    let mut table = Table::new(["triangles", "build", "refit", "refitted", "build / refit", "ns a triangle"]);
    for [along, around] in SIZES {
        let knot = torus_knot(along, around, TREFOIL);
        let surface = Surface { positions: Positions::F64(knot.vertices), faces: knot.faces };
        let (mut mesh, build) = surface.build(repeats)?;
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

/// What a question takes of a mesh that was refitted, of one rebuilt where it has aged, and of a new one, which must all answer alike.
struct Asked {
    refitted: f64,
    partly: f64,
    rebuilt: f64,
    faces: usize,
    pairs: usize,
}

fn ask(mesh: &Mesh, other: Placed<'_>, repeats: usize) -> Result<Asked> {
    let (mut partly, mut rebuilt) = (mesh.clone(), mesh.clone());
    let faces = partly.rebuild_aged();
    rebuilt.rebuild(Builder::default());
    let expected = query::intersecting_pairs(&rebuilt, other);
    let time_of = |mesh: &Mesh| {
        Samples::take(repeats, || {
            let (seconds, pairs) = timed(|| query::intersecting_pairs(mesh, other));
            ensure!(pairs == expected, "{} pairs, and {} of a new tree", pairs.len(), expected.len());
            Ok(seconds)
        })
    };
    let [refitted, partly, rebuilt] = [time_of(mesh)?, time_of(&partly)?, time_of(&rebuilt)?].map(|times| times.min());
    Ok(Asked { refitted, partly, rebuilt, faces, pairs: expected.len() })
}

fn aging_cells(name: String, aging: &Aging, asked: &Asked) -> [String; 7] {
    [
        name,
        format!("{:.3}", aging.ratio()),
        asked.pairs.to_string(),
        time(asked.refitted),
        time(asked.partly),
        time(asked.rebuilt),
        asked.faces.to_string(),
    ]
}

const AGING: [&str; 6] = ["ratio of costs", "pairs", "refitted", "in part", "rebuilt", "faces rebuilt"];

fn aging_table(first: &'static str) -> Table<7> {
    let [ratio, pairs, refitted, partly, rebuilt, faces] = AGING;
    Table::new([first, ratio, pairs, refitted, partly, rebuilt, faces])
}

/// A knot of 200,000 triangles twisted about its axis, more and more, against itself as it was.
fn twisted(repeats: usize) -> Result<Table<7>> {
    let knot = torus_knot(632, 158, TREFOIL);
    let still = Mesh::new(Positions::F64(knot.vertices.clone()), knot.faces.clone())?;
    let mut table = aging_table("twist, rad");
    for twist in TWISTS {
        let turned = |v: &[f64; 3]| {
            let (s, c) = (twist * v[2]).sin_cos();
            [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2] + 0.01]
        };
        let mut mesh = still.clone();
        let aging = mesh.refit(Positions::F64(knot.vertices.iter().map(turned).collect()))?;
        table.row(aging_cells(twist.to_string(), &aging, &ask(&mesh, (&still).into(), repeats)?));
    }
    Ok(table)
}

/// Each frame refitted from the one before, against the first, moved aside.
fn animated(folder: &Path, name: &str, repeats: usize) -> Result<Table<7>> {
    let Animation { frames, faces } = Animation::read(folder, name)?;
    let mut mesh = Mesh::new(Positions::F32(frames[0].clone()), faces)?;
    let still = mesh.clone();
    let xs = || frames[0].iter().map(|v| f64::from(v[0]));
    let width = xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min);
    let aside = Pose::from_translation([0.25 * width, 0.0, 0.0])?;
    let mut table = aging_table("frame");
    for (number, frame) in frames.into_iter().enumerate() {
        let aging = mesh.refit(Positions::F32(frame))?;
        if number % EVERY == EVERY - 1 {
            table.row(aging_cells((number + 1).to_string(), &aging, &ask(&mesh, still.at(aside), repeats)?));
        }
    }
    Ok(table)
}

/// A baked file: to open, to prove, to believe.
fn baked(surface: &Surface, repeats: usize) -> Result<Table<6>> {
    let (mut mesh, _) = surface.build(1)?;
    let faces = mesh.faces().len();
    let parts = vec![String::new()];
    let provenance = Provenance { sources: (0..faces as u32).collect(), part_of: vec![0; faces], parts, unit: None };
    let path = std::env::temp_dir().join(format!("impinge-refit-{}.impinge", std::process::id()));
    let mut out = BufWriter::new(File::create(&path)?);
    let (write, written) = timed(|| write_baked(&mesh, &provenance, &mut out).and_then(|()| out.flush()));
    written?;
    let read = || -> Result<[f64; 4]> {
        let opened = Samples::take(repeats, || timed_ok(|| Baked::open(&path)).map(|(seconds, _)| seconds))?;
        let baked = Baked::open(&path)?;
        let proved = Samples::take(repeats, || {
            let (seconds, proved) = timed_ok(|| baked.mesh())?;
            ensure!(proved.parts() == mesh.parts(), "what was baked is another mesh");
            Ok(seconds)
        })?;
        let believed = Samples::take(repeats, || timed_ok(|| baked.trusted_mesh()).map(|(seconds, _)| seconds))?;
        Ok([opened.min(), proved.min(), believed.min(), std::fs::metadata(&path)?.len() as f64 / 1e6])
    };
    let times = read();
    std::fs::remove_file(&path).context("removing the baked file")?;
    let [opened, proved, believed, megabytes] = times?;
    let refit = Samples::take(repeats, || {
        let positions = surface.positions.clone();
        timed_ok(|| mesh.refit(positions)).map(|(seconds, _)| seconds)
    })?
    .min();
    let mut table = Table::new(["ventilator, baked", "write", "open", "prove", "believe", "prove / refit"]);
    let share = format!("{:.2}", proved / refit);
    table.row([format!("{megabytes:.0} MB"), time(write), time(opened), time(proved), time(believed), share]);
    Ok(table)
}

fn timed_ok<T, E: std::error::Error + Send + Sync + 'static>(run: impl FnOnce() -> Result<T, E>) -> Result<(f64, T)> {
    let (seconds, result) = timed(run);
    Ok((seconds, result?))
}
