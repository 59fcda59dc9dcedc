//! Steps of small worlds of which all bodies move, in impinge and rapier3d, in one run on one
//! thread.
//!
//! `cargo run --release -p impinge-bench --features peers --bin small_worlds`
//!
//! rapier3d detects collisions without dynamics. A step of either moves all bodies and keeps the
//! pairs that intersect, or their contacts. The pairs of impinge must be those of the queries of
//! two shapes. rapier3d computes in single precision, so a few of its pairs may differ.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

mod engines;
mod scene;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::world::NarrowPhase;
use impinge_bench::samples::Samples;
use impinge_bench::table::{Table, time};

use engines::{Engine, Impinge, Rapier};
use scene::{Scene, Shapes, VARIANTS};

/// Times steps of small worlds, by shapes and by narrow phases
#[derive(Parser)]
struct Arguments {
    /// Numbers of bodies
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [100, 1000, 10_000])]
    bodies: Vec<usize>,
    /// Number of steps of each world
    #[arg(long, value_name = "N", default_value_t = 200)]
    steps: usize,
    /// Only worlds of these shapes
    #[arg(long)]
    shapes: Option<Shapes>,
}

fn main() -> Result<()> {
    let Arguments { bodies, steps, shapes: only } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let headings = ["world", "pairs", "intersections", "rapier3d intersections", "contacts", "rapier3d contacts"];
    let mut table = Table::new(headings);
    for &count in &bodies {
        for (shapes, name) in [(Shapes::Spheres, "spheres"), (Shapes::Boxes, "boxes")] {
            if only.is_some_and(|only| only != shapes) {
                continue;
            }
            let scene = Scene::new(count, shapes)?;
            let ([intersections, their_intersections], pairs) = compare(&scene, NarrowPhase::Intersections, steps)?;
            let ([contacts, their_contacts], _) = compare(&scene, NarrowPhase::Contacts, steps)?;
            table.row([
                format!("{count} {name}"),
                pairs.to_string(),
                time(intersections),
                time(their_intersections),
                time(contacts),
                time(their_contacts),
            ]);
        }
    }
    println!("{table}median time of a step, all bodies move");
    table.record("", 1)
}

/// Returns the median times of a step of both engines, in seconds, and the number of pairs of
/// impinge after the last step. The engines step in turn.
///
/// # Errors
/// Returns an error if impinge has other pairs than the queries of two shapes, or if more than one
/// in a thousand pairs of rapier3d differs from them.
fn compare(scene: &Scene, narrow_phase: NarrowPhase, steps: usize) -> Result<([f64; 2], usize)> {
    let mut engines: [Box<dyn Engine>; 2] =
        [Box::new(Impinge::new(scene, narrow_phase)?), Box::new(Rapier::new(scene, narrow_phase))];
    let mut seconds = [Vec::new(), Vec::new()];
    for step in 0..VARIANTS + steps {
        for (engine, seconds) in engines.iter_mut().zip(&mut seconds) {
            let taken = engine.step(step % VARIANTS)?;
            if step >= VARIANTS {
                seconds.push(taken);
            }
        }
    }
    let expected = scene.pairs((VARIANTS + steps - 1) % VARIANTS)?;
    let [ours, theirs] = engines.map(|engine| engine.pairs());
    ensure!(ours == expected, "the world has other pairs than the queries");
    let shared = theirs.iter().filter(|pair| expected.binary_search(pair).is_ok()).count();
    let differing = theirs.len() + expected.len() - 2 * shared;
    ensure!(differing * 1000 <= expected.len(), "{differing} of {} pairs differ in rapier3d", expected.len());
    let median = |seconds: Vec<f64>| -> Result<f64> {
        let mut seconds = seconds.into_iter();
        Ok(Samples::take(steps, || seconds.next().ok_or_else(|| anyhow::anyhow!("a step is missing")))?.median())
    };
    let [ours, theirs] = seconds.map(median);
    Ok(([ours?, theirs?], expected.len()))
}
