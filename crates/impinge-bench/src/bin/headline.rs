//! The headline benchmark: build, refit, all intersecting pairs and first hit of two knots of two
//! million triangles.
//!
//! `cargo run --release -p impinge-bench --bin headline`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use impinge::hierarchy::Builder;
use impinge::mesh::Options;
use impinge::simd::{Level, levels};
use impinge::{Mesh, Pose};
use impinge_bench::questions::{Asked, ask_impinge};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::{Choice, Standing, Surface, parse_pose};
use impinge_bench::table::{Table, spread};

/// Maximum number of builds, because builds are slow.
const MOST_BUILDS: usize = 9;

/// Times impinge on two meshes, and checks every answer.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    mesh: Choice,
    /// File of the second mesh, instead of the first mesh again
    #[arg(long, value_name = "FILE")]
    other: Option<PathBuf>,
    /// Pose of the second mesh, instead of three poses: a translation, then a unit quaternion
    #[arg(long, value_name = "TX,TY,TZ,QW,QX,QY,QZ", value_parser = parse_pose, allow_hyphen_values = true)]
    pose_b: Option<Pose>,
    /// Builder of the hierarchies: auto, morton, median, binned-sah, sweep-sah, ploc, insertion or
    /// reinsertion
    #[arg(long, value_name = "NAME", default_value = "auto", value_parser = parse_builder)]
    builder: Builder,
    /// Number of threads for building and queries
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Number of runs of each query
    #[arg(long, value_name = "N", default_value_t = 9)]
    repeats: usize,
    /// Fail if the number of pairs differs
    #[arg(long, value_name = "K", requires = "pose_b")]
    expect: Option<usize>,
    /// Vector unit: sse2, sse4.2, avx2 or neon if the processor has it, or scalar if built with the
    /// feature impinge/scalar [default: the widest]
    #[arg(long, value_name = "NAME", value_parser = parse_level)]
    level: Option<Level>,
    /// Print one JSON object per pose, in seconds, instead of a table
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build_global()?;
    let builds = arguments.repeats.clamp(1, MOST_BUILDS);
    let surface = arguments.mesh.surface()?;
    let (mut mesh, build) = surface.build_with(arguments.builder, builds)?;
    let refit = refits(&mut mesh, &surface, builds)?;
    let other = match &arguments.other {
        Some(path) => Surface::load(path)?.build_with(arguments.builder, 1)?.0,
        None => mesh.clone(),
    };
    let mut options = Options::default();
    if let Some(level) = arguments.level {
        options.level = level;
    }
    let mut answers = Vec::new();
    for standing in arguments.standings()? {
        let asked = ask_impinge(arguments.repeats, (&mesh).into(), other.at(standing.world_from_b), &options)
            .with_context(|| format!("pose {}", standing.name))?;
        standing.check(asked.pairs.len())?;
        answers.push((standing, asked));
    }
    if arguments.json {
        for (_, asked) in &answers {
            println!("{}", json(&build, &refit, asked));
        }
    } else {
        print_table(&mesh, [("build", &build), ("refit", &refit)], &answers)?;
    }
    Ok(())
}

impl Arguments {
    fn standings(&self) -> Result<Vec<Standing>> {
        if let Some(pose) = self.pose_b {
            return Ok(vec![Standing::given(pose, self.expect)]);
        }
        let is_known = self.mesh.is_headline() && self.other.is_none();
        let expected = |s: Standing| Standing { expected: s.expected.filter(|_| is_known), ..s };
        Ok(Standing::named()?.map(expected).into())
    }
}

fn parse_level(name: &str) -> Result<Level, String> {
    let levels = levels();
    let found = levels.iter().find(|(known, _)| *known == name);
    found.map(|&(_, level)| level).ok_or_else(|| {
        let names: Vec<&str> = levels.iter().map(|&(name, _)| name).collect();
        format!("this processor has {}", names.join(", "))
    })
}

fn parse_builder(name: &str) -> Result<Builder, String> {
    Builder::named(name).ok_or_else(|| "that is none of the builders".to_owned())
}

/// Times refits to the same positions, which must not change the tree.
fn refits(mesh: &mut Mesh, surface: &Surface, repeats: usize) -> Result<Samples> {
    Samples::take(repeats, || {
        let positions = surface.positions.clone();
        let (seconds, aging) = timed(|| mesh.refit(positions));
        ensure!(aging?.ratio() == 1.0, "the same places are another tree");
        Ok(seconds)
    })
}

/// Returns the JSON that `bench/rivals.py` reads.
fn json(build: &Samples, refit: &Samples, asked: &Asked) -> serde_json::Value {
    serde_json::json!({
        "pairs": asked.pairs.len(),
        "build_seconds": build.seconds(),
        "refit_seconds": refit.seconds(),
        "all_pairs_seconds": asked.all_pairs.seconds(),
        "first_hit_seconds": asked.first_hit.seconds(),
    })
}

fn print_table(mesh: &Mesh, preparations: [(&str, &Samples); 2], answers: &[(Standing, Asked)]) -> Result<()> {
    let faces = mesh.faces().len();
    println!("{faces} triangles, {:.1} bytes each", mesh.memory() as f64 / faces.max(1) as f64);
    let mut table = Table::new(["", "pairs", "minimum", "median"]);
    for (name, samples) in preparations {
        let [min, median] = spread(samples);
        table.row([name.to_owned(), String::new(), min, median]);
    }
    for (standing, asked) in answers {
        for (question, samples) in [("all pairs", &asked.all_pairs), ("first hit", &asked.first_hit)] {
            let [min, median] = spread(samples);
            table.row([format!("{}, {question}", standing.name), asked.pairs.len().to_string(), min, median]);
        }
    }
    print!("{table}");
    table.record(&format!("{faces} triangles"), 1)
}
