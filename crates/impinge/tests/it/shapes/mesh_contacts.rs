//! Contacts of meshes whose contacts are known from the same scene made of boxes: crates on
//! platforms, in corners and on ridges.

use impinge::query::{self, ContactOptions, Manifold, Query};
use impinge::shape::{PlacedShape, Shape};
use impinge::{Mesh, Pose};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::{cuboid, plane_grid};

use crate::shapes::support::{at, dot, engine};

/// Returns the mesh of a box about the origin.
pub(super) fn box_mesh(half: [f64; 3]) -> Mesh {
    engine(&cuboid(half.map(|x| -x), half))
}

fn here(shape: &Shape) -> PlacedShape {
    shape.at(Pose::IDENTITY).unwrap()
}

fn there(shape: &Shape, translation: [f64; 3]) -> PlacedShape {
    shape.at(at(translation)).unwrap()
}

pub(super) fn deepest(manifold: &Manifold) -> f64 {
    manifold.points.iter().map(|point| point.upper).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the contacts within a margin of 0.02.
pub(super) fn nearby(a: &PlacedShape, b: &PlacedShape) -> Vec<Manifold> {
    Query::new().with_contacts(ContactOptions { margin: 0.02, ..Default::default() }).contacts(a, b)
}

/// Returns the one manifold, after checking its normal and its depth.
#[track_caller]
fn only(found: Vec<Manifold>, normal: [f64; 3], depth: f64) -> Manifold {
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(dot(&found[0].normal, &normal) > 1.0 - 1e-9, "{found:?}");
    assert!((deepest(&found[0]) - depth).abs() < 1e-9, "{found:?}");
    found.into_iter().next().unwrap()
}

/// Returns the area of the convex polygon of the second points of a manifold, seen along its
/// normal, by summing over all triangles of the fan in the order of their angle.
pub(super) fn area(manifold: &Manifold) -> f64 {
    let n = manifold.normal;
    let least = (0..3).min_by(|&i, &j| n[i].abs().total_cmp(&n[j].abs())).unwrap();
    let axis: [f64; 3] = std::array::from_fn(|k| f64::from(u8::from(k == least)) - n[k] * n[least]);
    let x = axis.map(|entry| entry / dot(&axis, &axis).sqrt());
    let y = [n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]];
    let flat: Vec<[f64; 2]> = manifold.points.iter().map(|p| [dot(&x, &p.point_b), dot(&y, &p.point_b)]).collect();
    let count = flat.len() as f64;
    let center = [0, 1].map(|k| flat.iter().map(|p| p[k]).sum::<f64>() / count);
    let mut around: Vec<[f64; 2]> = flat.iter().map(|p| [p[0] - center[0], p[1] - center[1]]).collect();
    around.sort_by(|p, q| p[1].atan2(p[0]).total_cmp(&q[1].atan2(q[0])));
    let next = |i: usize| around[(i + 1) % around.len()];
    (0..around.len()).map(|i| 0.5 * (around[i][0] * next(i)[1] - around[i][1] * next(i)[0])).sum::<f64>().abs()
}

#[test]
fn a_box_beside_a_mesh_cube_is_pushed_out_of_one_side() {
    let (cube, unit) = (box_mesh([0.5; 3]), Shape::cuboid([0.5; 3]).unwrap());
    for shape in [Shape::solid(&cube), Shape::mesh(&cube)] {
        only(query::contacts(here(&shape), there(&unit, [0.98, 0.0, 0.3])), [1.0, 0.0, 0.0], 0.02);
    }
}

#[test]
fn a_crate_over_the_edge_of_a_platform_is_only_lifted() {
    let (table, small) = (box_mesh([1.0, 1.0, 0.5]), box_mesh([0.3, 0.3, 0.9]));
    let crate_ = Shape::cuboid([0.3, 0.3, 0.9]).unwrap();
    let at = [-0.705, -0.2, 1.39];
    for platform in [Shape::solid(&table), Shape::mesh(&table), Shape::cuboid([1.0, 1.0, 0.5]).unwrap()] {
        for crate_ in [&crate_, &Shape::solid(&small), &Shape::cylinder(0.9, 0.3).unwrap()] {
            let found = query::contacts(here(&platform), there(crate_, at));
            let found = only(found, [0.0, 0.0, 1.0], 0.01);
            assert_eq!(found.points.len(), 4, "{platform:?} {crate_:?} {found:?}");
        }
    }
}

#[test]
fn a_thin_solid_plate_leaves_the_floor_upwards() {
    let corner = |i: usize| [[-5.0, 5.0][i & 1], [-5.0, 5.0][i >> 1 & 1], [-1.0, 0.0][i >> 2]];
    let hull = impinge::hull::Hull::new(&(0..8).map(corner).collect::<Vec<[f64; 3]>>()).unwrap();
    let floor = Shape::hull(std::sync::Arc::new(hull));
    let plate = Shape::solid(&box_mesh([0.5, 0.5, 0.005]));
    for sink in [0.009, 0.011, 0.02] {
        only(query::contacts(here(&floor), there(&plate, [0.0, 0.0, 0.005 - sink])), [0.0, 0.0, 1.0], sink);
    }
    let small = Shape::solid(&box_mesh([0.05; 3]));
    let found = query::contacts(here(&Shape::cuboid([0.5; 3]).unwrap()), there(&small, [0.4; 3]));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((deepest(&found[0]) - 0.15).abs() < 1e-9, "{found:?}");
}

#[test]
fn a_mesh_crate_half_over_the_edge_of_a_mesh_table_is_held() {
    let table = Shape::solid(&box_mesh([1.0, 1.0, 0.1]));
    for crate_ in [Shape::solid(&box_mesh([0.25; 3])), Shape::cuboid([0.25; 3]).unwrap()] {
        let found = query::contacts(here(&table), there(&crate_, [0.95, 0.1, 0.349]));
        let found = only(found, [0.0, 0.0, 1.0], 0.001);
        let xs = || found.points.iter().map(|point| point.point_a[0]);
        assert!((xs().fold(f64::INFINITY, f64::min) - 0.7).abs() < 1e-9, "{found:?}");
        assert!((xs().fold(f64::NEG_INFINITY, f64::max) - 1.0).abs() < 1e-9, "{found:?}");
    }
    let cube = Shape::solid(&box_mesh([0.5; 3]));
    for overlap in [0.001, 0.1, 0.3] {
        let found = query::contacts(here(&cube), there(&cube, [0.25, 0.25, 1.0 - overlap]));
        let found = only(found, [0.0, 0.0, 1.0], overlap);
        assert_eq!(found.points.len(), 4, "{found:?}");
    }
}

#[test]
fn mesh_cubes_with_flush_sides_have_the_depth_of_boxes() {
    let cube = Shape::solid(&box_mesh([0.4; 3]));
    for overlap in [1e-4, 1e-3, 1e-2] {
        for aside in [0.0, 1e-6] {
            let found = query::contacts(here(&cube), there(&cube, [0.42, aside, 0.8 - overlap]));
            let found = only(found, [0.0, 0.0, 1.0], overlap);
            assert_eq!(found.points.len(), 4, "{found:?}");
        }
    }
}

/// Checks a ball on a ridge that ends at a slope that rises: it touches both.
#[test]
fn a_ball_keeps_the_ridge_beside_a_slope() {
    let vertices = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, -0.5],
        [1.0, 1.0, -0.5],
        [0.0, -1.0, -0.5],
        [1.0, -1.0, -0.5],
        [2.0, -1.0, 0.5],
        [2.0, 1.0, 0.5],
    ];
    let faces = vec![[0, 1, 3], [0, 3, 2], [0, 5, 1], [0, 4, 5], [1, 6, 7]];
    let mesh = engine(&impinge_testkit::Mesh { vertices, faces });
    let ball = Shape::sphere([0.0; 3], 0.3).unwrap();
    for x in [0.89, 0.9, 0.91, 0.92] {
        let found = query::contacts(here(&Shape::mesh(&mesh)), there(&ball, [x, 0.0, 0.285]));
        let up = found.iter().find(|found| found.normal[2] > 1.0 - 1e-6).unwrap_or_else(|| panic!("{x} {found:?}"));
        assert!((deepest(up) - 0.015).abs() < 1e-9, "{x} {found:?}");
    }
}

/// Returns a field of hills of 2 n² faces over [-1, 1]².
fn hills(n: u32) -> Mesh {
    let mut grid = plane_grid(n, n);
    for v in &mut grid.vertices {
        let [x, y] = [v[0], v[1]].map(|x| 2.0 * x / f64::from(n) - 1.0);
        *v = [x, y, 0.1 * (5.0 * x).sin() * (4.0 * y).sin()];
    }
    engine(&grid)
}

/// Checks balls slightly sunk into hills: the deepest contact is as deep as the ball is at the
/// nearest point of the surface.
#[test]
fn balls_on_hills_are_as_deep_as_the_nearest_point_says() {
    let mut rng = Rng::new(601);
    let mut checked = 0;
    for n in [9, 20] {
        let mesh = hills(n);
        for _ in 0..impinge_testkit::rounds(100) {
            let [x, y] = [0; 2].map(|_| rng.uniform(-0.7, 0.7));
            let radius = [0.05, 0.1, 0.3][rng.integer(0, 2) as usize];
            let away = |z: f64| mesh.closest_point([x, y, z]).unwrap().unwrap().upper;
            let (mut low, mut high) = (0.1 * (5.0 * x).sin() * (4.0 * y).sin(), 0.5 + radius);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if away(middle) > 0.98 * radius { high = middle } else { low = middle }
            }
            let depth = radius - away(high);
            let ball = Shape::sphere([0.0; 3], radius).unwrap();
            let found = query::contacts(here(&Shape::mesh(&mesh)), there(&ball, [x, y, high]));
            let found = found.iter().map(deepest).fold(f64::NEG_INFINITY, f64::max);
            assert!((found - depth).abs() < 0.01 * depth, "{n} {radius} {:?}: {found}, not {depth}", [x, y, high]);
            checked += usize::from(depth > 0.01 * radius);
        }
    }
    assert!(checked > 150, "{checked}");
}

/// Checks a box slightly sunk into a floor of squares: its four lower corners are in contact,
/// however it is turned.
#[test]
fn a_box_on_a_grid_keeps_all_its_corners() {
    let mut grid = plane_grid(20, 20);
    grid.vertices.iter_mut().for_each(|v| *v = [v[0] - 10.0, v[1] - 10.0, 0.0]);
    let floor = here(&Shape::mesh(&engine(&grid)));
    let unit = Shape::cuboid([0.5; 3]).unwrap();
    let mut rng = Rng::new(63);
    for _ in 0..impinge_testkit::rounds(100) {
        let ([x, y], turn) = ([0; 2].map(|_| rng.uniform(-8.0, 8.0)), rng.uniform(0.0, 6.3));
        let place = Pose::from_axis_angle([0.0, 0.0, 1.0], turn, [x, y, 0.499]).unwrap();
        let placed = unit.at(place).unwrap();
        for most_points in [4, 8, 16] {
            let options = ContactOptions { most_points, ..ContactOptions::default() };
            let found = only(Query::new().with_contacts(options).contacts(&floor, &placed), [0.0, 0.0, 1.0], 1e-3);
            for corner in 0..4 {
                let [i, j] = [corner & 1, corner >> 1].map(|bit| [-0.5, 0.5][bit]);
                let foot = place.apply([i, j, -0.5]);
                let is_there = |point: &query::ContactPoint| (0..2).all(|k| (point.point_b[k] - foot[k]).abs() < 1e-9);
                assert!(found.points.iter().any(is_there), "{x} {y} {turn} {most_points} {found:?}");
            }
            assert!((area(&found) - 1.0).abs() < 1e-9, "{found:?}");
        }
    }
}

/// Checks a crate 1 mm deep in flush tiles, less and more than 1 mm over their seam.
#[test]
fn a_crate_on_flush_tiles_is_only_lifted() {
    let tile = Shape::cuboid([5.0, 5.0, 0.5]).unwrap();
    let floor = Shape::compound(&[(tile.clone(), at([-5.0, 0.0, -0.5])), (tile, at([5.0, 0.0, -0.5]))]).unwrap();
    let crate_ = Shape::cuboid([0.5; 3]).unwrap();
    for over in [1e-4, 9e-4, 1.1e-3] {
        let [floor, crate_] = [here(&floor), there(&crate_, [-0.5 + over, 0.0, 0.499])];
        for (found, sign) in [(query::contacts(&floor, &crate_), 1.0), (query::contacts(&crate_, &floor), -1.0)] {
            assert_eq!(found.len(), 2, "{found:?}");
            for found in &found {
                assert!(
                    sign * found.normal[2] > 1.0 - 1e-12 && (deepest(found) - 1e-3).abs() < 1e-9,
                    "{over} {found:?}"
                );
            }
        }
    }
}

/// Checks that a crate that slides over tiles never meets the side of the next tile, even if it is
/// a little above or below the tiles, and whether it is a box or a mesh.
#[test]
fn a_crate_near_flush_tiles_is_only_lifted() {
    let mut rng = Rng::new(611);
    let tile = Shape::cuboid([0.5, 0.5, 0.25]).unwrap();
    let places = (0..16).map(|i| (tile.clone(), at([f64::from(i % 4) - 1.5, f64::from(i / 4) - 1.5, -0.25])));
    let floor = here(&Shape::compound(&places.collect::<Vec<_>>()).unwrap());
    let crates = [Shape::cuboid([0.5; 3]).unwrap(), Shape::solid(&box_mesh([0.5; 3]))];
    for round in 0..120 {
        let depth = [-0.015, -1e-6, 0.0, 1e-6, 1e-3][round % 5];
        // On the grid, near it, or anywhere.
        let aside = [0; 2].map(|_| match rng.integer(0, 2) {
            0 => 0.25 * f64::from(rng.integer(-4, 4) as i32),
            1 => 0.25 * f64::from(rng.integer(-4, 4) as i32) + rng.uniform(-0.02, 0.02),
            _ => rng.uniform(-1.0, 1.0),
        });
        for crate_ in &crates {
            let crate_ = there(crate_, [aside[0], aside[1], 0.5 - depth]);
            for (found, sign) in [(nearby(&floor, &crate_), 1.0), (nearby(&crate_, &floor), -1.0)] {
                let most = found.iter().map(deepest).fold(f64::NEG_INFINITY, f64::max);
                assert!((most - depth).abs() < 1e-9, "{aside:?} {depth} {found:?}");
                let is_up = |found: &Manifold| sign * found.normal[2] > 1.0 - 1e-9;
                assert!(found.iter().all(is_up), "{aside:?} {depth} {found:?}");
            }
        }
    }
}

/// Checks that a ball that has left a tile is not pushed back by the edge of that tile.
#[test]
fn a_ball_on_flush_tiles_is_only_lifted() {
    let tile = Shape::cuboid([0.5, 0.5, 0.25]).unwrap();
    let floor = Shape::compound(&[(tile.clone(), at([-0.5, 0.0, -0.25])), (tile, at([0.5, 0.0, -0.25]))]).unwrap();
    let ball = Shape::sphere([0.0; 3], 0.25).unwrap();
    for depth in [0.0, 1e-6, 1e-3, 0.05] {
        for x in [-0.2, -0.01, -1e-3, 0.0, 1e-3, 0.01, 0.2] {
            let found = query::contacts(here(&floor), there(&ball, [x, 0.1, 0.25 - depth]));
            assert!(!found.is_empty(), "{x} {depth}");
            for found in &found {
                let is_right = found.normal[2] > 1.0 - 1e-6 && (deepest(found) - depth).abs() < 1e-6 * depth + 1e-9;
                assert!(is_right, "{x} {depth} {found:?}");
            }
        }
    }
}

#[test]
fn boxes_that_share_a_face_are_not_deep() {
    let (unit, cube) = (Shape::cuboid([0.5; 3]).unwrap(), Shape::solid(&box_mesh([0.5; 3])));
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let aside: [f64; 3] = std::array::from_fn(|k| if k == axis { sign } else { 0.25 });
            let found = query::penetration(here(&unit), there(&unit, aside)).expect("they touch");
            assert_eq!((found.lower, found.upper), (0.0, 0.0), "{found:?}");
            for (a, b) in [(&unit, &unit), (&cube, &unit), (&unit, &cube), (&cube, &cube)] {
                let found = query::contacts(here(a), there(b, aside));
                assert_eq!(found.len(), 1, "{found:?}");
                assert_eq!((found[0].points.len(), deepest(&found[0])), (4, 0.0), "{a:?} {b:?} {found:?}");
            }
        }
    }
}

#[test]
fn a_box_on_a_floor_a_billion_times_larger_has_four_contacts() {
    let small = Shape::cuboid([0.1; 3]).unwrap();
    for size in [1e6, 1e7, 1e8] {
        let half = [size, size, 0.25];
        for floor in [Shape::cuboid(half).unwrap(), Shape::solid(&box_mesh(half))] {
            let found = query::contacts(here(&floor), there(&small, [0.9 * size, 0.0, 0.35 - 1e-4]));
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((area(&found[0]) - 0.04).abs() < 1e-6, "{found:?}");
            let is_right = |point: &query::ContactPoint| {
                point.lower < 1e-4 + 1e-8 && 1e-4 - 1e-8 < point.upper && point.upper - point.lower < 1e-5
            };
            assert!(found[0].points.iter().all(is_right), "{found:?}");
        }
    }
}

/// Box shape that counts the calls of its support function.
#[derive(Debug, Default)]
struct Counted(std::sync::atomic::AtomicUsize);

impl impinge::convex::Support for Counted {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        direction.map(|x| 4.5_f64.copysign(x))
    }

    fn reach(&self) -> [f64; 3] {
        [4.5; 3]
    }
}

/// Checks that the contacts of a flat mesh take less than one support for each face, from 3,200
/// faces to 51,200: the faces in one plane are one piece.
#[test]
fn faces_in_one_plane_are_one_contact() {
    let calls = [40, 80, 160].map(|n: u32| {
        let mut grid = plane_grid(n, n);
        grid.vertices
            .iter_mut()
            .for_each(|v| *v = [v[0] * 10.0 / f64::from(n) - 5.0, v[1] * 10.0 / f64::from(n) - 5.0, 0.0]);
        let counted = std::sync::Arc::new(Counted::default());
        let shape = Shape::custom(counted.clone()).unwrap();
        let place = Pose::from_axis_angle([0.0, 0.0, 1.0], 0.1, [0.01, 0.02, 4.499]).unwrap();
        let (floor, shape) = (here(&Shape::mesh(&engine(&grid))), shape.at(place).unwrap());
        let before = counted.0.load(std::sync::atomic::Ordering::Relaxed);
        let found = query::contacts(&floor, &shape);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((deepest(&found[0]) - 1e-3).abs() < 1e-6, "{found:?}");
        counted.0.load(std::sync::atomic::Ordering::Relaxed) - before
    });
    assert!(calls.iter().zip([3_200, 12_800, 51_200]).all(|(&calls, faces)| calls < faces / 4), "{calls:?}");
}
