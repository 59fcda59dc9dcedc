//! All boxes move, and all pairs are wanted.

use std::hint::black_box;

use anyhow::{Result, ensure};
use impinge::partition::{BoxTree, ColumnSweep, Dynamic, Partition};
use impinge::volume::MinMax;
use impinge_bench::samples::{Samples, processor_timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use parry3d::partitioning::{Bvh, BvhWorkspace};

use crate::scenes::{for_parry, moved};

/// Boxes above which our tree, which is not made for this, is left out.
const MOST_FOR_TREE: usize = 10_000;

/// Times the sweep of columns and parry's tree on the same frames.
pub(crate) fn compare(
    what: &str,
    draw: impl Fn(usize, &mut Rng) -> Vec<MinMax>,
    counts: &[usize],
    steps: usize,
) -> Result<()> {
    println!("all boxes move: {what}, a step");
    let mut table = Table::new(["boxes", "pairs", "columns", "median", "parry3d", "median", "ratio of least", "tree"]);
    for &count in counts {
        let mut rng = Rng::new(count as u64);
        let mut boxes = draw(count, &mut rng);
        let mut columns = ColumnSweep::new();
        let mut pairs = Vec::new();
        let mut parry = Parry::new(&boxes);
        let mut tree = (count <= MOST_FOR_TREE).then(|| BoxTree::build(&boxes));
        let (mut ours, mut theirs, mut trees) = (Vec::new(), Vec::new(), Vec::new());
        // The first steps warm up.
        for step in 0..steps + 2 {
            boxes = moved(&boxes, &mut rng);
            let (seconds, ()) = processor_timed(|| columns.find(black_box(&boxes), &mut pairs));
            let (their_seconds, mut their_pairs) = parry.step(&boxes);
            their_pairs.sort_unstable();
            ensure!(pairs == their_pairs, "{} pairs, and {} of parry3d", pairs.len(), their_pairs.len());
            if step >= 2 {
                ours.push(seconds);
                theirs.push(their_seconds);
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
        let [ours, theirs] = [ours, theirs].map(|seconds| {
            let mut seconds = seconds.into_iter();
            Samples::take(steps, || seconds.next().ok_or(anyhow::anyhow!("a step is missing")))
        });
        let (ours, theirs) = (ours?, theirs?);
        table.row([
            count.to_string(),
            pairs.len().to_string(),
            time(ours.min()),
            time(ours.median()),
            time(theirs.min()),
            time(theirs.median()),
            format!("{:.3}", ours.min() / theirs.min()),
            trees.iter().copied().reduce(f64::min).map_or(String::new(), time),
        ]);
    }
    println!("{table}");
    Ok(())
}

/// parry's tree and what it keeps beside it.
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

    /// Seconds to move all boxes and find all pairs, and these, the lesser first.
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
