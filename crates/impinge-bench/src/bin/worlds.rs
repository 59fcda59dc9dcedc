//! Worlds of many moving bodies: meshes that tumble in a box, how steady steps are under churn, and which broad phase is the
//! quickest where.
//!
//! `cargo run --release -p impinge-bench --bin worlds -- meshes`
//!
//! Every answer is checked: pairs of meshes with the verb for two, pairs of boxes between all broad phases.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::time::Instant;

use anyhow::{Result, ensure};
use clap::{Parser, Subcommand};
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, NarrowPhase, Options, PairKey, Realignment, Work, World};
use impinge::{Mesh, Pose, Positions, query};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::icosphere;

/// Times worlds, and checks every answer
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    question: Question,
    /// How many threads to use; all processors without it
    #[arg(long, global = true)]
    threads: Option<usize>,
}

#[derive(Subcommand)]
enum Question {
    /// Bodies that share a few meshes of 20,480 triangles, tumbling in a box, decided exactly, at 60 steps a second
    Meshes {
        #[arg(long, default_value_t = 2000)]
        bodies: usize,
        #[arg(long, default_value_t = 60)]
        steps: usize,
        /// Share of the box that the meshes fill
        #[arg(long, default_value_t = 0.1)]
        filled: f64,
        /// Find contacts too, which takes minutes
        #[arg(long)]
        contacts: bool,
    },
    /// Steps with steady coming and going: work and times, the median and the worst in a thousand
    Churn {
        #[arg(long, default_value_t = 10_000)]
        bodies: usize,
        #[arg(long, default_value_t = 10_000)]
        steps: usize,
    },
    /// Every broad phase over numbers of bodies, shares that move and spreads of sizes
    Kinds {
        #[arg(long, default_value_t = 100_000)]
        most: usize,
    },
}

fn main() -> Result<()> {
    let Arguments { question, threads } = Arguments::parse();
    let threads = threads.unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    println!("{} threads", rayon::current_num_threads());
    match question {
        Question::Meshes { bodies, steps, filled, contacts } => meshes(bodies, steps, filled, contacts),
        Question::Churn { bodies, steps } => churn(bodies, steps),
        Question::Kinds { most } => kinds(most),
    }
}

/// Three blobs of 20,480 triangles, from round to knobbly, about as large as a ball of radius 1.
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
    /// A step at 60 a second.
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

fn meshes(count: usize, steps: usize, filled: f64, contacts: bool) -> Result<()> {
    let meshes = blobs()?;
    // Balls of radius 1.
    let reach = 0.5 * (count as f64 * 4.18879 / filled).cbrt();
    println!("{count} bodies of {} triangles in a box of {:.1}, {steps} steps", meshes[0].faces().len(), 2.0 * reach);
    let mut table =
        Table::new(["boxes", "finds", "median", "realign", "broad", "narrow", "examined", "pairs", "contacts"]);
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
                median(&phases[1])?,
                median(&phases[2])?,
                median(&phases[3])?,
                (examined / steps).to_string(),
                (pairs / steps).to_string(),
                (manifolds / steps).to_string(),
            ]);
        }
    }
    println!("{table}a step at 60 a second has 16.67 ms");
    Ok(())
}

/// Whether the pairs of some bodies are those that the verb for two meshes finds.
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

/// A box of a size, somewhere in a cube in which boxes of size 1 are two apart.
fn boxed(rng: &mut Rng, size: f64, reach: f64) -> Result<Body> {
    let half = [0; 3].map(|_| 0.5 * size * rng.uniform(0.8, 1.0));
    let at = [0; 3].map(|_| rng.uniform(-reach, reach));
    Ok(Body::new(Shape::cuboid(half)?).at(Pose::from_translation(at)?))
}

fn churn(count: usize, steps: usize) -> Result<()> {
    let mut table =
        Table::new(["kind", "work, median", "99.9 %", "ratio", "time, median", "99.9 %", "most pairs held"]);
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
            // Bodies that went after they were to move.
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
    Ok(())
}

/// Kinds and what they are called.
const KINDS: [(BroadPhase, &str); 7] = [
    (BroadPhase::Auto, "auto"),
    (BroadPhase::Every, "every"),
    (BroadPhase::Tree, "tree"),
    (BroadPhase::Columns, "columns"),
    (BroadPhase::Grid, "grid"),
    (BroadPhase::OneAxis, "one axis"),
    (BroadPhase::ThreeAxes, "three axes"),
];

/// Seconds of a step above which a kind is left out at more bodies of the same scene: ten times as many take it seconds.
const HOPELESS: f64 = 0.05;

/// Seconds of steps that a time is the least of, after three.
const MEASURED: f64 = 0.05;

fn kinds(most: usize) -> Result<()> {
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
                    // The axes take as long to fill as many steps take.
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
    Ok(())
}

/// The least time of a step, and the pairs after three.
fn step_time(broad_phase: BroadPhase, count: usize, share: f64, is_spread: bool) -> Result<(f64, Vec<PairKey>)> {
    let mut rng = Rng::new(9);
    let reach = (count as f64).cbrt();
    let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
    let mut ids = Vec::with_capacity(count);
    for _ in 0..count {
        let size = if is_spread { (0.1 / (1.0 - rng.unit()).sqrt()).min(100.0) } else { rng.uniform(0.5, 1.5) };
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
        // A choice that is left to the world takes some steps.
        let least = if broad_phase == BroadPhase::Auto { 12 } else { 3 };
        if step + 1 >= least && sum > MEASURED {
            break;
        }
    }
    Ok((best, pairs))
}
