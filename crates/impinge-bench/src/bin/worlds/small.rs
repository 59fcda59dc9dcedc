//! Benchmark: small worlds of which all bodies move.

use anyhow::{Result, ensure};
use impinge::query;
use impinge::world::{Body, BodyId, NarrowPhase, Options, World};
use impinge::{Pose, Shape};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::{Rng, poses};

/// Maximum distance of a body from its place, along each axis. Bodies are about 1 in size, and
/// their mean spacing is 2.
const PLAY: f64 = 0.05;

/// Shapes of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Shapes {
    Spheres,
    Boxes,
}

/// Times steps of small worlds, by shapes and by narrow phases.
///
/// # Errors
/// Returns an error if a world has other pairs than the queries of two shapes.
pub(crate) fn compare(counts: &[usize], steps: usize, only: Option<Shapes>) -> Result<()> {
    let mut table = Table::new(["bodies", "shapes", "boxes only", "intersections", "contacts", "pairs"]);
    for &count in counts {
        for (shapes, name) in [(Shapes::Spheres, "spheres"), (Shapes::Boxes, "boxes")] {
            if only.is_some_and(|only| only != shapes) {
                continue;
            }
            let scene = Scene::new(count, shapes)?;
            let mut cells = vec![count.to_string(), name.to_owned()];
            let mut pairs = 0;
            for narrow_phase in [NarrowPhase::Boxes, NarrowPhase::Intersections, NarrowPhase::Contacts] {
                let (samples, found) = scene.step_time(narrow_phase, steps)?;
                cells.push(time(samples.median()));
                pairs = found;
            }
            cells.push(pairs.to_string());
            table.row(cells.try_into().map_err(|_| anyhow::anyhow!("a cell is missing"))?);
        }
    }
    println!("{table}median time of a step, all bodies move");
    table.record("all bodies move", 2)
}

/// Bodies about their places, and their poses in a few steps.
struct Scene {
    shapes: Vec<Shape>,
    poses: Vec<Vec<Pose>>,
}

/// Number of different steps of a scene, which are repeated in turn.
const VARIANTS: usize = 16;

impl Scene {
    fn new(count: usize, shapes: Shapes) -> Result<Self> {
        let mut rng = Rng::new(12);
        let reach = (count as f64).cbrt();
        let mut scene = Self { shapes: Vec::new(), poses: vec![Vec::new(); VARIANTS] };
        for _ in 0..count {
            let half = 0.5 * rng.uniform(0.8, 1.2);
            scene.shapes.push(match shapes {
                Shapes::Spheres => Shape::sphere([0.0; 3], half)?,
                Shapes::Boxes => Shape::cuboid([0; 3].map(|_| half * rng.uniform(0.8, 1.0)))?,
            });
            let place = [0; 3].map(|_| rng.uniform(-reach, reach));
            let turn = poses::rotation(&mut rng).linear;
            for poses in &mut scene.poses {
                poses.push(Pose::new(turn, place.map(|x| x + rng.uniform(-PLAY, PLAY)))?);
            }
        }
        Ok(scene)
    }

    /// Returns the times of some steps, and the number of pairs after the last step.
    fn step_time(&self, narrow_phase: NarrowPhase, steps: usize) -> Result<(Samples, usize)> {
        let mut world = World::with_options(Options { narrow_phase, ..Options::default() });
        let ids: Vec<BodyId> =
            self.shapes.iter().map(|shape| world.insert(Body::new(shape.clone()))).collect::<Result<_, _>>()?;
        let moves = |step: usize| -> Vec<(BodyId, Pose)> {
            ids.iter().copied().zip(self.poses[step % VARIANTS].iter().copied()).collect()
        };
        (0..VARIANTS).try_for_each(|step| world.step(&moves(step)).map(|_| ()))?;
        let mut step = 0;
        let samples = Samples::take(steps, || {
            let moves = moves(step);
            step += 1;
            let (seconds, stepped) = timed(|| world.step(&moves).map(|_| ()));
            stepped.map(|()| seconds)
        })?;
        let found: Vec<[BodyId; 2]> = world.pairs().map(|pair| [pair.key.a, pair.key.b]).collect();
        if narrow_phase != NarrowPhase::Boxes {
            ensure!(found == self.pairs((step - 1) % VARIANTS, &ids)?, "the world has other pairs than the queries");
        }
        Ok((samples, found.len()))
    }

    /// Returns the pairs of bodies that intersect, by comparing all of them.
    fn pairs(&self, step: usize, ids: &[BodyId]) -> Result<Vec<[BodyId; 2]>> {
        let place = |(shape, pose): (&Shape, &Pose)| shape.at(*pose);
        let placed: Vec<_> = self.shapes.iter().zip(&self.poses[step]).map(place).collect::<Result<_, _>>()?;
        let all = (0..placed.len()).flat_map(|a| (a + 1..placed.len()).map(move |b| [a, b]));
        let met = all.filter(|&[a, b]| query::intersects(&placed[a], &placed[b]));
        Ok(met.map(|pair| pair.map(|at| ids[at])).collect())
    }
}
