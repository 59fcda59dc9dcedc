//! Benchmark: bodies that share a few meshes and tumble in a box, decided exactly.

use std::time::Instant;

use anyhow::{Result, ensure};
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, NarrowPhase, Options, Realignment, World};
use impinge::{Mesh, Pose, Positions, query};
use impinge_bench::samples::Samples;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::icosphere;

/// Returns three blobs of 20,480 triangles, from round to knobbly, about as large as a sphere of
/// radius 1.
fn blobs() -> Result<Vec<Mesh>> {
    let ball = icosphere(5);
    let knobs = [0.0, 0.2, 0.4];
    let meshes = knobs.iter().map(|&knob| {
        let vertices = ball.vertices.iter().map(|&[x, y, z]| {
            let size = 1.0 + knob * (16.0 * x * y * z - 4.0 * (x * x - y * y) * z * z);
            [x * size, y * size, z * size]
        });
        Ok(Mesh::new(Positions::F64(vertices.collect()), ball.faces.clone())?)
    });
    meshes.collect()
}

/// Bodies that drift and turn in a box, and bounce off its walls.
struct Tumbling {
    reach: f64,
    bodies: Vec<Tumbler>,
}

struct Tumbler {
    id: BodyId,
    at: [f64; 3],
    velocity: [f64; 3],
    turn: [f64; 3],
    pose: Pose,
}

impl Tumbling {
    /// Returns the moves of one step, at 60 steps per second.
    fn moves(&mut self) -> Result<Vec<(BodyId, Pose)>> {
        let mut moves = Vec::with_capacity(self.bodies.len());
        for body in &mut self.bodies {
            for k in 0..3 {
                body.at[k] += body.velocity[k] / 60.0;
                if body.at[k].abs() > self.reach {
                    body.velocity[k] = -body.velocity[k].abs().copysign(body.at[k]);
                }
            }
            let [x, y, z] = body.turn.map(|turn| turn / 120.0);
            let length = (1.0 + x * x + y * y + z * z).sqrt();
            let turn = Pose::from_quaternion_wxyz([0.0; 3], [1.0, x, y, z].map(|part| part / length))?;
            let turned = turn.compose(&Pose::new(*body.pose.linear(), [0.0; 3])?)?;
            body.pose = Pose::new(*turned.linear(), body.at)?;
            moves.push((body.id, body.pose));
        }
        Ok(moves)
    }
}

/// Prints the times of steps in which all bodies move. `filled` is the share of the box that the
/// bodies fill.
///
/// # Errors
/// Returns an error if a pair of bodies disagrees with the query for two meshes.
pub(crate) fn tumble(count: usize, steps: usize, filled: f64, contacts: bool) -> Result<()> {
    let meshes = blobs()?;
    // A body takes about the volume of a sphere of radius 1.
    let reach = 0.5 * (count as f64 * 4.18879 / filled).cbrt();
    println!("{count} bodies of {} triangles in a box of {:.1}, {steps} steps", meshes[0].faces().len(), 2.0 * reach);
    let mut table =
        Table::new(["boxes", "finds", "step", "realign", "take", "broad", "narrow", "examined", "pairs", "contacts"]);
    for (way, name) in [(Realignment::Own, "own"), (Realignment::Climbing, "climbing")] {
        for narrow_phase in [NarrowPhase::Intersections, NarrowPhase::Contacts] {
            if narrow_phase == NarrowPhase::Contacts && !contacts {
                continue;
            }
            let options = Options { narrow_phase, ..Options::default() };
            let bodies: Vec<Body> =
                meshes.iter().map(|mesh| Ok(Body::new(Shape::mesh(mesh)).realigned_by(way)?)).collect::<Result<_>>()?;
            let mut rng = Rng::new(7);
            let mut world = World::with_options(options);
            let mut tumbling = Tumbling { reach, bodies: Vec::new() };
            for number in 0..count {
                let at = [0; 3].map(|_| rng.uniform(-reach, reach));
                let pose = Pose::from_translation(at)?;
                let id = world.insert(bodies[number % bodies.len()].clone().at(pose))?;
                let velocity = [0; 3].map(|_| rng.uniform(-2.0, 2.0));
                let turn = [0; 3].map(|_| rng.uniform(-2.0, 2.0));
                tumbling.bodies.push(Tumbler { id, at, velocity, turn, pose });
            }
            world.step(&[])?;
            let mut phases = [const { Vec::new() }; 5];
            let (mut examined, mut pairs, mut manifolds) = (0, 0, 0);
            for _ in 0..steps {
                let moves = tumbling.moves()?;
                let mut last = Instant::now();
                let mut total = 0.0;
                let events = world.step_observed(&moves, &mut |phase| {
                    let seconds = last.elapsed().as_secs_f64();
                    phases[phase as usize].push(seconds);
                    total += seconds;
                    last = Instant::now();
                })?;
                examined += events.work.examined;
                pairs += world.pairs().count();
                manifolds += world.pairs().map(|pair| pair.manifolds.len()).sum::<usize>();
            }
            check(&world, &tumbling, &meshes)?;
            let total: Vec<f64> = (0..steps).map(|step| phases.iter().map(|phase| phase[step]).sum()).collect();
            let median = |seconds: &[f64]| -> Result<String> {
                let mut left = seconds.iter();
                Ok(time(
                    Samples::take(seconds.len(), || left.next().copied().ok_or(anyhow::anyhow!("too few")))?.median(),
                ))
            };
            table.row([
                name.to_owned(),
                format!("{narrow_phase:?}").to_lowercase(),
                median(&total)?,
                median(&phases[0])?,
                median(&phases[1])?,
                median(&phases[2])?,
                median(&phases[3])?,
                (examined / steps).to_string(),
                (pairs / steps).to_string(),
                (manifolds / steps).to_string(),
            ]);
        }
    }
    println!("{table}medians of the steps; a step at 60 a second has 16.67 ms");
    table.record(&format!("{count} bodies"), 2)
}

/// Checks the pairs of some bodies against the query for two meshes.
fn check(world: &World, tumbling: &Tumbling, meshes: &[Mesh]) -> Result<()> {
    let placed = |at: usize| meshes[at % meshes.len()].at(tumbling.bodies[at].pose);
    for a in (0..tumbling.bodies.len()).step_by(tumbling.bodies.len().div_ceil(20)) {
        for b in 0..tumbling.bodies.len() {
            let found = a != b && world.pair(tumbling.bodies[a].id, tumbling.bodies[b].id)?.is_some();
            ensure!(a == b || found == query::intersects(placed(a), placed(b)), "bodies {a} and {b}");
        }
    }
    Ok(())
}
