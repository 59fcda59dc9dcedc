//! Hulls of many points: hostile sets, and meshes.

use std::time::Instant;

use impinge::hull::{Hull, HullKind};
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::generate::{Rng, cos, sin};

use crate::hull::oracle::orientation_of_doubles;
use crate::hull::surface;

/// Returns the hull after checking its surface, and that every `stride`-th point is inside.
fn assert_holds(points: &[[f64; 3]], stride: usize) -> Hull {
    let hull = Hull::new(points).expect("legal");
    surface::check(&hull, points.iter().copied().step_by(stride), orientation_of_doubles);
    hull
}

#[test]
fn hulls_contain_every_point_of_a_cloud() {
    let mut rng = Rng::new(41);
    let mut cloud = |count: usize| -> Vec<[f64; 3]> {
        (0..count).map(|_| std::array::from_fn(|_| rng.uniform(-1.0, 1.0))).collect()
    };
    let hull = assert_holds(&cloud(30_000), 1);
    assert!((100..600).contains(&hull.vertices().len()), "{}", hull.vertices().len());
    // Points around a corner and along a line, for which boxes and cells cull little; and points
    // far from the origin.
    let skewed: Vec<_> = cloud(20_000).iter().map(|[x, y, z]| [x * x * x, x * x * x + 1e-3 * y, 1e-9 * z]).collect();
    assert_holds(&skewed, 7);
    let far: Vec<_> = cloud(20_000).iter().map(|p| p.map(|x| 1e7 + x)).collect();
    assert_holds(&far, 7);
    // One far outlier.
    let mut lonely = cloud(5000);
    lonely.push([1e12, -1e11, 3.0]);
    assert_holds(&lonely, 3);
}

/// Checks lattices, whose faces contain most of their points, and sheared lattices.
#[test]
fn only_the_corners_of_a_lattice_are_vertices() {
    let side = 24;
    let lattice: Vec<[f64; 3]> =
        (0..side * side * side).map(|i| [i % side, i / side % side, i / side / side].map(f64::from)).collect();
    let hull = assert_holds(&lattice, 11);
    assert_eq!(hull.vertices().len(), 8);
    let sheared: Vec<_> = lattice.iter().map(|[x, y, z]| [x + 0.5 * y, y - 0.25 * z, z + x]).collect();
    assert_eq!(assert_holds(&sheared, 11).vertices().len(), 8);
    // Flat and straight lattices, with every point many times.
    let flat: Vec<_> = lattice.iter().map(|[x, y, _]| [*x, *y, x + y]).collect();
    let hull = assert_holds(&flat, 11);
    assert_eq!((hull.kind(), hull.vertices().len()), (HullKind::Polygon, 4));
    let straight: Vec<_> = lattice.iter().map(|[x, ..]| [*x, 2.0 * x, -x]).collect();
    assert_eq!(assert_holds(&straight, 11).kind(), HullKind::Segment);
}

/// Checks integer points on a sphere. All are vertices, in facets of many corners.
#[test]
fn cospherical_points_are_all_vertices() {
    let squared = 2 * 3 * 5 * 7 * 11 * 13; // has many sums of three squares
    let root = 173;
    let mut points = Vec::new();
    for x in -root..=root {
        for y in -root..=root {
            let rest: i32 = squared - x * x - y * y;
            let z = f64::from(rest.max(0)).sqrt() as i32;
            if rest >= 0 && z * z == rest {
                points.extend([[x, y, z], [x, y, -z]].map(|p| p.map(f64::from)));
            }
        }
    }
    let hull = assert_holds(&points, 1);
    points.sort_unstable_by(|p, q| p.partial_cmp(q).expect("finite"));
    points.dedup();
    assert_eq!(hull.vertices().len(), points.len());
    assert!(points.len() > 500, "{}", points.len());
}

/// Checks sets that take quadratic time if faces are tried one by one, or if points are added in
/// their order.
///
/// They are a cone whose tip sees the whole rim, two skew curves with an edge between every two
/// points, a spiral, and points sorted along a sphere.
#[test]
fn hostile_sets_take_no_quadratic_time() {
    let count = 20_000;
    let share = |i: i32| f64::from(i) / f64::from(count);
    let turn = |i: i32| share(i) * std::f64::consts::TAU;
    let mut rng = Rng::new(43);
    let cone: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let height = if i % 2 == 0 { 0.0 } else { 0.999 * rng.unit() };
            [(1.0 - height) * cos(turn(i)), (1.0 - height) * sin(turn(i)), height]
        })
        .chain([[0.0, 0.0, 1.0]])
        .collect();
    let crossed: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let x = share(i) - 0.5;
            if i % 2 == 0 { [x, x * x, 0.0] } else { [0.0, -x * x, x] }
        })
        .collect();
    let spiral: Vec<[f64; 3]> = (0..count)
        .map(|i| [cos(99.0 * turn(i)), sin(99.0 * turn(i)), share(i)].map(|x| x * (1.0 + share(i))))
        .collect();
    let sphere: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let (z, angle) = (2.0 * share(i) - 1.0, 1e4 * turn(i));
            let radius = (1.0 - z * z).sqrt();
            [radius * cos(angle), radius * sin(angle), z]
        })
        .collect();
    for points in [cone, crossed, spiral, sphere] {
        let start = Instant::now();
        let hull = Hull::new(&points).expect("legal");
        // Each takes about 50 ms. 20,000 squared would take minutes.
        assert!(start.elapsed().as_secs() < 10);
        surface::check(&hull, points.iter().copied().step_by(4001), orientation_of_doubles);
    }
}

#[test]
fn the_hull_of_a_knot_contains_its_vertices() {
    let knot = torus_knot(600, 150, TREFOIL);
    let hull = assert_holds(&knot.vertices, 29);
    let single: Vec<[f32; 3]> = knot.vertices.iter().map(|p| p.map(|x| x as f32)).collect();
    let of_single = Hull::new(&single).expect("legal");
    let widened: Vec<[f64; 3]> = single.iter().map(|p| p.map(f64::from)).collect();
    assert_eq!(of_single.vertices(), Hull::new(&widened).expect("legal").vertices());
    assert!(hull.vertices().len() > 1000);
}
