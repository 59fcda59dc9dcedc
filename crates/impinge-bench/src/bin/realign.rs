//! The five methods of realigning a box, over thousands of turns of meshes: nanoseconds, looseness
//! and memory; the hull size from which climbing is faster; and the speed of scanning and of
//! batches.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin realign`
//!
//! Every answer is checked. Tight boxes are compared bit for bit with each other at every pose, and
//! with the exact brute force of the testkit at the number of poses given by `--exact`. Boxes of
//! the other methods must contain them.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;
use std::path::Path;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::Pose;
use impinge::hull::Hull;
use impinge::volume::realign::{ClimbingHull, LooseBox, Realign, RotatedBox, TightHull, TightPoints};
use impinge::volume::{BoundingVolume, MinMax};
use impinge_bench::real_points::{human, ventilator};
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::icosphere;
use impinge_testkit::oracle::tight_box;

/// Angle of a small step, in radians: 1.1 degrees, or a full turn in five seconds at 60 steps per
/// second.
const STEP_RAD: f64 = 0.02;

/// Maximum time spent on one method for one mesh and one kind of turn, in seconds.
const MOST_SECONDS: f64 = 3.0;

/// Times the methods of realigning a box, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Number of turns of each kind
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    turns: usize,
    /// Number of turns of each kind at which the human is compared with the exact brute force; for
    /// other meshes the number that takes the same time
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    exact: usize,
}

fn main() -> Result<()> {
    let Arguments { turns, exact } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let human = human()?;
    let exact_points = exact * human.len();
    ways("human", &human, turns, exact_points)?;
    if let Some(folder) = impinge_testkit::env_rob::data_folder() {
        ways("ventilator", &ventilator(Path::new(&folder))?, turns, exact_points)?;
    }
    climbing()?;
    scanning()?;
    batches()
}

/// Times all methods over small steps and random turns of one mesh.
fn ways(name: &str, points: &[[f32; 3]], turns: usize, exact_points: usize) -> Result<()> {
    let hull = Hull::new(points)?;
    let wide: Vec<[f64; 3]> = points.iter().map(|point| point.map(f64::from)).collect();
    println!("{name}: {} points, {} on the hull", points.len(), hull.vertices().len());
    let mut table = Table::new(["", "small steps", "any turns", "volume over tight", "bytes"]);
    let poses = [small_steps(turns)?, any_turns(turns)?];
    let exact = (exact_points / points.len()).min(turns);

    // Reference boxes for all others. They are compared with the exact boxes.
    let mut reference = TightHull::new(&hull);
    let tight = poses.each_ref().map(|poses| poses.iter().map(|pose| reference.realign(pose)).collect::<Vec<_>>());
    let every = (turns / exact.max(1)).max(1);
    let chosen = poses.iter().zip(&tight).flat_map(|(poses, tight)| poses.iter().zip(tight).step_by(every));
    compare_with_exact(&distinct(wide), &chosen.collect::<Vec<_>>())?;
    let pivot = MinMax::of(points)?;
    let middle = std::array::from_fn(|k| 0.5 * (pivot.min()[k] + pivot.max()[k]));
    let mut measure = |label: &str, way: &mut dyn Realign, is_tight: bool| -> Result<()> {
        let mut cells = [const { String::new() }; 2];
        let (mut volume, mut tight_volume) = (0.0, 0.0);
        for kind in 0..2 {
            for (pose, tight) in
                poses[kind].iter().zip(&tight[kind]).take(if is_tight { exact.max(100) } else { turns })
            {
                let found = way.realign(pose);
                ensure!(if is_tight { found == *tight } else { found.encloses(tight) }, "{label} is wrong at {pose:?}");
                volume += found.volume();
                tight_volume += tight.volume();
            }
            cells[kind] = time(seconds_a_turn(way, &poses[kind]));
        }
        let [small, any] = cells;
        let looseness = format!("{:.3}", volume / tight_volume);
        table.row([label.to_owned(), small, any, looseness, way.memory().to_string()]);
        Ok(())
    };
    measure("(a) loose", &mut LooseBox::new(points, middle)?, false)?;
    measure("(b) all points", &mut TightPoints::new(points)?, true)?;
    measure("(b') hull vertices", &mut TightHull::new(&hull), true)?;
    measure("(c) climbing", &mut ClimbingHull::new(&hull), true)?;
    measure("(d) rotated original", &mut RotatedBox::new(&pivot), false)?;
    println!("{table}compared with the exact boxes at {exact} turns of each kind\n");
    Ok(())
}

/// Returns each point once, because duplicates change no box.
fn distinct(mut points: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    points.sort_unstable_by_key(|point| point.map(f64::to_bits));
    points.dedup();
    points
}

/// Checks that the boxes are exact, by brute force on all cores. It takes minutes for millions of
/// points.
fn compare_with_exact(points: &[[f64; 3]], boxes: &[(&Pose, &MinMax)]) -> Result<()> {
    let is_exact = |&(pose, tight): &(&Pose, &MinMax)| {
        let found = tight_box(points, &Affine::new(*pose.linear(), *pose.translation()));
        ensure!((found.low, found.high) == (tight.min(), tight.max()), "not the exact box at {pose:?}");
        Ok(())
    };
    let threads = std::thread::available_parallelism()?.get();
    std::thread::scope(|scope| {
        let mut shares = Vec::new();
        for share in boxes.chunks(boxes.len().div_ceil(threads).max(1)) {
            shares.push(scope.spawn(move || share.iter().try_for_each(is_exact)));
        }
        shares.into_iter().try_for_each(|share| share.join().map_err(|_| anyhow::anyhow!("the brute force failed"))?)
    })
}

/// Returns the minimum time per turn over runs of all poses, or over parts of a run if the time
/// limit ends it.
fn seconds_a_turn(way: &mut dyn Realign, poses: &[Pose]) -> f64 {
    let mut best = f64::INFINITY;
    let mut spent = 0.0;
    for _ in 0..9 {
        for part in poses.chunks(1000) {
            let (seconds, ()) = timed(|| part.iter().for_each(|pose| _ = black_box(way.realign(black_box(pose)))));
            best = best.min(seconds / part.len() as f64);
            spent += seconds;
            if spent > MOST_SECONDS {
                return best;
            }
        }
    }
    best
}

/// Compares climbing with a scan of all vertices, by the size of the hull.
fn climbing() -> Result<()> {
    let mut table = Table::new(["vertices", "all, small steps", "climbing", "ratio", "climbing, any turns", "ratio"]);
    let (steps, turns) = (small_steps(1000)?, any_turns(1000)?);
    for subdivisions in [0, 1, 2, 3, 4, 5, 6, 7] {
        let hull = Hull::new(&icosphere(subdivisions).vertices)?;
        let (mut all, mut climbing) = (TightHull::new(&hull), ClimbingHull::new(&hull));
        for pose in steps.iter().chain(&turns) {
            ensure!(all.realign(pose) == climbing.realign(pose), "climbing is wrong at {pose:?}");
        }
        let all = seconds_a_turn(&mut all, &steps);
        let [small, any] = [&steps, &turns].map(|poses| seconds_a_turn(&mut climbing, poses));
        table.row([
            hull.vertices().len().to_string(),
            time(all),
            time(small),
            format!("{:.2}", all / small),
            time(any),
            format!("{:.2}", all / any),
        ]);
    }
    println!("{table}");
    Ok(())
}

/// Compares a scan of a million points with reading as many bytes.
fn scanning() -> Result<()> {
    const POINTS: usize = 1_000_000;
    let mut rng = Rng::new(7);
    let cloud: Vec<[f32; 3]> = (0..POINTS).map(|_| std::array::from_fn(|_| rng.uniform(-1.0, 1.0) as f32)).collect();
    let mut way = TightPoints::new(&cloud)?;
    // One by one, so that other work on the machine does not spoil the minimum.
    let scan = any_turns(400)?
        .iter()
        .fold(f64::INFINITY, |best, pose| best.min(timed(|| black_box(way.realign(black_box(pose)))).0));
    let words: Vec<u64> = (0..POINTS * 12 / 8).map(|_| rng.next_u64()).collect();
    let read = (0..200).fold(f64::INFINITY, |best, _| {
        let (seconds, sum) = timed(|| black_box(&words).iter().fold(0, |sum: u64, word| sum.wrapping_add(*word)));
        black_box(sum);
        best.min(seconds)
    });
    println!("a million points scanned in {}, as many bytes read in {}\n", time(scan), time(read));
    Ok(())
}

/// Times boxes of turned boxes, one by one and in batches.
fn batches() -> Result<()> {
    const BOXES: usize = 1000;
    let mut rng = Rng::new(8);
    let boxes: Vec<RotatedBox> = (0..BOXES)
        .map(|_| {
            let corners: [[f64; 3]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| rng.uniform(-9.0, 9.0)));
            MinMax::of(&corners).map(|bounds| RotatedBox::new(&bounds))
        })
        .collect::<Result<_, _>>()?;
    let poses = any_turns(BOXES)?;
    let mut images = Vec::with_capacity(BOXES);
    let mut table = Table::new(["", "a box"]);
    let mut measure = |label: &str, run: &mut dyn FnMut(&mut Vec<MinMax>)| {
        let best = (0..2000).fold(f64::INFINITY, |best, _| best.min(timed(|| run(black_box(&mut images))).0));
        table.row([label.to_owned(), time(best / BOXES as f64)]);
    };
    measure("one at a time, each with its pose", &mut |images| {
        images.clear();
        for (one, pose) in boxes.iter().zip(&poses) {
            let mut one = *black_box(one);
            images.push(one.realign(pose));
        }
    });
    measure("a batch, each with its pose", &mut |images| RotatedBox::realign_each(&boxes, &poses, images));
    measure("a batch, one pose", &mut |images| RotatedBox::realign_all(&boxes, &poses[0], images));
    println!("{table}");
    Ok(())
}

/// Returns turns about a slowly changing axis, each a small step from the last.
fn small_steps(count: usize) -> Result<Vec<Pose>> {
    let mut pose = Pose::IDENTITY;
    let mut poses = Vec::with_capacity(count);
    for step in 0..count {
        poses.push(pose);
        let sway = step as f64 * 1e-3;
        let turn = Pose::from_axis_angle([sway.sin(), 1.0, sway.cos()], STEP_RAD, [0.001, 0.0, -0.002])?;
        pose = turn.compose(&pose)?;
    }
    Ok(poses)
}

/// Returns uniformly distributed rotations.
fn any_turns(count: usize) -> Result<Vec<Pose>> {
    let mut rng = Rng::new(9);
    let mut poses = Vec::with_capacity(count);
    while poses.len() < count {
        let quaternion: [f64; 4] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
        let squared = quaternion.iter().map(|x| x * x).sum::<f64>();
        if (1e-3..=1.0).contains(&squared) {
            let translation = std::array::from_fn(|_| rng.uniform(-10.0, 10.0));
            poses.push(Pose::from_quaternion_wxyz(translation, quaternion.map(|x| x / squared.sqrt()))?);
        }
    }
    Ok(poses)
}
