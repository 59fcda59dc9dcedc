//! Distances of two knots of two million triangles, apart, near and nested, without a cache and
//! with the cache of the last query.
//!
//! `cargo run --release -p impinge-bench --bin distance`
//!
//! Every distance is computed without and with the cache, and must be the same.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;
use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::query::{Cache, Query};
use impinge::{Mesh, Pose};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::{Choice, Surface, parse_pose};
use impinge_bench::table::{Table, spread};

/// Target time of one sample, in seconds: far above the clock's resolution and below a time slice.
const BATCH_SECONDS: f64 = 2e-3;

/// Times the distance of two meshes at one or more poses.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    mesh: Choice,
    /// File of the second mesh, instead of the first mesh again
    #[arg(long, value_name = "FILE")]
    other: Option<PathBuf>,
    /// Pose of the second mesh; may be repeated, and then the cache of each pose is also used for
    /// the next
    #[arg(long, value_name = "TX,TY,TZ,QW,QX,QY,QZ", value_parser = parse_pose, allow_hyphen_values = true)]
    pose_b: Vec<Pose>,
    /// File of poses, seven numbers per row, instead of --pose-b
    #[arg(long, value_name = "FILE", conflicts_with = "pose_b")]
    poses: Option<PathBuf>,
    /// Number of runs at each pose
    #[arg(long, value_name = "N", default_value_t = 9)]
    repeats: usize,
    /// Print one JSON object per pose, in seconds, instead of a table
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let (mesh, _) = arguments.mesh.surface()?.build(1)?;
    let other = match &arguments.other {
        Some(path) => Surface::load(path)?.build(1)?.0,
        None => mesh.clone(),
    };
    let mut table = Table::new(["pose", "distance", "cold minimum", "cold median", "seeded minimum", "seeded median"]);
    let mut following = Cache::default();
    for (number, pose) in (1..).zip(arguments.standings()?) {
        let measured = measure(&mesh, &other, pose, &mut following, arguments.repeats)?;
        if arguments.json {
            println!("{}", measured.json());
        } else {
            let ([cold_min, cold_median], [seeded_min, seeded_median]) =
                (spread(&measured.cold), spread(&measured.seeded));
            let distance = format!("{:.9}", measured.distance);
            table.row([number.to_string(), distance, cold_min, cold_median, seeded_min, seeded_median]);
        }
    }
    if !arguments.json {
        print!("{table}");
        table.record(&format!("{} triangles", mesh.faces().len()), 1)?;
    }
    Ok(())
}

impl Arguments {
    fn standings(&self) -> Result<Vec<Pose>> {
        if let Some(path) = &self.poses {
            let text = std::fs::read_to_string(path)?;
            return text.lines().map(|line| parse_pose(line).map_err(anyhow::Error::msg)).collect();
        }
        if !self.pose_b.is_empty() {
            return Ok(self.pose_b.clone());
        }
        let turned = |translation| Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, translation);
        Ok(vec![turned([6.0, 0.5, 0.3])?, turned([5.72, 0.5, 0.3])?, turned([100.0, 0.0, 0.0])?])
    }
}

struct Measured {
    distance: f64,
    cold: Samples,
    /// Times with the cache of the previous pose.
    following: Samples,
    /// Times with the cache of the same pose.
    seeded: Samples,
}

impl Measured {
    fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "distance": self.distance,
            "cold_seconds": self.cold.seconds(),
            "seeded_seconds": self.seeded.seconds(),
            "following_seconds": self.following.seconds(),
        })
    }
}

fn measure(a: &Mesh, b: &Mesh, pose: Pose, last: &mut Cache, repeats: usize) -> Result<Measured> {
    let ask = |cache: &mut Cache| Query::new().with_cache(cache).distance(black_box(a), black_box(b.at(pose)));
    let (once, cold) = timed(|| ask(&mut Cache::default()));
    let calls = (BATCH_SECONDS / once).clamp(1.0, 100.0) as usize;
    let from = |witness: &Cache| {
        Samples::take(repeats, || {
            let mut witnesses = vec![witness.clone(); calls];
            let (seconds, ()) = timed(|| {
                for witness in &mut witnesses {
                    black_box(ask(witness));
                }
            });
            anyhow::Ok(seconds / calls as f64)
        })
    };
    let following = from(last)?;
    let first = ask(last);
    ensure!(first == cold, "{first:?} from the last witness and {cold:?} without");
    let (cold, seeded) = (from(&Cache::default())?, from(last)?);
    ensure!(ask(&mut last.clone()) == first, "asked again, the distance is another");
    Ok(Measured { distance: first.upper, cold, following, seeded })
}
