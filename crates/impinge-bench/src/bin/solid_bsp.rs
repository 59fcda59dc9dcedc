//! BSP tree over the faces of a solid compared with the hierarchy of its mesh: build times, and
//! times of points and rays. Every answer is compared.
//!
//! `cargo run --release -p impinge-bench --bin solid_bsp`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::mesh::{Ray, SolidBsp};
use impinge::{Mesh, Positions};
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

/// Times points and rays in a BSP tree over a knot and in the knot's own hierarchy, on one thread,
/// and compares the answers
#[derive(Parser)]
struct Arguments {
    /// Numbers of quads along the knots; a quarter of each is used around their tubes
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [200, 632, 2000])]
    along: Vec<u32>,
    /// Number of points and of rays, uniform in the knot's box enlarged by 10 %
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    count: usize,
    /// Number of runs of each query; the minimum time is printed
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<()> {
    let Arguments { along, count, repeats } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let mut built = Table::new(["triangles", "mesh", "tree", "cells", "deepest", "bytes a triangle"]);
    let mut asked = Table::new(["triangles", "points: mesh", "tree, first", "tree, again", "rays: mesh", "tree"]);
    for along in along {
        let knot = torus_knot(along, along / 4, TREFOIL);
        let triangles = knot.faces.len();
        let (mesh_seconds, mesh) = timed(|| Mesh::new(Positions::F64(knot.vertices.clone()), knot.faces.clone()));
        let mesh = mesh?;
        ensure!(mesh.is_closed(), "a knot is closed");
        let (tree_seconds, tree) = timed(|| SolidBsp::build(&mesh));
        built.row([
            triangles.to_string(),
            time(mesh_seconds),
            time(tree_seconds),
            tree.cells().to_string(),
            tree.depth().to_string(),
            format!("{:.0}", tree.memory() as f64 / triangles as f64),
        ]);
        asked.row(questions(&mesh, &tree, count, repeats)?);
    }
    println!("{built}\n{asked}");
    Ok(())
}

fn questions(mesh: &Mesh, tree: &SolidBsp, count: usize, repeats: usize) -> Result<[String; 6]> {
    let (points, rays) = (points(mesh, count), rays(mesh, count)?);
    let each = |seconds: f64| time(seconds / count as f64);
    let by_tree = || points.iter().map(|&point| tree.contains(point)).collect::<Result<Vec<_>, _>>();
    // In cells that were not visited before, the winding number is computed.
    let (first, contained) = timed(by_tree);
    let contained = contained?;
    let (again, same) = quickest(repeats, by_tree);
    let (whole, expected) = quickest(repeats, || mesh.contains(&points));
    ensure!(contained == expected? && contained == same?, "the tree and the mesh do not agree about points");
    ensure!(contained.iter().filter(|at| at.is_contained()).count() > count / 50, "few points are inside");
    let (cast_tree, hits) = quickest(repeats, || rays.iter().map(|ray| tree.ray_cast(ray)).collect::<Vec<_>>());
    let (cast_mesh, expected) = quickest(repeats, || rays.iter().map(|ray| mesh.ray_cast(ray)).collect::<Vec<_>>());
    ensure!(hits == expected, "the tree and the mesh do not agree about rays");
    ensure!(hits.iter().flatten().count() > count / 4, "few rays hit");
    let triangles = mesh.faces().len().to_string();
    Ok([triangles, each(whole), each(first), each(again), each(cast_mesh), each(cast_tree)])
}

/// Returns the minimum time of some runs in seconds, and the last answer.
fn quickest<T>(repeats: usize, mut ask: impl FnMut() -> T) -> (f64, T) {
    let (mut least, mut answer) = timed(&mut ask);
    for _ in 1..repeats {
        let (seconds, again) = timed(&mut ask);
        (least, answer) = (least.min(seconds), again);
    }
    (least, answer)
}

/// Returns uniform points in the box of the mesh enlarged by 10 %.
fn points(mesh: &Mesh, count: usize) -> Vec<[f64; 3]> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in (0..mesh.faces().len() as u32).flat_map(|face| mesh.corners(face)) {
        low = [0, 1, 2].map(|axis| corner[axis].min(low[axis]));
        high = [0, 1, 2].map(|axis| corner[axis].max(high[axis]));
    }
    let mut rng = Rng::new(5);
    let mut point = || {
        [0, 1, 2].map(|axis| {
            let tenth = (high[axis] - low[axis]) / 10.0;
            rng.uniform(low[axis] - tenth, high[axis] + tenth)
        })
    };
    (0..count).map(|_| point()).collect()
}

/// Returns rays from random points toward others, all in the box of the mesh enlarged by 10 %.
fn rays(mesh: &Mesh, count: usize) -> Result<Vec<Ray>> {
    let ends = points(mesh, 2 * count);
    let rays = ends.as_chunks::<2>().0.iter().map(|[from, to]| Ray::new(*from, [0, 1, 2].map(|k| to[k] - from[k])));
    Ok(rays.collect::<Result<_, _>>()?)
}
