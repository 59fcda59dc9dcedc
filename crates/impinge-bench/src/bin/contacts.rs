//! Contacts of flat meshes with a half-space and with a box: growth of the time with the number of
//! faces in contact.
//!
//! `cargo run --release -p impinge-bench --bin contacts`
//!
//! All faces of the mesh touch the half-space, and four fifths of them touch the box. The answer is
//! known: one manifold of four points, of which each is 0.001 deep.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::query::{self, Manifold};
use impinge::shape::{PlacedShape, Shape};
use impinge::{Mesh, Pose};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::solids::plane_grid;

/// Depth of all contacts, in units of which the mesh is ten long and wide.
const DEPTH: f64 = 1e-3;

/// Times the contacts of flat meshes
#[derive(Parser)]
struct Arguments {
    /// Number of runs of each query; the minimum time is printed
    #[arg(long, value_name = "N", default_value_t = 9)]
    repeats: usize,
    /// Numbers of squares along one side of the mesh; each is two faces
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [40, 80, 160, 240, 320])]
    sides: Vec<u32>,
}

fn main() -> Result<()> {
    let Arguments { repeats, sides } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let mut table = Table::new(["faces", "first", "half-space", "half-space a face", "box", "box a face"]);
    for side in sides {
        let faces = 2 * side as usize * side as usize;
        let floor = Shape::mesh(&floor(side)?).at(Pose::IDENTITY)?;
        let half_space = Shape::half_space([0.0, 0.0, 1.0], DEPTH)?.at(Pose::IDENTITY)?;
        let turned = Pose::from_axis_angle([0.0, 0.0, 1.0], 0.1, [0.01, 0.02, 0.5 - DEPTH])?;
        let boxed = Shape::cuboid([4.5, 4.5, 0.5])?.at(turned)?;
        let (first, found) = timed(|| query::contacts(&floor, &boxed));
        check(&found)?;
        let [of_half_space, of_box] = [least(repeats, &half_space, &floor)?, least(repeats, &floor, &boxed)?];
        let a_face = |seconds: f64| time(seconds / faces as f64);
        let cells = [faces.to_string(), time(first), time(of_half_space), a_face(of_half_space)];
        let [faces, first, half_space, half_space_a_face] = cells;
        table.row([faces, first, half_space, half_space_a_face, time(of_box), a_face(of_box)]);
    }
    print!("{table}");
    table.record("flat mesh", 1)
}

/// Returns a flat mesh about the origin, ten long and wide, with this number of squares on a side.
fn floor(side: u32) -> Result<Mesh> {
    let mut grid = plane_grid(side, side);
    let scale = 10.0 / f64::from(side);
    grid.vertices.iter_mut().for_each(|[x, y, _]| [*x, *y] = [*x * scale - 5.0, *y * scale - 5.0]);
    Ok(Mesh::new(grid.vertices, grid.faces)?)
}

/// Returns the minimum time of the contacts of two shapes, after checking each answer.
fn least(repeats: usize, a: &PlacedShape, b: &PlacedShape) -> Result<f64> {
    let run = || {
        let (seconds, found) = timed(|| query::contacts(a, b));
        check(&found)?;
        anyhow::Ok(seconds)
    };
    Ok(Samples::take(repeats, run)?.min())
}

/// Checks that there is one manifold of four points, all of the known depth.
fn check(found: &[Manifold]) -> Result<()> {
    let [manifold] = found else { anyhow::bail!("{} manifolds instead of one", found.len()) };
    ensure!(manifold.points.len() == 4, "{} points instead of four", manifold.points.len());
    ensure!(manifold.normal[2].abs() > 1.0 - 1e-12, "the normal is {:?}", manifold.normal);
    for point in &manifold.points {
        ensure!(point.lower <= DEPTH + 1e-12 && DEPTH - 1e-12 <= point.upper, "a wrong depth: {point:?}");
        ensure!(point.upper - point.lower < 1e-9, "a wide depth: {point:?}");
    }
    Ok(())
}
