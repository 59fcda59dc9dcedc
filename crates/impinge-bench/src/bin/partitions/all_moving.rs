//! Benchmark: all boxes move in each step, and all overlapping pairs are reported. Times
//! `ColumnSweep`, parry3d's tree and, for few boxes, `BoxTree`.

use std::hint::black_box;

use anyhow::{Result, ensure};
use impinge::partition::{BoxTree, ColumnSweep, Dynamic, Partition};
use impinge::volume::MinMax;
use impinge_bench::samples::{Samples, processor_timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use parry3d::partitioning::{Bvh, BvhWorkspace};

use crate::scenes::{for_parry, nudged};

/// Maximum number of boxes for `BoxTree`, which is slow if all boxes move.
const MOST_FOR_TREE: usize = 10_000;

/// Maximum number of boxes for parry3d's tree. More boxes would take gigabytes.
const MOST_FOR_PARRY: usize = 1_000_000;

/// Number of boxes that run exactly the requested number of steps. Within limits, the number of
/// steps is inversely proportional to the number of boxes.
const USUAL: usize = 300_000;

/// Times of a step for one number of boxes, by engine, and the number of pairs after the last step.
pub(crate) struct Row {
    boxes: usize,
    pairs: usize,
    columns: Samples,
    parry: Option<Samples>,
    tree: Option<Samples>,
}

/// Times all engines on the same steps, for each number of boxes in `counts`. `draw` makes the
/// boxes.
///
/// # Errors
/// Returns an error if the engines find different pairs.
pub(crate) fn compare(
    draw: impl Fn(usize, &mut Rng) -> Vec<MinMax>,
    counts: &[usize],
    steps: usize,
) -> Result<Vec<Row>> {
    counts.iter().map(|&count| row(draw(count, &mut Rng::new(count as u64)), steps)).collect()
}

fn row(mut boxes: Vec<MinMax>, steps: usize) -> Result<Row> {
    let count = boxes.len();
    let mut rng = Rng::new(count as u64 + 1);
    let mut columns = ColumnSweep::new();
    let mut pairs = Vec::new();
    let mut parry = (count <= MOST_FOR_PARRY).then(|| Parry::new(&boxes));
    let mut tree = (count <= MOST_FOR_TREE).then(|| BoxTree::build(&boxes));
    let (mut ours, mut theirs, mut trees) = (Vec::new(), Vec::new(), Vec::new());
    let steps = (steps * USUAL / count).clamp(3, 100 * steps);
    // The first two steps warm up.
    for step in 0..steps + 2 {
        boxes.iter_mut().for_each(|bounds| *bounds = nudged(bounds, &mut rng));
        let (seconds, ()) = processor_timed(|| columns.find(black_box(&boxes), &mut pairs));
        if step >= 2 {
            ours.push(seconds);
        }
        if let Some(parry) = &mut parry {
            let (seconds, mut their_pairs) = parry.step(&boxes);
            their_pairs.sort_unstable();
            ensure!(pairs == their_pairs, "{} pairs, and {} of parry3d", pairs.len(), their_pairs.len());
            if step >= 2 {
                theirs.push(seconds);
            }
        }
        if let Some(tree) = &mut tree {
            let (seconds, own_pairs) = processor_timed(|| {
                boxes.iter().enumerate().for_each(|(key, bounds)| _ = tree.insert(key as u32, *bounds));
                tree.pairs()
            });
            ensure!(own_pairs == pairs, "{} pairs of the tree, not {}", own_pairs.len(), pairs.len());
            trees.push(seconds);
        }
    }
    let samples = |seconds: Vec<f64>| {
        let mut left = seconds.iter();
        let next = || left.next().copied().ok_or(anyhow::anyhow!("a step is missing"));
        if seconds.is_empty() { Ok(None) } else { Samples::take(seconds.len(), next).map(Some) }
    };
    let columns = samples(ours)?.ok_or(anyhow::anyhow!("there are no steps"))?;
    Ok(Row { boxes: count, pairs: pairs.len(), columns, parry: samples(theirs)?, tree: samples(trees)? })
}

/// Prints a table of the minimum and median times of a step.
pub(crate) fn print(what: &str, rows: &[Row]) {
    println!("all boxes move: {what}, a step");
    let mut table = Table::new(["boxes", "pairs", "columns", "median", "parry3d", "median", "ratio of least", "tree"]);
    let or_nothing =
        |samples: &Option<Samples>, of: &dyn Fn(&Samples) -> String| samples.as_ref().map_or(String::new(), of);
    for Row { boxes, pairs, columns, parry, tree } in rows {
        table.row([
            boxes.to_string(),
            pairs.to_string(),
            time(columns.min()),
            time(columns.median()),
            or_nothing(parry, &|parry| time(parry.min())),
            or_nothing(parry, &|parry| time(parry.median())),
            or_nothing(parry, &|parry| format!("{:.3}", columns.min() / parry.min())),
            or_nothing(tree, &|tree| time(tree.min())),
        ]);
    }
    println!("{table}");
}

/// Returns the minimum times of a step in seconds, as JSON.
pub(crate) fn json(rows: &[Row]) -> Vec<serde_json::Value> {
    rows.iter()
        .map(|Row { boxes, pairs, columns, parry, .. }| {
            let parry = parry.as_ref().map(Samples::min);
            serde_json::json!({ "boxes": boxes, "pairs": pairs, "columns": columns.min(), "parry": parry })
        })
        .collect()
}

/// Tree of parry3d with its workspace.
pub(crate) struct Parry {
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl Parry {
    pub(crate) fn new(boxes: &[MinMax]) -> Self {
        let mut parry = Self { tree: Bvh::new(), workspace: BvhWorkspace::default() };
        for (key, bounds) in boxes.iter().enumerate() {
            parry.tree.insert(for_parry(bounds), key as u32);
        }
        parry
    }

    /// Moves all boxes and finds all pairs. Returns the processor time in seconds, and the pairs,
    /// each with the smaller key first.
    fn step(&mut self, boxes: &[MinMax]) -> (f64, Vec<[u32; 2]>) {
        let boxes: Vec<_> = boxes.iter().map(for_parry).collect();
        let Self { tree, workspace } = self;
        processor_timed(|| {
            for (key, bounds) in boxes.iter().enumerate() {
                tree.insert_or_update_partially(*bounds, key as u32, 0.0);
            }
            tree.refit(workspace);
            tree.optimize_incremental(workspace);
            let mut pairs = Vec::new();
            tree.traverse_bvtt_single_tree::<false>(workspace, &mut |one, other| {
                pairs.push([one.min(other), one.max(other)]);
            });
            pairs
        })
    }
}
