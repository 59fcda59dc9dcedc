//! Benchmark: one box in a thousand moves in each step, and the changed pairs are reported. Times
//! grids and trees.

use std::hint::black_box;

use anyhow::{Result, ensure};
use impinge::partition::{BoxTree, Changes, ColumnSweep, Dynamic, HashedGrid, HierarchicalGrid, Move};
use impinge::volume::MinMax;
use impinge_bench::samples::{Samples, processor_timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

use crate::scenes::{like, nudged};

/// Number of boxes divided by the number of boxes that move in a step.
const SHARE: usize = 1000;

/// Edge length of a cell. Boxes are 1 long on average. This size keeps most cells within one cache
/// line.
const CELL: f64 = 1.75;

/// Times steps of `count` boxes, and checks one step of each partition.
///
/// # Errors
/// Returns an error if a partition reports other changes than expected.
pub(crate) fn compare(count: usize, steps: usize) -> Result<()> {
    println!("one in {SHARE} of {count} boxes moves, a step that reports the pairs that began and ended");
    let mut rng = Rng::new(17);
    let boxes = like(count, &mut rng);
    let mut table = Table::new(["", "the same ones", "median", "others each time", "median"]);
    measure("hashed grid", HashedGrid::new(CELL)?, &boxes, steps, &mut table)?;
    measure("hierarchical grid", HierarchicalGrid::new(CELL)?, &boxes, steps, &mut table)?;
    measure("tree", BoxTree::build(&boxes), &boxes, steps, &mut table)?;
    measure("tree with margin", BoxTree::with_margin(0.2), &boxes, steps, &mut table)?;
    println!("{table}");
    Ok(())
}

fn measure(
    name: &str,
    mut partition: impl Dynamic,
    boxes: &[MinMax],
    steps: usize,
    table: &mut Table<5>,
) -> Result<()> {
    let mut boxes = boxes.to_vec();
    if partition.is_empty() {
        boxes.iter().enumerate().for_each(|(key, bounds)| _ = partition.insert(key as u32, *bounds));
    }
    let mut rng = Rng::new(18);
    let movers = boxes.len() / SHARE;
    let last = boxes.len() as i64 - 1;
    let pick = |rng: &mut Rng| rng.integer(0, last) as u32;
    let same: Vec<u32> = (0..movers).map(|_| pick(&mut rng)).collect();
    let others: Vec<Vec<u32>> = (0..4 * steps).map(|_| (0..movers).map(|_| pick(&mut rng)).collect()).collect();
    let mut changes = Changes::default();
    let mut step = |boxes: &mut [MinMax], keys: &[u32], rng: &mut Rng| -> Result<f64> {
        let mut moves = Vec::new();
        for &key in keys {
            boxes[key as usize] = nudged(&boxes[key as usize], rng);
            moves.push(Move { key, to: Some(boxes[key as usize]) });
        }
        let (seconds, ()) = processor_timed(|| partition.step(black_box(&moves), &mut changes));
        Ok(seconds)
    };
    let hot = Samples::take(4 * steps, || step(&mut boxes, &same, &mut rng))?;
    let mut next = others.iter();
    let cold = Samples::take(4 * steps, || step(&mut boxes, next.next().map_or(&same, |keys| keys), &mut rng))?;
    // One more step is checked against all pairs before and after it.
    let before = all_pairs(&boxes);
    step(&mut boxes, &same, &mut rng)?;
    let after = all_pairs(&boxes);
    ensure!(changes.began() == without(&after, &before), "{name}: not the pairs that began");
    ensure!(changes.ended() == without(&before, &after), "{name}: not the pairs that ended");
    ensure!(!changes.began().is_empty(), "{name}: nothing changed");
    table.row([name.to_owned(), time(hot.min()), time(hot.median()), time(cold.min()), time(cold.median())]);
    Ok(())
}

fn all_pairs(boxes: &[MinMax]) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    ColumnSweep::new().find(boxes, &mut pairs);
    pairs
}

/// Returns the pairs of one sorted list that are not in another.
fn without(pairs: &[[u32; 2]], others: &[[u32; 2]]) -> Vec<[u32; 2]> {
    pairs.iter().filter(|pair| others.binary_search(pair).is_err()).copied().collect()
}
