//! Depths of meshes with many faces: the nearest face is found through the tree, few facets are
//! compared with the whole mesh, and a budget ends all of it.

use std::f64::consts::PI;

use impinge::budget::{Budget, Stopped};
use impinge::query::{Deeper, Query, common_volume, depth};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::cuboid;

/// Returns a convex ball of radius 1 about the origin, symmetric about it, with 4 n² faces, none of
/// which lies in the plane of another.
fn ball(n: usize) -> Mesh {
    let around = 2 * n;
    let ring = |row: usize| {
        let polar = PI * row as f64 / n as f64;
        (0..around).map(move |at| {
            // Each second ring is turned, so that no two triangles are in one plane.
            let angle = PI * (2 * at + row % 2) as f64 / around as f64;
            [polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos()]
        })
    };
    let mut vertices: Vec<[f64; 3]> = (1..n).flat_map(ring).collect();
    let (top, bottom) = (vertices.len() as u32, vertices.len() as u32 + 1);
    vertices.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    let vertex = |row: usize, at: usize| ((row - 1) * around + at % around) as u32;
    let mut faces = Vec::new();
    for row in 1..n - 1 {
        for at in 0..around {
            // A ring that is turned is half a step ahead.
            let shift = row % 2;
            let (a, b) = (vertex(row, at), vertex(row, at + 1));
            faces.push([a, vertex(row + 1, at + shift), b]);
            faces.push([b, vertex(row + 1, at + shift), vertex(row + 1, at + shift + 1)]);
        }
    }
    for at in 0..around {
        faces.push([top, vertex(1, at), vertex(1, at + 1)]);
        faces.push([bottom, vertex(n - 1, at + 1), vertex(n - 1, at)]);
    }
    Mesh::new(Positions::F64(vertices), faces).unwrap()
}

/// Returns the radius of the ball about the origin that touches the faces of a convex mesh.
fn inradius(mesh: &Mesh) -> f64 {
    let height = |face: u32| {
        let [a, b, c] = mesh.corners(face);
        let [u, v]: [[f64; 3]; 2] = [b, c].map(|end| std::array::from_fn(|k| end[k] - a[k]));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let dot = |x: &[f64; 3], y: &[f64; 3]| (0..3).map(|k| x[k] * y[k]).sum::<f64>();
        dot(&normal, &a) / dot(&normal, &normal).sqrt()
    };
    (0..mesh.faces().len() as u32).map(height).fold(f64::INFINITY, f64::min)
}

fn block(min: [f64; 3], max: [f64; 3]) -> Mesh {
    let solid = cuboid(min, max);
    Mesh::new(Positions::F64(solid.vertices), solid.faces).unwrap()
}

#[test]
fn the_deepest_point_of_a_ball_in_a_plate_is_its_center() {
    // More facets than are compared with the whole mesh.
    let ball = ball(40);
    assert!(ball.is_closed() && ball.faces().len() > 6000);
    let plate = block([-2.0, -2.0, -0.125], [2.0, 2.0, 0.125]);
    let expected = inradius(&ball);
    for world in [Pose::IDENTITY, Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [4.0, -2.0, 1.0]).unwrap()] {
        let found = depth(ball.at(world), plate.at(world));
        assert!(found.is_proved && found.lower <= expected + 1e-9 && expected <= found.upper + 1e-9, "{found:?}");
        assert!(found.upper - found.lower < 0.01, "{found:?} {expected}");
        let deeper = |threshold: f64| Query::new().deeper(plate.at(world), ball.at(world), threshold);
        assert_eq!([deeper(0.9 * expected), deeper(1.1 * expected)], [Deeper::Yes, Deeper::No]);
    }
    // In a large block, the deepest point is as far from the block's surface.
    let around = depth(&ball, &block([-8.0; 3], [8.0; 3]));
    assert!(around.lower <= 8.0 && 8.0 <= around.upper && around.upper - around.lower < 0.01, "{around:?}");
}

#[test]
fn a_budget_ends_the_preparation_of_large_meshes_and_the_interval_holds() {
    let plate = block([-2.0, -2.0, -0.125], [2.0, 2.0, 0.125]);
    let whole = ball(40);
    let expected = inradius(&whole);
    let volume = common_volume(&whole, &plate).unwrap();
    let mut ends = 0;
    for steps in [0, 1, 2, 5, 10, 100, 1000, 1030, 1100, 2000] {
        // The facets of another mesh are not known yet.
        let ball = ball(40);
        let budgets: [Budget<'_>; 3] = std::array::from_fn(|_| Budget::new().with_steps(steps));
        let ask = |at: usize| Query::new().with_budget(&budgets[at]);
        let found = ask(0).depth(&ball, &plate);
        assert!(found.lower <= expected + 1e-9 && expected <= found.upper + 1e-9, "{steps}: {found:?}");
        assert_ne!(ask(1).deeper(&ball, &plate, 0.5), Deeper::No, "{steps}");
        let bounds = ask(2).common_volume(&ball, &plate).unwrap();
        assert!(bounds.lower <= volume.upper && volume.lower <= bounds.upper, "{steps}: {bounds:?} {volume:?}");
        ends += budgets.iter().filter(|budget| budget.stopped() == Some(Stopped::Steps)).count();
    }
    assert!(ends >= 10, "{ends}");
}
