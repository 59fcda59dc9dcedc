//! Measured answers to the questions that *Notes on Real Time Collision Detection*, 3.1, does not
//! settle: the builder, the degree, the volume, wrapped or layered. The meshes are generated and,
//! if `IMPINGE_DATA` is set, real.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin hierarchies`
//!
//! Every tree answers the same query, all intersecting pairs of triangles, and each answer is
//! compared with the library's. Times are minima of the processor time of single runs on one
//! thread. The counted work of a tree is the same on every machine.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

mod costs;
mod question;
mod rows;

use anyhow::Result;
use clap::Parser;
use impinge::hierarchy::{Builder, Enclosure};
use impinge::volume::{Aabb, BoundingSphere, Capsule, Kdop14, Kdop18, Kdop26, Lozenge, Obb};
use impinge_bench::table::Table;

use question::Question;
use rows::Runs;

/// Measures trees of every kind, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Number of runs of each traversal; at most three of each build
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Number of threads for building
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Measure only meshes whose name contains this text
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build_global()?;
    let runs = Runs { repeats: arguments.repeats };
    for question in Question::all()?.iter().filter(|question| question.name.contains(&arguments.only)) {
        println!("\n## {}: {} triangles each, {} pairs\n", question.name, question.size(), question.pairs.len());
        println!("Builders: boxes, degree 8, eight triangles a leaf\n");
        let mut table = Table::new(rows::BUILDER_HEADINGS);
        for builder in Builder::ALL {
            table.row(rows::builder(question, builder, &runs)?);
        }
        println!("{table}");

        println!("Degree: boxes, by binned SAH, one triangle a leaf\n");
        let mut table = Table::new(rows::DEGREE_HEADINGS);
        table.row(rows::degree::<2>(question, &runs)?);
        table.row(rows::degree::<4>(question, &runs)?);
        table.row(rows::degree::<8>(question, &runs)?);
        table.row(rows::degree::<16>(question, &runs)?);
        println!("{table}");

        println!("Volume: degree 2, by binned SAH, one triangle a leaf; T by the counts and the costs of one\n");
        let mut table = Table::new(rows::VOLUME_HEADINGS);
        for enclosure in [Enclosure::Wrapped, Enclosure::Layered] {
            table.row(rows::volume::<Aabb>(question, "box", enclosure, &runs)?);
            table.row(rows::volume::<BoundingSphere>(question, "sphere", enclosure, &runs)?);
            table.row(rows::volume::<Capsule>(question, "capsule", enclosure, &runs)?);
            table.row(rows::volume::<Lozenge>(question, "lozenge", enclosure, &runs)?);
            table.row(rows::volume::<Obb>(question, "oriented box", enclosure, &runs)?);
            table.row(rows::volume::<Kdop14>(question, "14-DOP", enclosure, &runs)?);
            table.row(rows::volume::<Kdop18>(question, "18-DOP", enclosure, &runs)?);
            table.row(rows::volume::<Kdop26>(question, "26-DOP", enclosure, &runs)?);
        }
        println!("{table}");
    }
    Ok(())
}
