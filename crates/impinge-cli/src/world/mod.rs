//! `impinge world`: many moving bodies, measured phase by phase.

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

/// More threads than any machine has processors for; an answer does not depend on them.
const MOST_THREADS: i64 = 1024;

/// How fast are many moving bodies?
///
/// Runs a scripted scene, step by step, and says how long each phase of a step took and how many pairs there were. Bodies pass
/// through each other, so that every way of looking for pairs is asked the same: pairs never differ between them.
///
/// Exit code: 0, or 2 where the scene cannot be run.
#[derive(Args)]
pub(crate) struct Arguments {
    /// How the bodies move
    #[arg(long, value_name = "SCENE", default_value = "brownian")]
    scene: Motion,
    /// How many bodies there are
    #[arg(short = 'n', long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    bodies: u32,
    /// How large they are
    #[arg(long, value_name = "SIZES", default_value = "like")]
    sizes: Sizes,
    /// What they are
    #[arg(long, value_name = "MIX", default_value = "boxes")]
    mix: Mix,
    /// How many steps to run, at 60 a second
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
    /// How pairs of boxes are found
    #[arg(long, value_name = "KIND", default_value = "auto")]
    broad_phase: BroadPhaseArgument,
    /// What is found out about them
    #[arg(long, value_name = "WHAT", default_value = "contacts")]
    narrow_phase: NarrowPhaseArgument,
    /// Another number makes another scene of the same kind
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Draw the times of the phases over the steps, to a .svg file
    #[arg(long, value_name = "OUT")]
    plot: Option<PathBuf>,
    /// Print one JSON object in place of the report
    #[arg(long)]
    json: bool,
    /// How many threads to use; all processors without it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
}

/// The library's choice, by its name.
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
    /// Nothing: pairs are those of the boxes
    Boxes,
    /// Whether bodies meet
    Intersections,
    /// Whether they do, and where
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

/// The phases of a step, in order.
const PHASES: [&str; 5] = ["realign", "take", "broad", "narrow", "report"];

/// What one step took and found.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    /// Of each phase.
    seconds: [f64; PHASES.len()],
    moved: usize,
    /// Pairs of boxes that overlap.
    candidates: usize,
    /// Pairs of shapes that were looked at.
    examined: usize,
    /// Pairs that meet.
    pairs: usize,
    began: usize,
    ended: usize,
}

impl Step {
    fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }
}

/// Everything that there is to tell.
struct Outcome {
    recipe: Recipe,
    options: Options,
    threads: usize,
    /// Seconds until the first step, which is not among the others: there everything is new.
    insert: f64,
    first: Step,
    steps: Vec<Step>,
}

/// Runs the scene and tells of it.
///
/// # Errors
/// Where there are no threads to be had, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    if let Some(path) = &arguments.plot {
        if output::extension(path) != "svg" {
            return Err(output::unknown_extension(path, ".svg"));
        }
        output::judge(path, &[])?;
    }
    let outcome = match arguments.threads {
        None => measure(arguments),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|error| Failure::new("threads", format!("no {threads} threads can be had: {error}")))?
            .install(|| measure(arguments)),
    };
    let outcome = outcome.map_err(|error| Failure::new("scene", error.to_string()))?;
    if let Some(path) = &arguments.plot {
        output::write(path, |out| plot::write(out, &outcome))?;
    }
    console::conclude(&if arguments.json { json::object(&outcome) } else { report::text(&outcome) })?;
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
