//! Queries: nearest points compared with kiddo, and overlapping boxes compared with rstar.

use std::hint::black_box;
use std::ops::ControlFlow;

use anyhow::{Result, ensure};
use impinge::partition::{BoxTree, Dynamic, HashedGrid, KdTree, Partition};
use impinge::volume::MinMax;
use impinge_bench::samples::{Samples, processor_timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, PointDistance, RTree};

use crate::scenes::like;

/// Number of queries per run.
const ASKED: usize = 10_000;

/// Number of runs of each query. The minimum time counts.
const RUNS: usize = 5;

/// Times queries on `count` boxes and on `count` points.
///
/// # Errors
/// Returns an error if two answers differ.
pub(crate) fn compare(count: usize) -> Result<()> {
    boxes(count)?;
    points(count)
}

fn boxes(count: usize) -> Result<()> {
    println!("{count} boxes asked for what meets a box, a question");
    let mut rng = Rng::new(19);
    let boxes = like(count, &mut rng);
    let asked = like(count, &mut rng);
    let asked = &asked[..ASKED.min(count)];
    let mut table = Table::new(["", "time"]);
    let rivals: Vec<_> = boxes
        .iter()
        .enumerate()
        .map(|(key, bounds)| GeomWithData::new(Rectangle::from_corners(bounds.min(), bounds.max()), key as u32))
        .collect();
    let rstar = RTree::bulk_load(rivals);
    let expected: usize = asked.iter().map(|bounds| met(&rstar, bounds)).sum();
    let tree = BoxTree::build(&boxes);
    let mut grid = HashedGrid::new(2.5)?;
    boxes.iter().enumerate().for_each(|(key, bounds)| _ = grid.insert(key as u32, *bounds));
    let ours = |partition: &dyn Partition| {
        asked
            .iter()
            .map(|bounds| {
                let mut found = 0;
                let _ = partition.overlapping(bounds, &mut |_| {
                    found += 1;
                    ControlFlow::Continue(())
                });
                found
            })
            .sum::<usize>()
    };
    let mut measure = |name: &str, ask: &dyn Fn() -> usize| -> Result<()> {
        let seconds = Samples::take(RUNS, || {
            let (seconds, found) = processor_timed(|| black_box(ask()));
            ensure!(found == expected, "{name} finds {found}, not {expected}");
            Ok(seconds)
        })?;
        table.row([name.to_owned(), time(seconds.min() / asked.len() as f64)]);
        Ok(())
    };
    measure("tree", &|| ours(&tree))?;
    measure("hashed grid", &|| ours(&grid))?;
    measure("rstar", &|| asked.iter().map(|bounds| met(&rstar, bounds)).sum())?;
    println!("{table}");
    Ok(())
}

/// Times queries of the nearest point. All engines must agree on the sum of the smallest squared
/// distances.
fn points(count: usize) -> Result<()> {
    println!("the nearest of {count} points, a question");
    let mut rng = Rng::new(20);
    let mut place = |_: usize| [0; 3].map(|_: i32| rng.uniform(0.0, 100.0));
    let points: Vec<[f64; 3]> = (0..count).map(&mut place).collect();
    let asked: Vec<[f64; 3]> = (0..ASKED).map(&mut place).collect();
    let rival: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&points);
    let rstar = RTree::bulk_load(points.clone());
    let tree = KdTree::of_points(&points)?;
    let boxes = BoxTree::build(&points.iter().map(|&point| MinMax::new(point, point)).collect::<Result<Vec<_>, _>>()?);
    let ours = |partition: &dyn Partition| -> f64 {
        asked.iter().map(|&point| partition.nearest(point, 1).first().map_or(0.0, |near| near.distance_squared)).sum()
    };
    let expected = ours(&tree);
    let mut table = Table::new(["", "time"]);
    let mut measure = |name: &str, ask: &dyn Fn() -> f64| -> Result<()> {
        let seconds = Samples::take(RUNS, || {
            let (seconds, sum) = processor_timed(|| black_box(ask()));
            // The order of three sums may differ, which changes the last place.
            ensure!((sum - expected).abs() <= 1e-12 * expected, "{name} is {sum} away, not {expected}");
            Ok(seconds)
        })?;
        table.row([name.to_owned(), time(seconds.min() / asked.len() as f64)]);
        Ok(())
    };
    measure("k-d tree", &|| ours(&tree))?;
    measure("tree of boxes", &|| ours(&boxes))?;
    measure("kiddo", &|| asked.iter().map(|point| rival.nearest_one::<SquaredEuclidean>(point).distance).sum())?;
    measure("rstar", &|| {
        let distance = |point: &[f64; 3]| rstar.nearest_neighbor(*point).map_or(0.0, |near| near.distance_2(point));
        asked.iter().map(distance).sum()
    })?;
    println!("{table}");
    Ok(())
}

/// Returns the number of boxes that overlap `bounds` according to rstar.
fn met(tree: &RTree<GeomWithData<Rectangle<[f64; 3]>, u32>>, bounds: &MinMax) -> usize {
    tree.locate_in_envelope_intersecting(AABB::from_corners(bounds.min(), bounds.max())).count()
}
