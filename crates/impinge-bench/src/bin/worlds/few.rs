//! Benchmark: a few of many boxes move in each step.

use std::time::Instant;

use anyhow::{Result, ensure};
use impinge::Pose;
use impinge::partition::{Changes, Dynamic, HierarchicalGrid, Move};
use impinge::world::{BroadPhase, NarrowPhase, Options, PairKey, World};
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

use crate::scenes::{boxed, size};

/// Number of steps before steps are timed. With `Auto` the world needs some steps to choose a broad
/// phase.
const WARM: usize = 10;

const PHASES: [&str; 5] = ["realign", "take", "broad", "narrow", "report"];

/// Times steps of `count` boxes of which `moving` move, with equal and with spread sizes.
///
/// # Errors
/// Returns an error if two broad phases find different pairs.
pub(crate) fn compare(count: usize, moving: usize, steps: usize) -> Result<()> {
    let [realign, take, broad, narrow, report] = PHASES;
    for is_spread in [false, true] {
        let sizes = if is_spread { "spread over a ratio of 1,000" } else { "0.5 to 1.5" };
        println!("{moving} of {count} boxes move, sizes {sizes}; the least of {steps} steps");
        let mut table = Table::new(["", "step", realign, take, broad, narrow, report, "grid alone"]);
        let mut expected = None;
        for (broad_phase, name) in [(BroadPhase::Auto, "auto"), (BroadPhase::Grid, "grid"), (BroadPhase::Tree, "tree")]
        {
            let (row, pairs) = measure(broad_phase, count, moving, steps, is_spread)?;
            ensure!(expected.is_none_or(|expected| expected == pairs), "{name} finds other pairs");
            expected = Some(pairs);
            let cells: Vec<String> = [name.to_owned()].into_iter().chain(row.map(time)).collect();
            table.row(cells.try_into().map_err(|_| anyhow::anyhow!("a cell is missing"))?);
        }
        println!("{table}");
        table.record(&format!("{moving} of {count} boxes move, sizes {sizes}"), 1)?;
    }
    Ok(())
}

/// Returns the minimum times of a step, of its phases, and of a step of a grid alone with the same
/// boxes; and the pairs at the end.
fn measure(
    broad_phase: BroadPhase,
    count: usize,
    moving: usize,
    steps: usize,
    is_spread: bool,
) -> Result<([f64; 7], Vec<PairKey>)> {
    let mut rng = Rng::new(10);
    let reach = (count as f64).cbrt();
    let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
    let mut ids = Vec::with_capacity(count);
    let mut alone = HierarchicalGrid::new(1.75)?;
    for key in 0..count {
        let size = size(&mut rng, is_spread);
        ids.push(world.insert(boxed(&mut rng, size, reach)?)?);
        alone.insert(key as u32, world.bounds(ids[key])?.ok_or(anyhow::anyhow!("no box"))?);
    }
    world.step(&[])?;
    let mut least = [f64::INFINITY; 7];
    let mut changes = Changes::default();
    for step in 0..WARM + steps {
        let mut moves = Vec::with_capacity(moving);
        let mut keys = Vec::with_capacity(moving);
        for _ in 0..moving {
            let key = rng.integer(0, count as i64 - 1) as usize;
            let place = world.pose(ids[key])?.translation().map(|x| x + rng.uniform(-0.05, 0.05));
            moves.push((ids[key], Pose::from_translation(place)?));
            keys.push(key);
        }
        let mut times = [0.0; 7];
        let start = Instant::now();
        let mut last = start;
        world.step_observed(&moves, &mut |phase| {
            times[1 + phase as usize] = last.elapsed().as_secs_f64();
            last = Instant::now();
        })?;
        times[0] = start.elapsed().as_secs_f64();
        let mut nudges = Vec::with_capacity(moving);
        for key in keys {
            nudges.push(Move { key: key as u32, to: world.bounds(ids[key])? });
        }
        times[6] = timed(|| alone.step(&nudges, &mut changes)).0;
        if step >= WARM {
            least = std::array::from_fn(|at| least[at].min(times[at]));
        }
    }
    Ok((least, world.pairs().map(|pair| pair.key).collect()))
}
