//! The text report: a table of phases.

use std::fmt::Write;

use anstyle::Style;

use super::{Outcome, PHASES, Step};
use crate::numerals::{count, counted, short_time};

const STRONG: Style = Style::new().bold();
const FAINT: Style = Style::new().dimmed();

/// Returns the report with ANSI styles; the output stream keeps or strips them.
pub(super) fn text(outcome: &Outcome) -> String {
    let recipe = &outcome.recipe;
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{STRONG}{:?}{STRONG:#}: {} bodies, {:?} in size; {}, {:?}, {:?}, {}\n",
        recipe.motion,
        count(recipe.bodies),
        recipe.sizes,
        counted(outcome.steps.len(), "step"),
        outcome.options.broad_phase,
        outcome.options.narrow_phase,
        counted(outcome.threads, "thread"),
    );
    let _ = writeln!(text, "{FAINT}{:<9}{:>10}{:>10}{:>10}{:>10}{FAINT:#}", "phase", "median", "mean", "99 %", "most");
    for (phase, name) in PHASES.iter().enumerate() {
        line(&mut text, name, outcome.steps.iter().map(|step| step.seconds[phase]).collect());
    }
    line(&mut text, "step", outcome.steps.iter().map(Step::total).collect());
    let median = |of: fn(&Step) -> usize| {
        let mut all: Vec<usize> = outcome.steps.iter().map(of).collect();
        all.sort_unstable();
        count(all[all.len() / 2])
    };
    let _ = writeln!(text, "\n{FAINT}in the median step{FAINT:#}");
    for (name, value) in [
        ("bodies moved", median(|step| step.moved)),
        ("pairs of boxes", median(|step| step.candidates)),
        ("shapes examined", median(|step| step.examined)),
        ("pairs", median(|step| step.pairs)),
        ("began", median(|step| step.began)),
        ("ended", median(|step| step.ended)),
    ] {
        let _ = writeln!(text, "{name:<17}{value:>12}");
    }
    let _ = writeln!(
        text,
        "\n{FAINT}bodies were inserted in {}, and the first step took {}{FAINT:#}",
        short_time(outcome.insert),
        short_time(outcome.first.total())
    );
    text
}

fn line(text: &mut String, name: &str, seconds: Vec<f64>) {
    let summary = Summary::of(seconds);
    let [median, mean, high, most] =
        [summary.median, summary.mean, summary.percentile_99, summary.most].map(short_time);
    let _ = writeln!(text, "{name:<9}{median:>10}{mean:>10}{high:>10}{most:>10}");
}

/// Statistics of the times of many steps, in seconds.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct Summary {
    median: f64,
    mean: f64,
    percentile_99: f64,
    most: f64,
}

impl Summary {
    /// Computes the statistics of at least one time.
    pub(super) fn of(mut seconds: Vec<f64>) -> Self {
        seconds.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| seconds[((seconds.len() - 1) as f64 * share) as usize];
        let mean = seconds.iter().sum::<f64>() / seconds.len() as f64;
        Self { median: at(0.5), mean, percentile_99: at(0.99), most: at(1.0) }
    }
}
