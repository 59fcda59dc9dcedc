//! 1,000 animated characters, all against all, and 1,000 rays, per frame; and the cost of rays
//! against each kind of volume.
//!
//! `cargo run --release -p impinge-bench --bin characters`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

mod bodies;
mod layers;
mod surfaces;

use std::hint::black_box;
use std::path::Path;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::character::{Character, Mode, Plan, Posed, Rig, RigPose, VolumeKind};
use impinge::mesh::Ray;
use impinge_bench::samples::{Samples, timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use rayon::prelude::*;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Times crowds of animated characters, and checks them against all pairs
#[derive(Parser)]
struct Arguments {
    /// Number of frames of each crowd
    #[arg(long, value_name = "N", default_value_t = 30)]
    repeats: usize,
    /// Number of threads
    #[arg(long, value_name = "N", default_value_t = 2)]
    threads: usize,
    /// Number of volumes of a character
    #[arg(long, value_name = "N", default_value_t = 20)]
    volumes: usize,
    /// Maximum number of characters in a crowd
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    most: usize,
    /// Print one JSON object per crowd, in seconds, instead of tables
    #[arg(long)]
    json: bool,
}

fn main() -> Result<()> {
    let Arguments { repeats, threads, volumes, most, json } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let rig = impinge_files::load_rig(Path::new(ROOT).join("data/robot.glb"))?;
    let character = Character::fit(&rig, &Plan::automatic(&rig, volumes)?, Mode::Conservative)?;
    let counts = [100, 300, 1000, 3000, 10_000].into_iter().filter(|&count| count <= most);
    if json {
        for count in counts {
            println!("{}", crowd(&rig, &character, count, repeats)?.json());
        }
        return Ok(());
    }
    kinds(&rig)?;
    for (name, rig) in layers::characters(Path::new(ROOT))? {
        println!("\nVolumes about some parts of a {name}, beside one box about all; on one thread");
        print!("{}", layers::table(name, &rig, volumes, 6, repeats)?);
        println!("\nThe part that a ray strikes, on one thread");
        print!("{}", surfaces::table(name, &rig, 6, repeats)?);
    }
    println!("\nA step of a world of characters on {threads} threads");
    print!("{}", bodies::table(&rig, &character, most.min(1000), repeats)?);
    println!("\nA frame of characters of {} volumes on {threads} threads, and 1,000 rays", character.parts().len());
    let mut table = Table::new(["", "pose", "sweep", "parts", "rays", "all", "pairs", "of parts", "hits"]);
    for count in counts {
        table.row(crowd(&rig, &character, count, repeats)?.row());
    }
    print!("{table}");
    Ok(())
}

/// Minimum times of each phase of a frame and of all phases, in seconds; and the numbers of pairs
/// of characters, of pairs of parts, and of rays that hit.
struct Crowd {
    count: usize,
    seconds: [f64; 5],
    found: [usize; 3],
}

impl Crowd {
    fn row(&self) -> [String; 9] {
        let [pose, sweep, parts, rays, all] = self.seconds.map(time);
        let [pairs, pairs_of_parts, hits] = self.found.map(|n| n.to_string());
        [self.count.to_string(), pose, sweep, parts, rays, all, pairs, pairs_of_parts, hits]
    }

    fn json(&self) -> serde_json::Value {
        let [pose, sweep, parts, rays, all] = self.seconds;
        let [pairs, pairs_of_parts, hits] = self.found;
        serde_json::json!({
            "characters": self.count, "pose": pose, "sweep": sweep, "parts": parts, "rays": rays, "all": all,
            "pairs": pairs, "pairs_of_parts": pairs_of_parts, "hits": hits,
        })
    }
}

/// Times a ray against one volume of each kind around a robot in one pose.
fn kinds(rig: &Rig) -> Result<()> {
    println!("A ray against one part, from everywhere");
    let mut table = Table::new(["", "time", "struck"]);
    let mut random = Rng::new(1);
    let mut unit = || random.uniform(-1.0, 1.0);
    let rays = (0..10_000).map(|_| {
        let [from, to] = [8.0, 1.5].map(|reach| [0, 1, 2].map(|k| reach * unit() + [0.0, 2.0, 0.0][k]));
        Ray::new(from, [0, 1, 2].map(|k| to[k] - from[k]))
    });
    let rays: Vec<Ray> = rays.collect::<Result<_, _>>()?;
    let pose = rig.pose_at(0, 0.5)?;
    for kind in VolumeKind::ALL {
        let mut plan = Plan::automatic(rig, 1)?;
        plan.parts[0].kind = Some(kind);
        let character = Character::fit(rig, &plan, Mode::Conservative)?;
        let posed = Posed::new(&character, &pose);
        let mut struck = 0;
        let samples = Samples::take(9, || {
            let (seconds, hits) = timed(|| rays.iter().filter(|ray| posed.ray_cast(black_box(ray)).is_some()).count());
            struck = hits;
            anyhow::Ok(seconds / rays.len() as f64)
        })?;
        table.row([kind.name().to_owned(), time(samples.min()), struck.to_string()]);
    }
    print!("{table}");
    Ok(())
}

/// A character of a crowd. It stays in place and plays an animation.
struct Member {
    animation: usize,
    offset: f64,
    place: [f64; 3],
}

impl Member {
    /// Returns the time in the member's animation at a frame, in seconds.
    fn time(&self, rig: &Rig, frame: usize) -> f64 {
        let [start, end] = rig.animations()[self.animation].span();
        start + (frame as f64 / 60.0 + self.offset) % (end - start)
    }
}

/// Returns a crowd on a square, and the side of the square in meters.
fn members(rig: &Rig, count: usize) -> (Vec<Member>, f64) {
    let mut random = Rng::new(3);
    // About 40 square meters each, so that many touch one other character, and few touch more.
    let side = (40.0 * count as f64).sqrt();
    let mut share = || random.unit();
    let member = |_| Member {
        animation: (share() * rig.animations().len() as f64) as usize,
        offset: 10.0 * share(),
        place: [side * share(), 0.0, side * share()],
    };
    ((0..count).map(member).collect(), side)
}

fn crowd(rig: &Rig, character: &Character, count: usize, repeats: usize) -> Result<Crowd> {
    let (members, side) = members(rig, count);
    let mut random = Rng::new(4);
    let mut share = || random.unit();
    let rays: Vec<([f64; 3], [f64; 3])> = (0..1000)
        .map(|_| {
            let from = [side * share(), 1.0 + 2.0 * share(), side * share()];
            (from, [20.0 * (share() - 0.5), share() - 0.5, 20.0 * (share() - 0.5)])
        })
        .collect();
    let rest = rig.rest_pose()?;
    let mut posed: Vec<Posed<'_>> = members.iter().map(|_| Posed::new(character, &rest)).collect();
    let bones = character.bones(rig);
    let mut phases = vec![Vec::new(); 5];
    let (mut pairs_of_bodies, mut pairs_of_parts, mut hits) = (0, 0, 0);
    for frame in 0..repeats.max(1) {
        let (pose_seconds, posing) = timed(|| {
            // Each thread reuses one pose of the rig. Only volumes are kept.
            posed.par_iter_mut().zip(&members).try_for_each_init(RigPose::default, |pose, (posed, member)| {
                rig.pose_bones_into(member.animation, member.time(rig, frame), &bones, pose)?;
                posed.set_at(pose, member.place);
                anyhow::Ok(())
            })
        });
        posing?;
        let (sweep_seconds, [bodies, shots]) = timed(|| sweep(&posed, &rays));
        let (parts_seconds, found) = timed(|| {
            bodies
                .par_iter()
                .map(|&(a, b)| {
                    let mut found = 0_usize;
                    posed[a as usize].pairs_with(&posed[b as usize], &mut |_, _| found += 1)?;
                    anyhow::Ok(found)
                })
                .try_reduce(|| 0, |a, b| Ok(a + b))
        });
        let (rays_seconds, struck) = timed(|| {
            shots
                .par_iter()
                .map(|&(ray, body)| {
                    let (from, direction) = rays[ray as usize];
                    let ray = Ray::new(from, direction)?;
                    let hit = posed[body as usize].ray_cast(&ray);
                    anyhow::Ok(usize::from(hit.is_some_and(|hit| hit.t <= 1.0)))
                })
                .try_reduce(|| 0, |a, b| Ok(a + b))
        });
        pairs_of_bodies = bodies.len();
        (pairs_of_parts, hits) = (found?, struck?);
        let all = pose_seconds + sweep_seconds + parts_seconds + rays_seconds;
        let seconds = [pose_seconds, sweep_seconds, parts_seconds, rays_seconds, all];
        phases.iter_mut().zip(seconds).for_each(|(phase, seconds)| phase.push(seconds));
    }
    if count <= 1000 {
        check(&posed, &rays, pairs_of_parts, hits)?;
    }
    let least = |phase: &Vec<f64>| phase.iter().copied().fold(f64::INFINITY, f64::min);
    let seconds = std::array::from_fn(|phase| least(&phases[phase]));
    Ok(Crowd { count, seconds, found: [pairs_of_bodies, pairs_of_parts, hits] })
}

type Pairs = Vec<(u32, u32)>;

/// Returns pairs of characters whose boxes overlap, and of rays and characters, by sorting the
/// lower ends along x.
fn sweep(posed: &[Posed<'_>], rays: &[([f64; 3], [f64; 3])]) -> [Pairs; 2] {
    let bodies = posed.len() as u32;
    let of_body = |body: &Posed<'_>| body.outer();
    let of_ray = |(from, by): &([f64; 3], [f64; 3])| {
        let to = [0, 1, 2].map(|k| from[k] + by[k]);
        [[0, 1, 2].map(|k| from[k].min(to[k])), [0, 1, 2].map(|k| from[k].max(to[k]))]
    };
    let boxes: Vec<[[f64; 3]; 2]> = posed.iter().map(of_body).chain(rays.iter().map(of_ray)).collect();
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    order.par_sort_unstable_by(|&a, &b| boxes[a as usize][0][0].total_cmp(&boxes[b as usize][0][0]).then(a.cmp(&b)));
    let sorted: Vec<(u32, [[f64; 3]; 2])> = order.into_iter().map(|at| (at, boxes[at as usize])).collect();
    let found: Vec<Pairs> = sorted
        .par_iter()
        .enumerate()
        .with_min_len(64)
        .map(|(at, (a, bounds))| {
            let mut found = Vec::new();
            for (b, other) in &sorted[at + 1..] {
                if other[0][0] > bounds[1][0] {
                    break;
                }
                let overlap = |k: usize| bounds[0][k] <= other[1][k] && other[0][k] <= bounds[1][k];
                if (*a < bodies || *b < bodies) && overlap(2) && overlap(1) {
                    found.push(((*a).min(*b), (*a).max(*b)));
                }
            }
            found
        })
        .collect();
    let (pairs, shots): (Pairs, Pairs) = found.into_iter().flatten().partition(|pair| pair.1 < bodies);
    [pairs, shots.into_iter().map(|(body, ray)| (ray - bodies, body)).collect()]
}

/// Checks the counts against all pairs of characters, and against all rays on all characters.
fn check(posed: &[Posed<'_>], rays: &[([f64; 3], [f64; 3])], pairs: usize, hits: usize) -> Result<()> {
    let mut all = 0;
    for (at, a) in posed.iter().enumerate() {
        for b in &posed[..at] {
            a.pairs_with(b, &mut |_, _| all += 1)?;
        }
    }
    ensure!(all == pairs, "{pairs} pairs of parts, where all against all finds {all}");
    let mut struck = 0;
    for &(from, direction) in rays {
        let ray = Ray::new(from, direction)?;
        struck += posed.iter().filter(|p| p.ray_cast(&ray).is_some_and(|hit| hit.t <= 1.0)).count();
    }
    ensure!(struck == hits, "{hits} hits, where all rays against all find {struck}");
    Ok(())
}
