//! Fits every kind of volume to a mesh and times it.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use impinge::hull::{Hull, HullKind};
use impinge::query;
use impinge::shape::Shape;
use impinge::volume::fit::{self, FittedSphere};
use impinge::volume::{
    BoundingSphere, BoundingVolume, Capsule, CenterRadius, Kdop14, Kdop18, Kdop26, Lozenge, MinMax, MinWidths, Obb,
    PackedCenterRadius, PackedMinWidths, Steps,
};
use impinge::{InputError, Pose};

/// Measurements of one volume.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Kind of the volume, and how it was fitted, such as `sphere, minimal`.
    pub(super) name: &'static str,
    pub(super) bytes: usize,
    /// Volume, in cubic units of the mesh.
    pub(super) volume: f64,
    /// Surface area, in square units of the mesh.
    pub(super) surface_area: f64,
    /// Radius, for spheres only.
    pub(super) radius: Option<f64>,
    /// Time to fit the volume to the points, in seconds.
    pub(super) build: f64,
    /// Time of one overlap test, in seconds, averaged over pairs of which some overlap.
    pub(super) overlap: f64,
    /// Time to compute the volume of the rotated mesh from the volume of the mesh, in seconds.
    pub(super) follow: f64,
}

/// Measurements of the convex hull, the reference for all sizes.
#[derive(Clone, Debug)]
pub(super) struct HullRow {
    pub(super) vertices: usize,
    pub(super) bytes: usize,
    /// Volume, in cubic units of the mesh; zero if the hull is flat.
    pub(super) volume: f64,
    /// Surface area, in square units of the mesh.
    pub(super) surface_area: f64,
    /// Time to build the hull, in seconds.
    pub(super) build: f64,
    /// Time of one exact test of two posed hulls, in seconds, averaged over pairs of which some
    /// overlap.
    pub(super) overlap: f64,
    /// Time to pose the hull, in seconds. Its corners are not transformed.
    pub(super) follow: f64,
}

/// Number of poses that each volume is moved to. All volumes use the same poses.
const POSES: usize = 64;

/// Number of times that each batch is timed. The minimum is kept, because it is the least
/// disturbed.
const REPEATS: usize = 7;

/// Operations to time for one kind of volume.
struct Kind<'a, V> {
    name: &'static str,
    build: &'a dyn Fn() -> Result<V, InputError>,
    overlap: fn(&V, &V) -> bool,
    follow: fn(&V, &Pose) -> Result<V, InputError>,
    measures: fn(&V) -> [f64; 2],
}

/// Fits every kind of volume to the points and measures it.
///
/// # Errors
/// Returns an error if a point is out of range.
pub(super) fn rows(points: &[[f64; 3]]) -> Result<Vec<Row>, InputError> {
    let bounds = MinMax::of(points)?;
    let poses = poses(&bounds);
    let mut rows = vec![
        plain::<MinMax>("box, min-max", &poses, &|| MinMax::of(points))?,
        plain::<MinWidths>("box, min-widths", &poses, &|| MinWidths::of_points(points))?,
        plain::<CenterRadius>("box, centre-radius", &poses, &|| CenterRadius::of_points(points))?,
    ];
    rows.extend(packed(points, &poses));
    type Construct = fn(&[[f64; 3]]) -> Result<FittedSphere, InputError>;
    let spheres: [(&'static str, Construct); 6] = [
        ("sphere, mean", fit::mean_sphere),
        ("sphere, box centre", fit::box_sphere),
        ("sphere, Ritter", fit::ritter_sphere),
        ("sphere, PCA", fit::principal_sphere),
        ("sphere, refined", fit::refined_sphere),
        ("sphere, minimal", fit::minimal_sphere),
    ];
    for (name, construct) in spheres {
        let build = || construct(points).map(|fitted| fitted.sphere);
        let row = plain::<BoundingSphere>(name, &poses, &build)?;
        rows.push(Row { radius: Some(build()?.radius()), ..row });
    }
    rows.push(plain::<Capsule>("capsule", &poses, &|| fit::capsule(points))?);
    rows.push(plain::<Lozenge>("lozenge", &poses, &|| fit::lozenge(points))?);
    rows.push(plain::<Obb>("oriented box, PCA", &poses, &|| fit::principal_obb(points))?);
    rows.push(plain::<Obb>("oriented box", &poses, &|| fit::obb(points).map(|fitted| fitted.obb))?);
    rows.push(plain::<Kdop14>("14-DOP", &poses, &|| Kdop14::of(points))?);
    rows.push(plain::<Kdop18>("18-DOP", &poses, &|| Kdop18::of(points))?);
    rows.push(plain::<Kdop26>("26-DOP", &poses, &|| Kdop26::of(points))?);
    Ok(rows)
}

/// Builds the convex hull of the points and measures it.
///
/// # Errors
/// Returns an error if a point is out of range.
pub(super) fn hull(points: &[[f64; 3]]) -> Result<HullRow, InputError> {
    /// Number of poses used for overlap tests. Few are enough: a test of two hulls takes about a
    /// thousand times as long as a test of two boxes.
    const TESTED_POSES: usize = 8;
    let (hull, build) = timed_build(&|| Hull::new(points).map(Arc::new))?;
    let poses = poses(&MinMax::of(points)?);
    let shape = Shape::hull(Arc::clone(&hull));
    let placed = poses.spread.iter().take(TESTED_POSES).map(|&pose| shape.at(pose)).collect::<Result<Vec<_>, _>>()?;
    let overlap = overlap_time(&placed, |a, b| query::intersects(a, b));
    let follow = follow_time(&poses, |pose| shape.at(*pose));
    let (mut six_volumes, mut two_areas) = (0.0, 0.0);
    // Measure from a point of the hull: far from the origin, the terms of the sum would cancel.
    let origin = points[hull.vertices()[0] as usize];
    for face in hull.faces() {
        let [a, b, c] = face.map(|vertex| {
            let corner = hull.positions()[vertex as usize];
            std::array::from_fn::<f64, 3, _>(|axis| corner[axis] - origin[axis])
        });
        let edge = |to: [f64; 3]| std::array::from_fn::<f64, 3, _>(|axis| to[axis] - a[axis]);
        let normal = cross(edge(b), edge(c));
        six_volumes += (0..3).map(|axis| a[axis] * normal[axis]).sum::<f64>();
        two_areas += normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    }
    // A flat hull has no volume, regardless of rounding errors.
    let volume = if hull.kind() == HullKind::Solid { (six_volumes / 6.0).max(0.0) } else { 0.0 };
    let vertices = hull.vertices().len();
    Ok(HullRow { vertices, bytes: hull.memory(), volume, surface_area: 0.5 * two_areas, build, overlap, follow })
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Measures a kind of volume that implements [`BoundingVolume`].
fn plain<V: BoundingVolume>(
    name: &'static str,
    poses: &Poses,
    build: &dyn Fn() -> Result<V, InputError>,
) -> Result<Row, InputError> {
    let measures = |volume: &V| [volume.volume(), volume.surface_area()];
    measure(&Kind { name, build, overlap: V::overlaps, follow: V::moved, measures }, poses)
}

/// Measures the packed boxes. Leaves out boxes that exceed the range of single precision.
fn packed(points: &[[f64; 3]], poses: &Poses) -> Vec<Row> {
    fn widths<T: Steps>(name: &'static str, points: &[[f64; 3]], poses: &Poses) -> Result<Row, InputError> {
        measure::<PackedMinWidths<T>>(
            &Kind {
                name,
                build: &|| MinWidths::of_points(points)?.try_into(),
                overlap: PackedMinWidths::overlaps,
                follow: |packed, pose| MinWidths::from(*packed).moved(pose)?.try_into(),
                measures: |packed| [packed.volume(), MinWidths::from(*packed).surface_area()],
            },
            poses,
        )
    }
    fn radii<T: Steps>(name: &'static str, points: &[[f64; 3]], poses: &Poses) -> Result<Row, InputError> {
        measure::<PackedCenterRadius<T>>(
            &Kind {
                name,
                build: &|| CenterRadius::of_points(points)?.try_into(),
                overlap: PackedCenterRadius::overlaps,
                follow: |packed, pose| CenterRadius::from(*packed).moved(pose)?.try_into(),
                measures: |packed| [packed.volume(), CenterRadius::from(*packed).surface_area()],
            },
            poses,
        )
    }
    let rows = [
        widths::<u16>("box, min-widths u16", points, poses),
        widths::<u8>("box, min-widths u8", points, poses),
        radii::<u16>("box, centre-radius u16", points, poses),
        radii::<u8>("box, centre-radius u8", points, poses),
    ];
    rows.into_iter().flatten().collect()
}

fn measure<V: Clone>(kind: &Kind<V>, poses: &Poses) -> Result<Row, InputError> {
    let (volume, build) = timed_build(kind.build)?;
    let moved: Vec<V> = poses.spread.iter().map(|pose| (kind.follow)(&volume, pose)).collect::<Result<_, _>>()?;
    let overlap = overlap_time(&moved, kind.overlap);
    let follow = follow_time(poses, |pose| (kind.follow)(&volume, pose));
    let [cubic, square] = (kind.measures)(&volume);
    let bytes = size_of::<V>();
    Ok(Row { name: kind.name, bytes, volume: cubic, surface_area: square, radius: None, build, overlap, follow })
}

/// Returns the time of one overlap test, in seconds, averaged over all pairs.
fn overlap_time<V>(moved: &[V], overlap: impl Fn(&V, &V) -> bool) -> f64 {
    min_time(moved.len() * moved.len(), || {
        let mut overlapping = 0_usize;
        for a in moved {
            for b in moved {
                overlapping += usize::from(overlap(black_box(a), b));
            }
        }
        black_box(overlapping);
    })
}

/// Returns the time to follow one rotation, in seconds.
fn follow_time<V>(poses: &Poses, follow: impl Fn(&Pose) -> Result<V, InputError>) -> f64 {
    min_time(poses.turning.len(), || {
        for pose in &poses.turning {
            // The same rotations succeeded before. Even a failure would cost as much.
            let _ = black_box(follow(black_box(pose)));
        }
    })
}

/// Builds a volume several times, or once if that takes long. Returns the volume and the minimum
/// time, in seconds.
fn timed_build<V>(build: &dyn Fn() -> Result<V, InputError>) -> Result<(V, f64), InputError> {
    /// Seconds after which building is not repeated.
    const TIME_BUDGET: f64 = 0.1;
    let mut best = f64::INFINITY;
    let mut spent = 0.0;
    loop {
        let start = Instant::now();
        let volume = build()?;
        let seconds = start.elapsed().as_secs_f64();
        best = best.min(seconds);
        spent += seconds;
        if spent > TIME_BUDGET || spent / best > 20.0 {
            return Ok((volume, best));
        }
    }
}

/// Runs `work`, which processes `count` items, several times. Returns the minimum time per item, in
/// seconds.
fn min_time(count: usize, work: impl Fn()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..REPEATS).map(time).fold(f64::INFINITY, f64::min) / count as f64
}

/// Rotations about the origin, and the same rotations with translations chosen so that some of the
/// moved volumes overlap.
struct Poses {
    turning: Vec<Pose>,
    spread: Vec<Pose>,
}

fn poses(bounds: &MinMax) -> Poses {
    let (min, max) = (bounds.min(), bounds.max());
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
    let extent = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
    // Knuth's linear congruential generator (MMIX). Any spread of directions will do, but it must
    // be the same each time.
    let mut state = 1_u64;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let (mut turning, mut spread) = (Vec::new(), Vec::new());
    while turning.len() < POSES {
        let quaternion: [f64; 4] = std::array::from_fn(|_| number());
        let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        let turn = Pose::from_quaternion_wxyz([0.0; 3], quaternion.map(|x| x / length));
        let shift: [f64; 3] = std::array::from_fn(|_| 1.5 * extent * number());
        // Rotate about the center of the mesh, so that moved copies lie side by side even far from
        // the origin.
        let Ok(turn) = turn else { continue };
        let there = turn.apply(middle);
        let translation = std::array::from_fn(|axis| middle[axis] - there[axis] + shift[axis]);
        if let Ok(pose) = Pose::new(*turn.linear(), translation) {
            turning.push(turn);
            spread.push(pose);
        }
    }
    Poses { turning, spread }
}
