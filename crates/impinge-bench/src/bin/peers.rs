//! impinge and parry3d in one run on one thread: build, all intersecting pairs and first hit.
//!
//! `cargo run --release -p impinge-bench --features peers --bin peers`
//!
//! parry3d computes in single precision, so both get vertices and a pose rounded to it beforehand:
//! the same floats. Its first hit is its own `intersection_test`. It has no call for all pairs.
//! They are found as at the start of its `intersect_meshes`, by a descent of both trees with
//! `Bvh::leaf_pairs` whose boxes are moved by the pose, and decided by the test of two triangles at
//! the end of its `intersection_test`. That is GJK, by iteration in single precision, so a second
//! table counts the differences from the exact pairs.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use impinge::mesh::Options;
use impinge::{Pose, Positions};
use impinge_bench::questions::{Asked, ask, ask_impinge};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::{Choice, Standing, Surface};
use impinge_bench::table::{Table, spread};
use parry3d::bounding_volume::BoundingVolume;
use parry3d::math::{Matrix, Pose as ParryPose, Rotation, Vector};
use parry3d::partitioning::BvhNode;
use parry3d::query::details::intersection_test_support_map_support_map;
use parry3d::query::intersection_test;
use parry3d::shape::TriMesh;

/// Times impinge and parry3d on the same floats, and compares their answers.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    mesh: Choice,
    /// Number of runs of each query, and of the build
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<()> {
    let Arguments { mesh: choice, repeats } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let surface = rounded(choice.surface()?);
    let (mesh, build) = surface.build(repeats)?;
    let (parry_mesh, parry_build) = build_parry(&surface, repeats)?;

    println!("{} triangles", mesh.faces().len());
    let mut times = Table::new(["", "minimum", "median", "parry3d minimum", "parry3d median", "ratio of medians"]);
    let mut answers = Table::new(["pose", "pairs", "parry3d pairs", "parry3d wrong", "parry3d missing"]);
    times.row(times_beside("build".to_owned(), &build, &parry_build));
    for standing in Standing::named()? {
        let name = standing.name;
        let (ours, theirs) = same_pose(&standing.world_from_b)?;
        let asked = ask_impinge(repeats, (&mesh).into(), mesh.at(ours), &Options::default())
            .with_context(|| format!("impinge, pose {name}"))?;
        let parry = ask_parry(repeats, &parry_mesh, &theirs).with_context(|| format!("parry3d, pose {name}"))?;
        ensure!(asked.pairs.is_empty() == parry.pairs.is_empty(), "pose {name}: one finds pairs and the other none");
        times.row(times_beside(format!("{name}, all pairs"), &asked.all_pairs, &parry.all_pairs));
        times.row(times_beside(format!("{name}, first hit"), &asked.first_hit, &parry.first_hit));
        answers.row(answers_beside(name, &asked.pairs, &parry.pairs));
    }
    print!("{times}\n{answers}");
    let context = format!("{} triangles", mesh.faces().len());
    times.record(&context, 1)?;
    answers.record(&context, 1)
}

/// Returns cells with our times, their times, and the ratio of the medians.
fn times_beside(what: String, ours: &Samples, theirs: &Samples) -> [String; 6] {
    let [min, median] = spread(ours);
    let [parry_min, parry_median] = spread(theirs);
    [what, min, median, parry_min, parry_median, format!("{:.2}", theirs.median() / ours.median())]
}

/// Returns cells with the number of pairs, the number that parry3d finds, and its numbers of wrong
/// and of missing pairs.
fn answers_beside(pose: &str, ours: &[[u32; 2]], theirs: &[[u32; 2]]) -> [String; 5] {
    let absent =
        |from: &[[u32; 2]], of: &[[u32; 2]]| of.iter().filter(|pair| from.binary_search(pair).is_err()).count();
    let [pairs, parry_pairs, wrong, missing] =
        [ours.len(), theirs.len(), absent(ours, theirs), absent(theirs, ours)].map(|count| count.to_string());
    [pose.to_owned(), pairs, parry_pairs, wrong, missing]
}

/// Returns the surface with every coordinate rounded to single precision.
fn rounded(surface: Surface) -> Surface {
    let positions = match surface.positions {
        Positions::F64(vertices) => Positions::F32(vertices.into_iter().map(|v| v.map(|x| x as f32)).collect()),
        kept => kept,
    };
    Surface { positions, ..surface }
}

/// Returns the nearest pose whose quaternion and translation are in single precision, for each
/// engine.
fn same_pose(pose: &Pose) -> Result<(Pose, ParryPose)> {
    let columns = std::array::from_fn(|column| pose.linear().map(|row| row[column] as f32));
    let rotation = Rotation::from_mat3(&Matrix::from_cols_array_2d(&columns));
    let translation = pose.translation().map(|x| x as f32);
    let [x, y, z, w] = rotation.to_array().map(f64::from);
    let ours = Pose::from_quaternion_wxyz(translation.map(f64::from), [w, x, y, z])?;
    Ok((ours, ParryPose::from_parts(Vector::from_array(translation), rotation)))
}

/// Does the same as [`Surface::build`], for the mesh of parry3d.
fn build_parry(surface: &Surface, repeats: usize) -> Result<(TriMesh, Samples)> {
    let vertices: Vec<Vector> = (0..surface.positions.len())
        .map(|vertex| Vector::from_array(surface.positions.get(vertex).map(|x| x as f32)))
        .collect();
    let mut mesh = None;
    let samples = Samples::take(repeats, || {
        drop(mesh.take());
        let (vertices, faces) = (vertices.clone(), surface.faces.clone());
        let (seconds, built) = timed(|| TriMesh::new(vertices, faces));
        mesh = Some(built?);
        anyhow::Ok(seconds)
    })?;
    Ok((mesh.context("no build was asked for")?, samples))
}

fn ask_parry(repeats: usize, mesh: &TriMesh, world_from_b: &ParryPose) -> Result<Asked> {
    let meets = || intersection_test(&ParryPose::IDENTITY, mesh, black_box(world_from_b), mesh);
    meets()?; // parry3d rejects pairs of shapes by their kinds only, so later calls succeed
    ask(
        repeats,
        || parry_pairs(black_box(mesh), black_box(world_from_b)),
        || meets().is_ok_and(|answer| answer.intersecting),
    )
}

/// Returns every pair of faces of a mesh and its moved copy that intersects according to parry3d,
/// sorted like ours.
fn parry_pairs(mesh: &TriMesh, a_from_b: &ParryPose) -> Vec<[u32; 2]> {
    let overlap = |a: &BvhNode, b: &BvhNode| a.aabb().intersects(&b.aabb().transform_by(a_from_b));
    let mut pairs: Vec<[u32; 2]> = mesh
        .bvh()
        .leaf_pairs(mesh.bvh(), overlap)
        .filter(|&(a, b)| intersection_test_support_map_support_map(a_from_b, &mesh.triangle(a), &mesh.triangle(b)))
        .map(|(a, b)| [a, b])
        .collect();
    pairs.sort_unstable();
    pairs
}
