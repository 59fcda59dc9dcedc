//! Shapes against shapes in impinge and parry3d, pair by pair, in one run on one thread; and two
//! spheres of triangles in light contact.
//!
//! `cargo run --release -p impinge-bench --features peers --bin shapes`
//!
//! parry3d computes in single precision, so both get numbers that it holds. For each query both get
//! a new pose of the second shape, which for impinge includes its bounding box. impinge's answers
//! must be consistent. If parry3d's distance is farther from the proved interval than single
//! precision explains, it is counted.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;
use std::sync::Arc;

use anyhow::{Result, ensure};
use clap::Parser;
use impinge::hull::Hull;
use impinge::query;
use impinge::shape::{PlacedShape, Shape};
use impinge::{Mesh, Pose, Positions};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::{Rng, poses, solids};
use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::query as parry;
use parry3d::shape::{Ball, Capsule, Cone, ConvexPolyhedron, Cuboid, Cylinder, Shape as ParryShape, Triangle};

/// Maximum deviation from the proved interval that single precision explains, for sizes of about 1.
const OFF: f64 = 1e-3;

/// Times every pair of kinds of shapes, and two spheres of triangles
#[derive(Parser)]
struct Arguments {
    /// Number of runs of each query; the minimum time is printed
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
    /// Number of poses of each pair of kinds
    #[arg(long, value_name = "N", default_value_t = 500)]
    poses: usize,
}

/// Shape for both engines. parry3d's axis is y and impinge's is z, so some shapes must be turned.
struct Kind {
    name: &'static str,
    ours: Shape,
    theirs: Box<dyn ParryShape>,
    is_about_y: bool,
}

fn main() -> Result<()> {
    let Arguments { repeats, poses } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let kinds = kinds()?;
    let mut table = Table::new([
        "",
        "intersects",
        "parry3d intersects",
        "distance",
        "parry3d distance",
        "depth",
        "parry3d depth",
        "parry3d off",
        "intersecting",
    ]);
    for (number, a) in kinds.iter().enumerate() {
        for b in &kinds[number..] {
            table.row(pair(a, b, poses, repeats)?);
        }
    }
    let spheres = spheres(repeats)?;
    print!("{table}\n{spheres}");
    table.record("", 1)?;
    spheres.record("spheres of 20480", 1)
}

fn kinds() -> Result<Vec<Kind>> {
    let mut rng = Rng::new(7);
    let points: Vec<[f64; 3]> =
        (0..32).map(|_| std::array::from_fn(|_| f64::from(rng.uniform(-0.5, 0.5) as f32))).collect();
    let vector = |p: &[f64; 3]| Vector::from_array(p.map(|x| x as f32));
    let polyhedron = ConvexPolyhedron::from_convex_hull(&points.iter().map(vector).collect::<Vec<_>>());
    let ends = [[-0.25, 0.0, 0.0], [0.25, 0.0, 0.0]];
    let corners = [[-0.5, -0.25, 0.0], [0.5, -0.25, 0.125], [0.0, 0.5, 0.0]];
    let capsule = Capsule::new(vector(&ends[0]), vector(&ends[1]), 0.25);
    let triangle = Triangle::new(vector(&corners[0]), vector(&corners[1]), vector(&corners[2]));
    let mut kinds: Vec<Kind> = Vec::new();
    let mut add =
        |name, ours, theirs: Box<dyn ParryShape>, is_about_y| kinds.push(Kind { name, ours, theirs, is_about_y });
    add("sphere", Shape::sphere([0.0; 3], 0.5)?, Box::new(Ball::new(0.5)), false);
    add("capsule", Shape::capsule(ends[0], ends[1], 0.25)?, Box::new(capsule), false);
    let half = [0.5, 0.375, 0.25];
    add("box", Shape::cuboid(half)?, Box::new(Cuboid::new(vector(&half))), false);
    add("cylinder", Shape::cylinder(0.5, 0.375)?, Box::new(Cylinder::new(0.5, 0.375)), true);
    add("cone", Shape::cone(0.5, 0.375)?, Box::new(Cone::new(0.5, 0.375)), true);
    let hull = Shape::hull(Arc::new(Hull::new(&points)?));
    add("hull of 32", hull, Box::new(polyhedron.ok_or_else(|| anyhow::anyhow!("parry3d makes no hull"))?), false);
    add("triangle", Shape::triangle(corners)?, Box::new(triangle), false);
    Ok(kinds)
}

/// Returns poses of the second shape for both engines.
fn places(count: usize) -> Result<Vec<(Pose, ParryPose)>> {
    let mut rng = Rng::new(11);
    let mut place = || {
        let turn = poses::rotation(&mut rng);
        let columns = std::array::from_fn(|column| turn.linear.map(|row| row[column] as f32));
        let rotation = Rotation::from_mat3(&parry3d::math::Matrix::from_cols_array_2d(&columns));
        // Half of the shapes, of size about 1, intersect at these distances.
        let translation: [f32; 3] = std::array::from_fn(|_| rng.uniform(-0.75, 0.75) as f32);
        let [x, y, z, w] = rotation.to_array().map(f64::from);
        let ours = Pose::from_quaternion_wxyz(translation.map(f64::from), [w, x, y, z])?;
        Ok((ours, ParryPose::from_parts(Vector::from_array(translation), rotation)))
    };
    (0..count).map(|_| place()).collect()
}

/// Returns the minimum time per query over all poses, in seconds.
fn quickest<T>(repeats: usize, places: &[(Pose, ParryPose)], ask: impl Fn(&(Pose, ParryPose)) -> T) -> f64 {
    let run = || anyhow::Ok(timed(|| places.iter().for_each(|place| _ = black_box(ask(black_box(place))))).0);
    Samples::take(repeats, run).map_or(f64::NAN, |samples| samples.min() / places.len() as f64)
}

fn pair(a: &Kind, b: &Kind, count: usize, repeats: usize) -> Result<[String; 9]> {
    let places = places(count)?;
    let first = a.ours.at(Pose::IDENTITY)?;
    let second = |place: &(Pose, ParryPose)| b.ours.at(place.0).expect("a rigid pose");
    // Maps the z axis to the y axis.
    let upright = ParryPose::from_parts(Vector::ZERO, Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2));
    let turned = |kind: &Kind, pose: ParryPose| if kind.is_about_y { pose * upright } else { pose };
    let here = turned(a, ParryPose::IDENTITY);
    let (shape_a, shape_b) = (&*a.theirs, &*b.theirs);
    let there = |place: &(Pose, ParryPose)| turned(b, place.1);
    let (mut off, mut meeting) = (0, 0);
    for place in &places {
        let other: PlacedShape = second(place);
        let distance = query::distance(&first, &other);
        let meets = query::intersects(&first, &other);
        let depth = query::penetration(&first, &other);
        ensure!(distance.lower <= distance.upper && meets == (distance.distance() == 0.0), "{distance:?}");
        ensure!(depth.is_some() == meets && depth.is_none_or(|depth| depth.lower <= depth.upper), "{depth:?}");
        let theirs = f64::from(parry::distance(&here, shape_a, &there(place), shape_b)?.distance);
        off += usize::from(!(distance.lower - OFF..=distance.upper + OFF).contains(&theirs));
        meeting += usize::from(meets);
    }
    let ours = [
        quickest(repeats, &places, |place| query::intersects(&first, second(place))),
        quickest(repeats, &places, |place| query::distance(&first, second(place)).upper),
        quickest(repeats, &places, |place| query::penetration(&first, second(place))),
    ];
    let theirs = [
        quickest(repeats, &places, |place| parry::intersection_test(&here, shape_a, &there(place), shape_b).is_ok()),
        quickest(repeats, &places, |place| parry::distance(&here, shape_a, &there(place), shape_b).is_ok()),
        quickest(repeats, &places, |place| parry::contact(&here, shape_a, &there(place), shape_b, 0.0).is_ok()),
    ];
    let share = |part: usize| format!("{:.1} %", 100.0 * part as f64 / count as f64);
    let [meet, distance, depth] = ours.map(time);
    let [their_meet, their_distance, their_depth] = theirs.map(time);
    let name = format!("{}, {}", a.name, b.name);
    Ok([name, meet, their_meet, distance, their_distance, depth, their_depth, share(off), share(meeting)])
}

/// Times two spheres of 20,480 triangles at increasing depth.
fn spheres(repeats: usize) -> Result<Table<7>> {
    let sphere = solids::icosphere(5);
    let sphere = Mesh::new(Positions::F64(sphere.vertices), sphere.faces)?;
    let headings = ["spheres of 20,480", "pairs", "pairs in", "patches", "contacts", "penetration", "depth"];
    let mut table = Table::new(headings);
    for overlap in [0.005, 0.02, 0.1, 0.5] {
        let away = 2.0 - overlap;
        let pose = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [0.6 * away, 0.48 * away, 0.64 * away])?;
        let (a, b) = (Shape::solid(&sphere).at(Pose::IDENTITY)?, Shape::solid(&sphere).at(pose)?);
        let least = |run: &dyn Fn()| Samples::take(repeats, || anyhow::Ok(timed(run).0)).map(|samples| samples.min());
        let pairs = query::intersecting_pairs(&sphere, sphere.at(pose)).len();
        let patches = query::contact_patches(&sphere, sphere.at(pose));
        let contacts = query::contacts(&a, &b);
        let deepest =
            contacts.iter().flat_map(|manifold| &manifold.points).map(|point| point.upper).fold(0.0, f64::max);
        ensure!(
            patches.len() == 1 && (deepest - overlap).abs() < 5e-3,
            "expected one region {overlap} deep, not {} and {deepest}",
            patches.len()
        );
        let depth = query::penetration(&sphere, sphere.at(pose)).ok_or_else(|| anyhow::anyhow!("they meet"))?;
        ensure!(depth.lower <= depth.upper && (depth.upper - overlap).abs() < 1e-3, "{depth:?}");
        table.row([
            format!("{overlap} deep"),
            pairs.to_string(),
            time(least(&|| _ = black_box(query::intersecting_pairs(&sphere, sphere.at(pose))))?),
            time(least(&|| _ = black_box(query::contact_patches(&sphere, sphere.at(pose))))?),
            time(least(&|| _ = black_box(query::contacts(&a, &b)))?),
            time(least(&|| _ = black_box(query::penetration(&sphere, sphere.at(pose))))?),
            format!("{:.6} to {:.6}", depth.lower, depth.upper),
        ]);
    }
    Ok(table)
}
