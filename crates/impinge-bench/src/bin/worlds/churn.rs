//! Benchmark: steps in which bodies are steadily added and removed.

use anyhow::{Result, ensure};
use impinge::Pose;
use impinge::world::{BroadPhase, NarrowPhase, Options, Work, World};
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

use crate::scenes::boxed;

/// Prints the work and the time of `steps` steps of `count` bodies: medians and 99.9th percentiles.
///
/// # Errors
/// Returns an error if the work of some steps is far above the median.
pub(crate) fn steady(count: usize, steps: usize) -> Result<()> {
    let mut table =
        Table::new(["kind", "work median", "work 99.9 %", "ratio", "time median", "time 99.9 %", "most pairs held"]);
    for broad_phase in [BroadPhase::Auto, BroadPhase::Tree] {
        let mut rng = Rng::new(8);
        let reach = (count as f64).cbrt();
        let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
        let mut alive = Vec::new();
        for _ in 0..count {
            let size = rng.uniform(0.5, 1.5);
            alive.push(world.insert(boxed(&mut rng, size, reach)?)?);
        }
        world.step(&[])?;
        let (mut works, mut times, mut most) = (Vec::new(), Vec::new(), 0);
        for _ in 0..steps {
            let mut moves = Vec::new();
            for _ in 0..count / 100 {
                let at = rng.integer(0, alive.len() as i64 - 1) as usize;
                match rng.integer(0, 9) {
                    0 => {
                        world.remove(alive[at])?;
                        let size = rng.uniform(0.5, 1.5);
                        alive[at] = world.insert(boxed(&mut rng, size, reach)?)?;
                    }
                    1 => {
                        let place = [0; 3].map(|_| rng.uniform(-reach, reach));
                        moves.push((alive[at], Pose::from_translation(place)?));
                    }
                    _ => {
                        let from = *world.pose(alive[at])?.translation();
                        let place = from.map(|x| x + rng.uniform(-0.1, 0.1));
                        moves.push((alive[at], Pose::from_translation(place)?));
                    }
                }
            }
            // Drop moves of bodies that were removed afterwards.
            moves.retain(|(body, _)| world.pose(*body).is_ok());
            let (seconds, work) = timed(|| world.step(&moves).map(|events| events.work));
            let Work { changed, gained, lost, examined, candidates } = work?;
            works.push((changed + gained + lost + examined) as f64);
            times.push(seconds);
            most = most.max(candidates);
        }
        let percentile = |values: &mut Vec<f64>, share: f64| {
            values.sort_unstable_by(f64::total_cmp);
            values[((values.len() - 1) as f64 * share) as usize]
        };
        let [median, high] = [0.5, 0.999].map(|share| percentile(&mut works, share));
        let [median_time, high_time] = [0.5, 0.999].map(|share| percentile(&mut times, share));
        ensure!(high < 5.0 * median, "the work of a step is not steady: {high} for {median}");
        table.row([
            format!("{broad_phase:?}"),
            format!("{median}"),
            format!("{high}"),
            format!("{:.2}", high / median),
            time(median_time),
            time(high_time),
            most.to_string(),
        ]);
    }
    println!("{table}");
    table.record(&format!("{count} bodies come and go"), 1)
}
