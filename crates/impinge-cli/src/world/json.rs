//! The JSON answer: one object of schema `impinge.world/1`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::report::Summary;
use super::{Outcome, PHASES, Step};
use crate::console;

#[derive(Serialize)]
struct Object {
    schema: &'static str,
    version: &'static str,
    scene: String,
    bodies: usize,
    sizes: String,
    mix: String,
    seed: u64,
    broad_phase: String,
    narrow_phase: String,
    threads: usize,
    /// Times of each phase and of whole steps, in seconds, without the first step.
    seconds: BTreeMap<&'static str, Summary>,
    insert_seconds: f64,
    first: StepObject,
    steps: Vec<StepObject>,
}

#[derive(Serialize)]
struct StepObject {
    seconds: BTreeMap<&'static str, f64>,
    moved: usize,
    candidates: usize,
    examined: usize,
    pairs: usize,
    began: usize,
    ended: usize,
}

/// Returns the JSON object as one line.
pub(super) fn object(outcome: &Outcome) -> String {
    let lower = |name: String| name.to_lowercase();
    let phases = PHASES.iter().enumerate();
    let mut seconds: BTreeMap<&'static str, Summary> = phases
        .map(|(at, &name)| (name, Summary::of(outcome.steps.iter().map(|step| step.seconds[at]).collect())))
        .collect();
    seconds.insert("step", Summary::of(outcome.steps.iter().map(Step::total).collect()));
    console::to_line(&Object {
        schema: "impinge.world/1",
        version: env!("CARGO_PKG_VERSION"),
        scene: lower(format!("{:?}", outcome.recipe.motion)),
        bodies: outcome.recipe.bodies,
        sizes: lower(format!("{:?}", outcome.recipe.sizes)),
        mix: lower(format!("{:?}", outcome.recipe.mix)),
        seed: outcome.recipe.seed,
        broad_phase: lower(format!("{:?}", outcome.options.broad_phase)),
        narrow_phase: lower(format!("{:?}", outcome.options.narrow_phase)),
        threads: outcome.threads,
        seconds,
        insert_seconds: outcome.insert,
        first: step_object(&outcome.first),
        steps: outcome.steps.iter().map(step_object).collect(),
    })
}

fn step_object(step: &Step) -> StepObject {
    let &Step { moved, candidates, examined, pairs, began, ended, seconds } = step;
    let seconds = PHASES.iter().copied().zip(seconds).collect();
    StepObject { seconds, moved, candidates, examined, pairs, began, ended }
}
