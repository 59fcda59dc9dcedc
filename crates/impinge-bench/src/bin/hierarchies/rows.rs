//! Measured trees, as rows of tables.

use anyhow::{Context, Result};
use impinge::hierarchy::{Builder, Counters, Enclosure, GenericTree, NodeVolume};
use impinge::volume::Aabb;
use impinge_bench::samples::{Samples, processor_timed};
use impinge_bench::table::time;

use crate::costs;
use crate::question::Question;

/// Maximum number of builds, because builds are slow and their times vary little.
const MOST_BUILDS: usize = 3;

/// Number of runs of each traversal.
pub(crate) struct Runs {
    pub(crate) repeats: usize,
}

pub(crate) const BUILDER_HEADINGS: [&str; 9] =
    ["builder", "build", "SAH", "overlap", "depth", "leaves full", "N_V", "N_P", "all pairs"];

/// Measures a builder, by a tree of boxes as queries use it.
pub(crate) fn builder(question: &Question, builder: Builder, runs: &Runs) -> Result<[String; 9]> {
    let build = Samples::take(runs.repeats.min(MOST_BUILDS), || {
        anyhow::Ok(processor_timed(|| builder.build(&question.boxes)).0)
    })?;
    let binary = builder.build(&question.boxes);
    let statistics = binary.statistics();
    let tree = question.tree::<Aabb, 8>(&binary, Enclosure::Wrapped)?;
    let (work, query) = ask(question, &tree, builder.name(), runs)?;
    Ok([
        builder.name().to_owned(),
        time(build.min()),
        format!("{:.2}", statistics.sah),
        format!("{:.3}", statistics.overlap),
        statistics.depth.to_string(),
        format!("{:.0} %", 100.0 * statistics.leaf_fill),
        thousands(work.volume_tests),
        thousands(work.primitive_tests),
        time(query),
    ])
}

pub(crate) const DEGREE_HEADINGS: [&str; 6] = ["degree", "bytes a triangle", "N_V", "N_P", "N_U", "all pairs"];

/// Measures a number of children per node, by a tree of boxes.
pub(crate) fn degree<const DEGREE: usize>(question: &Question, runs: &Runs) -> Result<[String; 6]> {
    let binary = Builder::BinnedSah.build_with_leaves_of(1, &question.boxes);
    let tree = question.tree::<Aabb, DEGREE>(&binary, Enclosure::Wrapped)?;
    let (work, query) = ask(question, &tree, "boxes", runs)?;
    Ok([
        DEGREE.to_string(),
        format!("{:.0}", tree.bytes() as f64 / question.size() as f64),
        thousands(work.volume_tests),
        thousands(work.primitive_tests),
        thousands(work.updates),
        time(query),
    ])
}

pub(crate) const VOLUME_HEADINGS: [&str; 11] =
    ["volume", "fit", "bytes", "N_V", "N_P", "N_U", "C_V", "C_P", "C_U", "T", "all pairs"];

/// Measures a kind of volume, by a binary tree of such volumes. `T` is the time that the counts and
/// the unit costs predict.
pub(crate) fn volume<V: NodeVolume>(
    question: &Question,
    name: &str,
    enclosure: Enclosure,
    runs: &Runs,
) -> Result<[String; 11]> {
    let binary = Builder::BinnedSah.build_with_leaves_of(1, &question.boxes);
    let (fit, tree) = processor_timed(|| question.tree::<V, 2>(&binary, enclosure));
    let tree = tree?;
    let (work, query) = ask(question, &tree, name, runs)?;
    let costs = costs::measure::<V>(question, runs.repeats).context("no volume could be measured")?;
    let kind = match enclosure {
        Enclosure::Wrapped => "wrapped",
        Enclosure::Layered => "layered",
    };
    Ok([
        format!("{name}, {kind}"),
        time(fit),
        size_of::<V>().to_string(),
        thousands(work.volume_tests),
        thousands(work.primitive_tests),
        thousands(work.updates),
        time(costs.volume_secs),
        time(costs.primitive_secs),
        time(costs.update_secs),
        time(costs.seconds(&work)),
        time(query),
    ])
}

/// Returns the counted work of a tree to find all pairs, and the minimum time of some runs in
/// seconds. Each answer is checked.
fn ask<V: NodeVolume, const DEGREE: usize>(
    question: &Question,
    tree: &GenericTree<V, DEGREE>,
    who: &str,
    runs: &Runs,
) -> Result<(Counters, f64)> {
    let mut work = Counters::default();
    let samples = Samples::take(runs.repeats, || {
        let (seconds, (found, counted)) = processor_timed(|| question.ask(tree));
        question.check(found, who)?;
        work = counted;
        anyhow::Ok(seconds)
    })?;
    Ok((work, samples.min()))
}

/// Returns a count in thousands or millions.
fn thousands(count: u64) -> String {
    match count {
        0..100_000 => format!("{:.1} k", count as f64 / 1e3),
        100_000..10_000_000 => format!("{:.0} k", count as f64 / 1e3),
        _ => format!("{:.1} M", count as f64 / 1e6),
    }
}
