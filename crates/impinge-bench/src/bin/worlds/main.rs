//! Worlds of many moving bodies: meshes that tumble in a box, the steadiness of steps while bodies
//! are added and removed, and the fastest broad phase for many scenes.
//!
//! `cargo run --release -p impinge-bench --bin worlds -- meshes`
//!
//! Every answer is checked: pairs of meshes with the query for two meshes, and pairs of boxes
//! between all broad phases.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

mod churn;
mod few;
mod kinds;
mod meshes;
mod scenes;

use anyhow::Result;
use clap::{Parser, Subcommand};

/// Times worlds, and checks every answer
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    question: Question,
    /// Number of threads; all processors by default
    #[arg(long, global = true)]
    threads: Option<usize>,
}

#[derive(Subcommand)]
enum Question {
    /// Bodies that share a few meshes of 20,480 triangles, tumbling in a box, decided exactly, at
    /// 60 steps per second
    Meshes {
        #[arg(long, default_value_t = 2000)]
        bodies: usize,
        #[arg(long, default_value_t = 60)]
        steps: usize,
        /// Share of the box that the meshes fill
        #[arg(long, default_value_t = 0.1)]
        filled: f64,
        /// Find contacts too, which takes minutes
        #[arg(long)]
        contacts: bool,
    },
    /// Steps in which bodies are steadily added and removed: work and times, the median and the
    /// 99.9th percentile
    Churn {
        #[arg(long, default_value_t = 10_000)]
        bodies: usize,
        #[arg(long, default_value_t = 10_000)]
        steps: usize,
    },
    /// Every broad phase over numbers of bodies, shares that move and spreads of sizes
    Kinds {
        #[arg(long, default_value_t = 100_000)]
        most: usize,
    },
    /// A few of many boxes move: a step by its phases, and a step of the partition alone
    Few {
        #[arg(long, default_value_t = 1_000_000)]
        bodies: usize,
        #[arg(long, default_value_t = 1000)]
        moving: usize,
        #[arg(long, default_value_t = 60)]
        steps: usize,
    },
}

fn main() -> Result<()> {
    let Arguments { question, threads } = Arguments::parse();
    let threads = threads.unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    println!("{} threads", rayon::current_num_threads());
    match question {
        Question::Meshes { bodies, steps, filled, contacts } => meshes::tumble(bodies, steps, filled, contacts),
        Question::Churn { bodies, steps } => churn::steady(bodies, steps),
        Question::Kinds { most } => kinds::compare(most),
        Question::Few { bodies, moving, steps } => few::compare(bodies, moving, steps),
    }
}
