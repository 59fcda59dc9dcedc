//! Queries about solids: winding numbers of points, meshes nested in each other and apart,
//! interiors that overlap or only touch, and self-intersections. Every answer is checked.
//!
//! `cargo run --release -p impinge-bench --bin solids`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::path::Path;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::query::{self, Penetrates};
use impinge::{Mesh, Pose, Positions};
use impinge_bench::samples::timed;
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_testkit::env_rob::data_folder;
use impinge_testkit::generate::knots::{Knot, TREFOIL, torus_knot};
use impinge_testkit::generate::{Rng, solids};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Number of points per mesh, uniform in its box enlarged by 10 %.
const POINTS: usize = 100_000;

/// Times queries about solids, and checks every answer
#[derive(Parser)]
struct Arguments {
    /// Number of threads for building and queries
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Number of runs of each query; the minimum time is printed
    #[arg(long, value_name = "N", default_value_t = 3)]
    repeats: usize,
    /// Number of quads along the knot; a quarter of it is used around its tube
    #[arg(long, value_name = "N", default_value_t = 2000)]
    along: u32,
}

fn main() -> Result<()> {
    let Arguments { threads, repeats, along } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    points(repeats)?;
    meshes(along, repeats)
}

/// Returns the minimum time of some runs in seconds, and the answer, which must be the same in all.
fn quickest<T: PartialEq>(repeats: usize, mut ask: impl FnMut() -> T) -> Result<(f64, T)> {
    let (mut least, answer) = timed(&mut ask);
    for _ in 1..repeats {
        let (seconds, again) = timed(&mut ask);
        ensure!(again == answer, "two runs answer differently");
        least = least.min(seconds);
    }
    Ok((least, answer))
}

fn points(repeats: usize) -> Result<()> {
    let mut table = Table::new(["", "triangles", "border", "first", "contains / s", "winding / s", "inside"]);
    let mut files = vec![("human", Path::new(ROOT).join("data/human_makehuman_cc0.ply"))];
    files.extend(data_folder().map(|folder| ("bunny", folder.join("meshes/stanford-bunny.obj"))));
    for (name, path) in files {
        let surface = Surface::load(&path)?;
        let mesh = Mesh::new(surface.positions.clone(), surface.faces.clone())?;
        let [low, high] = surface.bounds();
        let mut rng = Rng::new(1);
        let points: Vec<[f64; 3]> = (0..POINTS)
            .map(|_| {
                std::array::from_fn(|k| {
                    let tenth = (high[k] - low[k]) / 10.0;
                    rng.uniform(low[k] - tenth, high[k] + tenth)
                })
            })
            .collect();
        let (first, closed) = timed(|| mesh.is_closed());
        let (contains, inside) = quickest(repeats, || mesh.contains(&points))?;
        let (winding, numbers) = quickest(repeats, || mesh.winding_number(&points))?;
        let (inside, numbers) = (inside?, numbers?);
        let count = inside.iter().filter(|at| at.is_contained()).count();
        let by_number = numbers.iter().filter(|number| number.value.abs() > 0.5).count();
        ensure!(count == by_number, "{name}: {count} points are contained, {by_number} are wound round");
        let a_second = |seconds: f64| format!("{:.0}", POINTS as f64 / seconds);
        table.row([
            name.to_owned(),
            surface.faces.len().to_string(),
            if closed { "closed".to_owned() } else { "open".to_owned() },
            time(first),
            a_second(contains),
            a_second(winding),
            format!("{:.1} %", 100.0 * count as f64 / POINTS as f64),
        ]);
    }
    println!("{table}");
    table.record("points", 1)
}

fn meshes(along: u32, repeats: usize) -> Result<()> {
    let build = |mesh: impinge_testkit::Mesh| Mesh::new(Positions::F64(mesh.vertices), mesh.faces);
    let knot = build(torus_knot(along, along / 4, TREFOIL))?;
    // The thin knot lies inside the other knot.
    let thin = build(torus_knot(along, along / 4, Knot { radius: 0.2, ..TREFOIL }))?;
    let mut table = Table::new(["", "first", "again", "answer"]);
    let mut ask = |name: &str, question: &dyn Fn() -> Result<String>, expected: &str| -> Result<()> {
        let (first, answer) = timed(question);
        let (again, same) = quickest(repeats, || question().unwrap_or_default())?;
        let answer = answer?;
        ensure!(answer == same && answer == expected, "{name}: {answer}, not {expected}");
        table.row([name.to_owned(), time(first), time(again), answer]);
        Ok(())
    };
    let solid = |a: &Mesh, b: &Mesh, at: [f64; 3]| -> Result<String> {
        let placed = b.at(Pose::from_translation(at)?);
        Ok(format!("{:?}", query::solid_intersection(a.solid(), placed).contained))
    };
    ask("knots nested, solid", &|| solid(&knot, &thin, [0.0; 3]), "Some(B)")?;
    ask("knots apart, solid", &|| solid(&knot, &thin, [0.0, 0.0, 9.0]), "None")?;
    let surfaces = || Ok(format!("{:?}", query::intersects(&knot, &thin)));
    ask("knots nested, surfaces alone", &surfaces, "false")?;
    let copy = Pose::from_translation([0.5, 0.0, -0.125])?;
    let penetration =
        |a: &Mesh, b: &Mesh, at: Pose| -> Result<String> { Ok(format!("{:?}", query::penetrates(a, b.at(at)))) };
    ask("knots nested, penetration", &|| penetration(&knot, &thin, Pose::IDENTITY), &format!("{:?}", Penetrates::Yes))?;
    ask("knot through knot, penetration", &|| penetration(&knot, &knot, copy), &format!("{:?}", Penetrates::Yes))?;
    let slab = build(block(300))?;
    let upon = Pose::from_translation([0.0, 0.0, 1.0])?;
    ask("block on block, penetration", &|| penetration(&slab, &slab, upon), &format!("{:?}", Penetrates::No))?;
    let human = Surface::load(&Path::new(ROOT).join("data/human_makehuman_cc0.ply"))?;
    let human = Mesh::new(human.positions, human.faces)?;
    let pairs = query::self_intersecting_pairs(&human).len().to_string();
    ask("human with itself", &|| Ok(query::self_intersecting_pairs(&human).len().to_string()), &pairs)?;
    let fan = build(solids::fan(32_000))?;
    ask("fan with itself", &|| Ok(query::self_intersecting_pairs(&fan).len().to_string()), "0")?;
    ask("knot with itself", &|| Ok(query::self_intersecting_pairs(&knot).len().to_string()), "0")?;
    println!("{table}");
    table.record("meshes", 1)
}

/// Returns a block of unit height whose upper and lower sides are grids of `n` by `n` squares.
fn block(n: u32) -> impinge_testkit::Mesh {
    let top = solids::plane_grid(n, n);
    let offset = top.vertices.len() as u32;
    let mut mesh = top.clone();
    mesh.vertices.iter_mut().for_each(|vertex| vertex[2] = 1.0);
    mesh.vertices.extend(top.vertices.iter().copied());
    mesh.faces.extend(top.faces.iter().map(|&[a, b, c]| [a + offset, c + offset, b + offset]));
    let side = n + 1;
    for i in 0..n {
        for [from, to] in [
            [i, i + 1],
            [i * side + n, (i + 1) * side + n],
            [n * side + i + 1, n * side + i],
            [(i + 1) * side, i * side],
        ] {
            mesh.faces.extend([[from + offset, to + offset, to], [from + offset, to, from]]);
        }
    }
    mesh
}
