//! `SolidBsp` beside the mesh that it is of: what it takes to build, and what a point and a ray cost. Every answer is
//! compared.
//!
//! `cargo run --release -p impinge-bench --bin bsp`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::path::Path;

use anyhow::{Result, ensure};
use impinge::mesh::{Containment, Ray, SolidBsp};
use impinge::{Mesh, Positions};
use impinge_bench::samples::timed;
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::generate::{Rng, solids};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Points and rays that are asked for in the box of each mesh, enlarged by a tenth.
const ASKED: usize = 20_000;

/// Runs of each, of which the least counts; the first of them finds out where cells are.
const RUNS: usize = 3;

fn main() -> Result<()> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let drawn = |mesh: impinge_testkit::Mesh| Surface { positions: Positions::F64(mesh.vertices), faces: mesh.faces };
    let surfaces = [
        ("block", drawn(solids::cuboid([0.0; 3], [1.0; 3]))),
        ("sphere", drawn(solids::icosphere(4))),
        ("knot", drawn(torus_knot(400, 50, TREFOIL))),
        ("human", Surface::load(&Path::new(ROOT).join("data/human_makehuman_cc0.ply"))?),
    ];
    let mut table =
        Table::new(["", "triangles", "build", "cells", "depth", "point", "by the mesh", "ray", "by the mesh"]);
    for (name, surface) in surfaces {
        let [low, high] = surface.bounds();
        let mesh = Mesh::new(surface.positions, surface.faces)?;
        let (build, tree) = timed(|| SolidBsp::build(&mesh));
        let mut rng = Rng::new(31);
        let mut place = || {
            std::array::from_fn(|k| {
                let tenth = (high[k] - low[k]) / 10.0;
                rng.uniform(low[k] - tenth, high[k] + tenth)
            })
        };
        let points: Vec<[f64; 3]> = (0..ASKED).map(|_| place()).collect();
        let ways = points.iter().map(|&from| {
            let to = place();
            Ray::new(from, std::array::from_fn(|k| to[k] - from[k]))
        });
        let rays = ways.collect::<Result<Vec<_>, _>>()?;
        let by_tree = || points.iter().map(|&point| tree.contains(point)).collect::<Result<Vec<_>, _>>();
        let (point, inside) = least(by_tree);
        let (point_by_mesh, also) = least(|| mesh.contains(&points));
        let inside = inside?;
        ensure!(inside == also?, "{name}: points are elsewhere by the tree");
        ensure!(inside.contains(&Containment::Inside) && inside.contains(&Containment::Outside), "{name}: hollow");
        let (ray, hits) = least(|| rays.iter().map(|ray| tree.ray_cast(ray)).collect::<Vec<_>>());
        let (ray_by_mesh, also) = least(|| mesh.ray_casts(&rays));
        ensure!(hits == also, "{name}: rays end elsewhere by the tree");
        ensure!(hits.iter().flatten().count() > ASKED / 20, "{name}: rays meet nothing");
        let each = |seconds: f64| time(seconds / ASKED as f64);
        table.row([
            name.to_owned(),
            mesh.faces().len().to_string(),
            time(build),
            tree.cells().to_string(),
            tree.depth().to_string(),
            each(point),
            each(point_by_mesh),
            each(ray),
            each(ray_by_mesh),
        ]);
    }
    println!("{table}");
    Ok(())
}

/// The least seconds of some runs, and the answer of the last.
fn least<T>(mut ask: impl FnMut() -> T) -> (f64, T) {
    let (mut seconds, mut answer) = timed(&mut ask);
    for _ in 1..RUNS {
        let (again, last) = timed(&mut ask);
        (seconds, answer) = (seconds.min(again), last);
    }
    (seconds, answer)
}
