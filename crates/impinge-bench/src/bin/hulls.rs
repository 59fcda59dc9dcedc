//! Times of convex hulls, as JSON for `bench/hulls.py`, which runs qhull on the same points in the
//! same run.
//!
//! `cargo run --release -p impinge-bench --bin hulls -- POINTS...`. A file of points holds three
//! little-endian doubles per point.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Parser;
use impinge::hull::Hull;
use impinge::mesh::Containment;
use impinge::{Mesh, Positions};
use impinge_bench::record::{self, Row};
use impinge_bench::samples::{Samples, timed};
use serde_json::json;

/// Times the hulls of sets of points
#[derive(Parser)]
struct Arguments {
    /// Files of points, three little-endian doubles each
    #[arg(value_name = "POINTS", required = true)]
    files: Vec<PathBuf>,
    /// Number of runs for each file
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Number of threads for building
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
}

fn main() -> Result<()> {
    let Arguments { files, repeats, threads } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    for file in files {
        let points = read(&file)?;
        let reference = Hull::new(&points)?;
        check(&reference, &points).with_context(|| file.display().to_string())?;
        let samples = Samples::take(repeats, || {
            let (seconds, hull) = timed(|| Hull::new(&points));
            ensure!(hull?.faces() == reference.faces(), "the same points have another hull");
            Ok(seconds)
        })?;
        let (vertices, faces) = (reference.vertices(), reference.faces().len());
        record::append(&Row::of_samples(&file.display().to_string(), "hull", &samples))?;
        println!("{}", json!({ "vertices": vertices, "faces": faces, "seconds": samples.seconds() }));
    }
    Ok(())
}

/// Checks that the faces are a closed surface and that every point is inside or on it, by exact
/// crossings of rays, which are independent of hulls.
fn check(hull: &Hull, points: &[[f64; 3]]) -> Result<()> {
    let surface = Mesh::new(Positions::F64(hull.positions().to_vec()), hull.faces().to_vec())?;
    ensure!(surface.is_closed(), "the hull is not closed");
    let outside = surface.contains(points)?.into_iter().filter(|at| *at == Containment::Outside).count();
    ensure!(outside == 0, "{outside} points are outside of their hull");
    Ok(())
}

fn read(file: &Path) -> Result<Vec<[f64; 3]>> {
    let bytes = fs::read(file).with_context(|| file.display().to_string())?;
    let (points, rest) = bytes.as_chunks::<24>();
    ensure!(rest.is_empty(), "{} is no file of points", file.display());
    let coordinate = |bytes: &[u8]| <[u8; 8]>::try_from(bytes).map(f64::from_le_bytes).unwrap_or_default();
    Ok(points.iter().map(|p| [coordinate(&p[..8]), coordinate(&p[8..16]), coordinate(&p[16..])]).collect())
}
