//! Bounding volumes of real meshes, and the minimal sphere of a million points compared with the
//! speed of memory.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin volumes`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::fs::File;
use std::hint::black_box;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Parser;
use flate2::read::MultiGzDecoder;
use impinge::volume::fit::{self, Coordinate, FittedSphere};
use impinge::volume::{BoundingVolume, Capsule, Kdop14, Kdop18, Kdop26, Lozenge, MinMax, Obb};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_testkit::env_rob::data_folder;
use impinge_testkit::generate::Rng;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Scans and CAD parts in the folder that `IMPINGE_DATA` names. The human mesh of the repository is
/// always measured.
const MESHES: [&str; 4] =
    ["meshes/stanford-bunny.obj", "meshes/igea.ply", "big/cad_ventilator.ply.gz", "big/cad_11752.ply.gz"];

/// Times bounding volumes, and checks that they contain every point
#[derive(Parser)]
struct Arguments {
    /// Number of runs of each construction
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Number of threads for fitting
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Skip the real meshes
    #[arg(long)]
    clouds: bool,
}

type Construct = fn(&[[f64; 3]]) -> Result<FittedSphere, impinge::InputError>;

const SPHERES: [(&str, Construct); 6] = [
    ("mean", fit::mean_sphere),
    ("box center", fit::box_sphere),
    ("Ritter", fit::ritter_sphere),
    ("PCA", fit::principal_sphere),
    ("refined", fit::refined_sphere),
    ("minimal", fit::minimal_sphere),
];

fn main() -> Result<()> {
    let Arguments { repeats, threads, clouds } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    minimal_beside_memory(repeats)?;
    if clouds {
        return Ok(());
    }
    let mut meshes = vec![("human".to_owned(), Surface::load(&Path::new(ROOT).join("data/human_makehuman_cc0.ply"))?)];
    if let Some(folder) = data_folder() {
        for name in MESHES {
            let stem = name.rsplit('/').next().unwrap_or(name).split('.').next().unwrap_or(name);
            meshes.push((stem.to_owned(), load(&folder.join(name))?));
        }
    }
    let points: Vec<(String, Vec<[f64; 3]>)> =
        meshes.into_iter().map(|(name, surface)| (name, corners(&surface))).collect();
    println!("\nRadius over the minimal one, and time");
    let mut table = Table::new(["", "points", "mean", "box center", "Ritter", "PCA", "refined", "minimal"]);
    for (name, points) in &points {
        table.row(spheres(name, points, repeats)?);
    }
    print!("{table}");
    println!("\nVolume over that of the smallest oriented box, and time");
    let mut table =
        Table::new(["", "box", "sphere", "capsule", "lozenge", "PCA box", "oriented", "14", "18", "26", "proved"]);
    for (name, points) in &points {
        table.row(others(name, points)?);
    }
    print!("{table}");
    Ok(())
}

/// Times the minimal sphere of a million points, in milliseconds and in passes over memory. A pass
/// is the time of one thread to add up all coordinates.
fn minimal_beside_memory(repeats: usize) -> Result<()> {
    const COUNT: usize = 1_000_000;
    let mut rng = Rng::new(1);
    let cube: Vec<[f64; 3]> = (0..COUNT).map(|_| std::array::from_fn(|_| rng.uniform(-1.0, 1.0))).collect();
    let normal = |rng: &mut Rng| (0..12).map(|_| rng.unit()).sum::<f64>() - 6.0;
    let bell: Vec<[f64; 3]> = (0..COUNT).map(|_| std::array::from_fn(|_| normal(&mut rng))).collect();
    let mut ball: Vec<[f64; 3]> = Vec::with_capacity(COUNT);
    while ball.len() < COUNT {
        let point: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
        if point.iter().map(|x| x * x).sum::<f64>() < 1.0 {
            ball.push(point);
        }
    }
    let single: Vec<[f32; 3]> = cube.iter().map(|p| p.map(|x| x as f32)).collect();
    let mut table = Table::new(["minimal sphere of 1,000,000", "least", "median", "one pass", "passes"]);
    for (name, cloud) in [("in a cube", &cube), ("in a ball", &ball), ("bell-shaped", &bell)] {
        table.row(passes(name, cloud, repeats)?);
    }
    table.row(passes("in a cube, single precision", &single, repeats)?);
    print!("{table}");
    Ok(())
}

fn passes<T: Coordinate>(name: &str, cloud: &[[T; 3]], repeats: usize) -> Result<[String; 5]> {
    let mut fitted = None;
    let samples = Samples::take(3 * repeats, || {
        let (seconds, sphere) = timed(|| fit::minimal_sphere(black_box(cloud)));
        fitted = Some(sphere?);
        anyhow::Ok(seconds)
    })?;
    let pass = Samples::take(3 * repeats, || anyhow::Ok(timed(|| black_box(sum(black_box(cloud)))).0))?;
    let sphere = fitted.context("no run")?.sphere;
    ensure!(cloud.iter().all(|p| sphere.contains(p.map(Into::into))), "{name}: a point is outside");
    let ratio = format!("{:.2}", samples.min() / pass.min());
    Ok([name.to_owned(), time(samples.min()), time(samples.median()), time(pass.min()), ratio])
}

/// Returns the sum of all coordinates, by lanes, so that only memory takes time.
fn sum<T: Coordinate>(cloud: &[[T; 3]]) -> f64 {
    let mut lanes = [0.0; 32];
    let (groups, _) = cloud.as_flattened().as_chunks::<32>();
    for group in groups {
        for (lane, &x) in lanes.iter_mut().zip(group) {
            *lane += x.into();
        }
    }
    lanes.iter().sum()
}

fn spheres(name: &str, points: &[[f64; 3]], repeats: usize) -> Result<[String; 8]> {
    let least = fit::minimal_sphere(points)?;
    let mut row = [const { String::new() }; 8];
    row[0] = name.to_owned();
    row[1] = points.len().to_string();
    for (column, (kind, construct)) in SPHERES.into_iter().enumerate() {
        let mut radius = 0.0;
        let samples = Samples::take(repeats, || {
            let (seconds, fitted) = timed(|| construct(points));
            let fitted = fitted?;
            ensure!(points.iter().all(|&p| fitted.sphere.contains(p)), "{name}: the {kind} sphere leaves out a point");
            radius = fitted.sphere.radius();
            Ok(seconds)
        })?;
        row[column + 2] = format!("{:.4} {}", radius / least.lower, time(samples.min()));
    }
    Ok(row)
}

fn others(name: &str, points: &[[f64; 3]]) -> Result<[String; 11]> {
    let fitted = fit::obb(points)?;
    let unit = fitted.obb.volume();
    let volumes = [
        measure(name, points, MinMax::of)?,
        measure(name, points, |points| fit::minimal_sphere(points).map(|fitted| fitted.sphere))?,
        measure::<Capsule>(name, points, fit::capsule)?,
        measure::<Lozenge>(name, points, fit::lozenge)?,
        measure::<Obb>(name, points, fit::principal_obb)?,
        measure::<Obb>(name, points, |points| fit::obb(points).map(|fitted| fitted.obb))?,
        measure::<Kdop14>(name, points, Kdop14::of)?,
        measure::<Kdop18>(name, points, Kdop18::of)?,
        measure::<Kdop26>(name, points, Kdop26::of)?,
    ];
    let mut row = [const { String::new() }; 11];
    row[0] = name.to_owned();
    for (cell, (volume, seconds)) in row[1..].iter_mut().zip(volumes) {
        *cell = format!("{:.3} {}", volume / unit, time(seconds));
    }
    row[10] = format!("{:.2}", unit / fitted.volume_lower);
    Ok(row)
}

fn measure<V: BoundingVolume>(
    name: &str,
    points: &[[f64; 3]],
    construct: impl Fn(&[[f64; 3]]) -> Result<V, impinge::InputError>,
) -> Result<(f64, f64)> {
    let (seconds, volume) = timed(|| construct(points));
    let volume = volume?;
    ensure!(points.iter().all(|&p| volume.contains(p)), "{name}: {volume:?} leaves out a point");
    Ok((volume.volume(), seconds))
}

/// Returns the vertices that a face uses.
fn corners(surface: &Surface) -> Vec<[f64; 3]> {
    let mut used = vec![false; surface.positions.len()];
    surface.faces.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    (0..used.len()).filter(|&vertex| used[vertex]).map(|vertex| surface.positions.get(vertex)).collect()
}

fn load(path: &Path) -> Result<Surface> {
    if path.extension().is_none_or(|extension| extension != "gz") {
        return Surface::load(path);
    }
    let plain: PathBuf = std::env::temp_dir().join(path.file_stem().unwrap_or_default());
    let mut content = MultiGzDecoder::new(File::open(path).with_context(|| path.display().to_string())?);
    io::copy(&mut content, &mut File::create(&plain)?)?;
    Surface::load(&plain)
}
