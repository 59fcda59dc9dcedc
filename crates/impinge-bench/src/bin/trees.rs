//! impinge and obvhs in one run on one thread: builds of a tree, and first hits of rays.
//!
//! `cargo run --release -p impinge-bench --features peers --bin trees`
//!
//! A build of impinge is that of a whole mesh: validated, and with its triangles packed for
//! queries. A build of obvhs is that of the wide tree over triangles in memory, and of the binary
//! tree from which it is made. obvhs computes in single precision, so both get vertices rounded to
//! it. Its rays use the test of Möller and Trumbore, which is not exact along edges, so a few of
//! its rays pass between two triangles. They are counted.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use glam::Vec3A;
use impinge::hierarchy::Builder;
use impinge::mesh::Ray;
use impinge::{Mesh, Positions};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::{Choice, Surface};
use impinge_bench::table::{Table, spread, time};
use impinge_testkit::generate::Rng;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;

/// Times impinge and obvhs on the same floats, and compares the hits of their rays.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    mesh: Choice,
    /// Number of runs of each build and of all rays
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Number of rays
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    rays: usize,
}

fn main() -> Result<()> {
    let Arguments { mesh: choice, repeats, rays } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let surface = choice.surface()?;
    let positions: Vec<[f32; 3]> =
        (0..surface.positions.len()).map(|at| surface.positions.get(at).map(|x| x as f32)).collect();
    let triangles: Vec<Triangle> = surface.faces.iter().map(|face| triangle(&positions, face)).collect();
    let rays = rays_at(&surface, rays)?;

    println!("{} triangles, {} rays", triangles.len(), rays.len());
    let mut table = Table::new([
        "",
        "build minimum",
        "build median",
        "binary tree alone",
        "ray minimum",
        "ray median",
        "rays that hit",
        "otherwise than impinge's",
    ]);
    let mut truth: Option<Vec<Option<f64>>> = None;
    for builder in [Builder::Morton, Builder::Median, Builder::BinnedSah, Builder::Ploc] {
        let (mesh, build) = built(&positions, &surface.faces, builder, repeats)?;
        let cast = || rays.iter().map(|ray| mesh.ray_cast(black_box(ray)).map(|hit| hit.t)).collect();
        let (hits, seconds) = cast_all(repeats, rays.len(), cast)?;
        let truth = truth.get_or_insert_with(|| hits.clone());
        ensure!(*truth == hits, "{} changes an answer", builder.name());
        table.row(row(format!("impinge, {}", builder.name()), [&build], &seconds, &hits, truth));
    }
    let truth = truth.context("no builder was asked")?;
    let presets = [
        ("fastest", BvhBuildParams::fastest_build()),
        ("very fast", BvhBuildParams::very_fast_build()),
        ("fast", BvhBuildParams::fast_build()),
        ("medium", BvhBuildParams::medium_build()),
    ];
    for (name, preset) in presets {
        let mut tree = None;
        let build = Samples::take(repeats, || {
            tree = None;
            let (seconds, built) = timed(|| build_cwbvh_from_tris(&triangles, preset, &mut Duration::default()));
            tree = Some(built);
            anyhow::Ok(seconds)
        })?;
        let tree = tree.context("no build was asked for")?;
        let binary = Samples::take(repeats, || {
            let (seconds, built) = timed(|| build_bvh2_from_tris(&triangles, preset, &mut Duration::default()));
            ensure!(!built.nodes.is_empty(), "{name}: no tree");
            Ok(seconds)
        })?;
        let (hits, seconds) = cast_all(repeats, rays.len(), || {
            rays.iter().map(|ray| first_hit(&tree, &triangles, black_box(ray))).collect()
        })?;
        let otherwise = differing(&hits, &truth);
        ensure!(otherwise <= rays.len() / 500, "{name}: {otherwise} rays of {} hit elsewhere", rays.len());
        table.row(row(format!("obvhs, {name}"), [&build, &binary], &seconds, &hits, &truth));
    }
    print!("{table}");
    table.record(&format!("{} triangles", triangles.len()), 1)
}

fn triangle(positions: &[[f32; 3]], face: &[u32; 3]) -> Triangle {
    let [v0, v1, v2] = face.map(|vertex| Vec3A::from_array(positions[vertex as usize]));
    Triangle { v0, v1, v2 }
}

fn built(positions: &[[f32; 3]], faces: &[[u32; 3]], builder: Builder, repeats: usize) -> Result<(Mesh, Samples)> {
    let mut mesh = None;
    let samples = Samples::take(repeats, || {
        let (positions, faces) = (Positions::F32(positions.to_vec()), faces.to_vec());
        drop(mesh.take());
        let (seconds, built) = timed(|| Mesh::with_builder(positions, faces, builder));
        mesh = Some(built?);
        anyhow::Ok(seconds)
    })?;
    Ok((mesh.context("no build was asked for")?, samples))
}

/// Returns rays from outside the mesh to points in its box. Many hit it.
fn rays_at(surface: &Surface, count: usize) -> Result<Vec<Ray>> {
    let [low, high] = surface.bounds();
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    let reach = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let mut rng = Rng::new(271);
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let from: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
        let length = from.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(0.1..1.0).contains(&length) {
            continue;
        }
        let single = |x: f64| f64::from(x as f32);
        let origin: [f64; 3] = std::array::from_fn(|axis| single(middle[axis] + 2.0 * reach * from[axis] / length));
        let direction: [f64; 3] = std::array::from_fn(|axis| single(rng.uniform(low[axis], high[axis]) - origin[axis]));
        rays.push(Ray::new(origin, direction)?);
    }
    Ok(rays)
}

type Hits = Vec<Option<f64>>;

/// Returns the first hit of each ray, and the time per ray in seconds.
fn cast_all(repeats: usize, rays: usize, cast: impl Fn() -> Hits) -> Result<(Hits, Samples)> {
    let mut hits = cast();
    let seconds = Samples::take(repeats, || {
        let (seconds, found) = timed(&cast);
        hits = found;
        anyhow::Ok(seconds / rays.max(1) as f64)
    })?;
    Ok((hits, seconds))
}

fn first_hit(tree: &CwBvh, triangles: &[Triangle], ray: &Ray) -> Option<f64> {
    let [origin, direction] = [ray.origin(), ray.direction()].map(|v| Vec3A::from_array(v.map(|x| x as f32)));
    let mut hit = RayHit::none();
    let meets = tree.ray_traverse(obvhs::ray::Ray::new_inf(origin, direction), &mut hit, |ray, at| {
        triangles[tree.primitive_indices[at] as usize].intersect(ray)
    });
    meets.then_some(f64::from(hit.t))
}

/// Returns the number of rays whose hits differ by more than single precision explains, or of which
/// only one hits.
fn differing(found: &Hits, truth: &Hits) -> usize {
    let alike = |(found, truth): &(&Option<f64>, &Option<f64>)| match (found, truth) {
        (Some(found), Some(truth)) => (found - truth).abs() <= 1e-4 * truth,
        (None, None) => true,
        _ => false,
    };
    found.iter().zip(truth).filter(|pair| !alike(pair)).count()
}

fn row<const N: usize>(name: String, builds: [&Samples; N], ray: &Samples, hits: &Hits, truth: &Hits) -> [String; 8] {
    let [build_min, build_median] = spread(builds[0]);
    let binary = builds.get(1).map_or_else(String::new, |binary| time(binary.min()));
    let [ray_min, ray_median] = spread(ray);
    let hit = hits.iter().flatten().count().to_string();
    [name, build_min, build_median, binary, ray_min, ray_median, hit, differing(hits, truth).to_string()]
}
