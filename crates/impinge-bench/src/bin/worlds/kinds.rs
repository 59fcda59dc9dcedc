//! Benchmark: times of all broad phases in many scenes.

use anyhow::{Result, ensure};
use impinge::Pose;
use impinge::world::{BroadPhase, NarrowPhase, Options, PairKey, World};
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

use crate::scenes::{boxed, size};

/// Broad phases and their names in the table.
const KINDS: [(BroadPhase, &str); 7] = [
    (BroadPhase::Auto, "auto"),
    (BroadPhase::Every, "every"),
    (BroadPhase::Tree, "tree"),
    (BroadPhase::Columns, "columns"),
    (BroadPhase::Grid, "grid"),
    (BroadPhase::OneAxis, "one axis"),
    (BroadPhase::ThreeAxes, "three axes"),
];

/// Time of a step, in seconds, above which a broad phase is skipped for larger scenes. With ten
/// times as many bodies it would take seconds.
const HOPELESS: f64 = 0.05;

/// Total time of the measured steps in seconds. At least three steps run, and the minimum counts.
const MEASURED: f64 = 0.05;

/// Prints the times of a step for numbers of bodies up to `most`.
///
/// # Errors
/// Returns an error if two broad phases find different pairs.
pub(crate) fn compare(most: usize) -> Result<()> {
    let mut table = Table::new([
        "bodies",
        "moving",
        "sizes",
        "auto",
        "every",
        "tree",
        "columns",
        "grid",
        "one axis",
        "three axes",
        "pairs",
    ]);
    let counts = [10, 30, 100, 300, 1000, 10_000, 100_000, 1_000_000];
    for (share, share_name) in [(1.0, "all"), (0.2, "a fifth"), (0.05, "a twentieth"), (0.001, "a thousandth")] {
        for (is_spread, sizes) in [(false, "0.5 to 1.5"), (true, "Pareto, 1000")] {
            let mut is_hopeless = [false; KINDS.len()];
            for count in counts.into_iter().filter(|&count| count <= most) {
                let mut cells = vec![count.to_string(), share_name.to_owned(), sizes.to_owned()];
                let mut expected: Option<Vec<PairKey>> = None;
                for ((kind, name), is_hopeless) in KINDS.into_iter().zip(&mut is_hopeless) {
                    // Filling the axes takes as long as many steps.
                    if *is_hopeless || name.contains("ax") && count > 10_000 {
                        cells.push("-".to_owned());
                        continue;
                    }
                    let (seconds, pairs) = step_time(kind, count, share, is_spread)?;
                    *is_hopeless = seconds > HOPELESS;
                    if let Some(expected) = &expected {
                        ensure!(*expected == pairs, "{name} finds other pairs");
                    }
                    expected = Some(pairs);
                    cells.push(time(seconds));
                }
                cells.push(expected.map_or(0, |pairs| pairs.len()).to_string());
                table.row(cells.try_into().map_err(|_| anyhow::anyhow!("a cell is missing"))?);
            }
        }
    }
    println!("{table}least time of a step, boxes only; -: left out, as it takes seconds");
    table.record("", 3)
}

/// Returns the minimum time of a step in seconds, and the pairs after three steps.
fn step_time(broad_phase: BroadPhase, count: usize, share: f64, is_spread: bool) -> Result<(f64, Vec<PairKey>)> {
    let mut rng = Rng::new(9);
    let reach = (count as f64).cbrt();
    let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
    let mut ids = Vec::with_capacity(count);
    for _ in 0..count {
        let size = size(&mut rng, is_spread);
        ids.push(world.insert(boxed(&mut rng, size, reach)?)?);
    }
    world.step(&[])?;
    let moving = ((count as f64 * share).ceil() as usize).min(count);
    let (mut best, mut sum, mut pairs) = (f64::INFINITY, 0.0, Vec::new());
    for step in 0.. {
        let mut moves = Vec::with_capacity(moving);
        for _ in 0..moving {
            let body = if moving == count { ids[moves.len()] } else { rng.choose(&ids) };
            let place = world.pose(body)?.translation().map(|x| x + rng.uniform(-0.05, 0.05));
            moves.push((body, Pose::from_translation(place)?));
        }
        let (seconds, stepped) = timed(|| world.step(&moves).map(|_| ()));
        stepped?;
        (best, sum) = (best.min(seconds), sum + seconds);
        if step == 2 {
            pairs = world.pairs().map(|pair| pair.key).collect();
        }
        // With `Auto` the world needs some steps to choose.
        let least = if broad_phase == BroadPhase::Auto { 12 } else { 3 };
        if step + 1 >= least && sum > MEASURED {
            break;
        }
    }
    Ok((best, pairs))
}
