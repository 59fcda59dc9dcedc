//! Space partitions compared with parry3d's `Bvh`, kiddo and rstar, in one run on one thread. Every
//! answer is checked.
//!
//! `cargo run --release -p impinge-bench --features peers --bin partitions`
//!
//! Boxes have coordinates that single precision holds, so that parry3d gets the same boxes. Times
//! are processor times, the minimum and the median of the steps. A step starts with all new boxes
//! and ends with a list of pairs, which is sorted for ours.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

mod all_moving;
mod few_moving;
mod questions;
mod scenes;

use anyhow::Result;
use clap::Parser;

/// Times space partitions, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Numbers of boxes that all move
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [1_000, 10_000, 100_000, 1_000_000])]
    counts: Vec<usize>,
    /// Number of steps of each
    #[arg(long, value_name = "N", default_value_t = 9)]
    steps: usize,
    /// Number of boxes of which one in a thousand moves
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    many: usize,
    /// Number of boxes and of points in the queries
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    asked: usize,
    /// Print only the times with all boxes moving, as JSON
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let Arguments { counts, steps, many, asked, json } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let like = all_moving::compare(scenes::like, &counts, steps)?;
    let spread = all_moving::compare(scenes::pareto, &counts, steps)?;
    if json {
        println!("{}", serde_json::json!({ "like": all_moving::json(&like), "pareto": all_moving::json(&spread) }));
        return Ok(());
    }
    all_moving::print("sizes 0.5 to 1.5 at mean spacing 2", &like);
    all_moving::print("sizes of a Pareto distribution over a ratio of 1,000", &spread);
    few_moving::compare(many, steps)?;
    questions::compare(asked)
}
