//! `impinge world`: times each phase of a world of many moving bodies.

mod json;
mod plot;
mod report;
mod scene;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use impinge::world::{BroadPhase, NarrowPhase, Options, World, WorldError};

use crate::failure::Failure;
use crate::progress::Bar;
use crate::{Verdict, console, output};
use scene::{Mix, Motion, Recipe, Scene, Sizes};

/// Maximum value of `--threads`: more than any machine has processors. The answer does not depend
/// on the number of threads.
const MAX_THREADS: i64 = 1024;

/// Time a scene of many moving bodies
///
/// Runs a scripted scene and reports the time of each phase of a step and the number of pairs.
/// Bodies pass through each other, so every broad phase has the same work and finds the same pairs.
///
/// Exit code: 0 if the scene ran, 2 if not.
#[derive(Args)]
pub(crate) struct Arguments {
    /// How the bodies move
    #[arg(long, value_name = "SCENE", default_value = "brownian")]
    scene: Motion,
    /// Number of bodies
    #[arg(short = 'n', long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    bodies: u32,
    /// Sizes of the bodies
    #[arg(long, value_name = "SIZES", default_value = "like")]
    sizes: Sizes,
    /// Shapes of the bodies
    #[arg(long, value_name = "MIX", default_value = "boxes")]
    mix: Mix,
    /// Number of steps, at 60 per second
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
    /// How to find pairs of overlapping boxes
    #[arg(long, value_name = "KIND", default_value = "auto")]
    broad_phase: BroadPhaseArgument,
    /// Work to do for each pair of overlapping boxes
    #[arg(long, value_name = "WHAT", default_value = "contacts")]
    narrow_phase: NarrowPhaseArgument,
    /// Seed of the random numbers: another seed makes another scene of the same kind
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Draw the times of the phases over the steps, to an .svg file
    #[arg(long, value_name = "OUT")]
    plot: Option<PathBuf>,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
    /// Number of threads to use; all processors by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    threads: Option<u16>,
}

/// Values of `--broad-phase`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BroadPhaseArgument {
    Auto,
    Every,
    Tree,
    Columns,
    Grid,
    OneAxis,
    ThreeAxes,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum NarrowPhaseArgument {
    /// Nothing: report pairs whose boxes overlap
    Boxes,
    /// Whether the bodies intersect
    Intersections,
    /// Whether the bodies intersect, and their contacts
    Contacts,
}

impl BroadPhaseArgument {
    fn kind(self) -> BroadPhase {
        match self {
            Self::Auto => BroadPhase::Auto,
            Self::Every => BroadPhase::Every,
            Self::Tree => BroadPhase::Tree,
            Self::Columns => BroadPhase::Columns,
            Self::Grid => BroadPhase::Grid,
            Self::OneAxis => BroadPhase::OneAxis,
            Self::ThreeAxes => BroadPhase::ThreeAxes,
        }
    }
}

impl NarrowPhaseArgument {
    fn kind(self) -> NarrowPhase {
        match self {
            Self::Boxes => NarrowPhase::Boxes,
            Self::Intersections => NarrowPhase::Intersections,
            Self::Contacts => NarrowPhase::Contacts,
        }
    }
}

/// Names of the phases of a step, in order.
const PHASES: [&str; 5] = ["realign", "take", "broad", "narrow", "report"];

/// Times and counts of one step.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    /// Time of each phase, in seconds.
    seconds: [f64; PHASES.len()],
    moved: usize,
    /// Number of pairs of boxes that overlap.
    candidates: usize,
    /// Number of pairs of shapes that were tested.
    examined: usize,
    /// Number of pairs that intersect.
    pairs: usize,
    began: usize,
    ended: usize,
}

impl Step {
    fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }
}

/// All results of a run.
struct Outcome {
    recipe: Recipe,
    options: Options,
    threads: usize,
    /// Time to insert all bodies, in seconds.
    insert: f64,
    first: Step,
    steps: Vec<Step>,
}

/// Runs the scene and prints the answer.
///
/// # Errors
/// Returns an error if the threads cannot be started, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    if let Some(path) = &arguments.plot {
        if output::extension(path) != "svg" {
            return Err(output::unknown_extension(path, ".svg"));
        }
        output::validate(path, &[])?;
    }
    let outcome = match arguments.threads {
        None => measure(arguments),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|error| Failure::new("threads", format!("cannot start {threads} threads: {error}")))?
            .install(|| measure(arguments)),
    };
    let outcome = outcome.map_err(|error| Failure::new("scene", error.to_string()))?;
    if let Some(path) = &arguments.plot {
        output::write(path, |out| plot::write(out, &outcome))?;
    }
    console::print_answer(&if arguments.json { json::object(&outcome) } else { report::text(&outcome) })?;
    Ok(Verdict::Clear)
}

fn measure(arguments: &Arguments) -> Result<Outcome, WorldError> {
    let &Arguments { scene: motion, sizes, mix, seed, .. } = arguments;
    let recipe = Recipe { motion, sizes, mix, bodies: arguments.bodies as usize, seed };
    let options = Options { broad_phase: arguments.broad_phase.kind(), narrow_phase: arguments.narrow_phase.kind() };
    let start = Instant::now();
    let mut world = World::with_options(options);
    let mut scene = Scene::new(&recipe, &mut world)?;
    let insert = start.elapsed().as_secs_f64();
    let mut pairs = 0;
    let bar = Bar::begin("stepping", arguments.steps.into());
    let mut one = |step: usize| -> Result<Step, WorldError> {
        let moves = if step == 0 { Vec::new() } else { scene.moves(step)? };
        let mut seconds = [0.0; PHASES.len()];
        let mut last = Instant::now();
        let events = world.step_observed(&moves, &mut |phase| {
            seconds[phase as usize] = last.elapsed().as_secs_f64();
            last = Instant::now();
        })?;
        pairs = pairs + events.began.len() - events.ended.len();
        bar.advance();
        let (began, ended) = (events.began.len(), events.ended.len());
        let work = events.work;
        Ok(Step {
            seconds,
            moved: moves.len(),
            candidates: work.candidates,
            examined: work.examined,
            pairs,
            began,
            ended,
        })
    };
    let first = one(0)?;
    let steps = (1..=arguments.steps as usize).map(&mut one).collect::<Result<_, _>>()?;
    Ok(Outcome { recipe, options, threads: rayon::current_num_threads(), insert, first, steps })
}
