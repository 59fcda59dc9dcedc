//! First hits of rays from a file, for `bench/rivals_rays.py`: one by one, and in one call.
//!
//! `cargo run --release -p impinge-bench --bin rays -- --mesh MESH --rays RAYS --hits HITS`
//!
//! A ray is six floats in single precision, its origin and its direction. A hit is its parameter as
//! a double and its face, both little-endian. A ray that hits nothing has the parameter infinity
//! and the face 2^32 - 1.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;
use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::mesh::{Ray, RayHit};
use impinge_bench::record::{self, Row};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::Choice;

/// Times the first hits of rays on one thread, and writes the hits.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    mesh: Choice,
    /// File of rays
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
    /// File for the hits
    #[arg(long, value_name = "FILE")]
    hits: PathBuf,
    /// Number of runs of all rays
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let (mesh, _) = arguments.mesh.surface()?.build(1)?;
    let bytes = std::fs::read(&arguments.rays)?;
    ensure!(bytes.len() % 24 == 0, "{} bytes are no rays of six floats", bytes.len());
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    let vector = |bytes: &[u8]| [number(bytes), number(&bytes[4..]), number(&bytes[8..])];
    let rays =
        bytes.chunks(24).map(|row| Ok(Ray::new(vector(row), vector(&row[12..]))?)).collect::<Result<Vec<_>>>()?;

    let single: Vec<Option<RayHit>> = rays.iter().map(|ray| mesh.ray_cast(ray)).collect();
    let one_by_one = Samples::take(arguments.repeats, || {
        let hits = || rays.iter().filter(|ray| black_box(mesh.ray_cast(black_box(ray))).is_some()).count();
        let (seconds, count) = timed(hits);
        ensure!(count == single.iter().flatten().count(), "not the hits of before");
        Ok(seconds)
    })?;
    let in_one_call = Samples::take(arguments.repeats, || {
        let (seconds, hits) = timed(|| mesh.ray_casts(black_box(&rays)));
        ensure!(hits == single, "many rays do not hit what single ones do");
        Ok(seconds)
    })?;
    let row = |hit: &Option<RayHit>| {
        let (t, face) = hit.map_or((f64::INFINITY, u32::MAX), |hit| (hit.t, hit.face));
        [&t.to_le_bytes()[..], &face.to_le_bytes()].concat()
    };
    std::fs::write(&arguments.hits, single.iter().flat_map(row).collect::<Vec<u8>>())?;
    record::append(&Row::of_samples("all rays", "one by one", &one_by_one))?;
    record::append(&Row::of_samples("all rays", "in one call", &in_one_call))?;
    println!(
        "{}",
        serde_json::json!({ "one_by_one_seconds": one_by_one.seconds(), "in_one_call_seconds": in_one_call.seconds() })
    );
    Ok(())
}
