//! Checks for a short time that stacks of meshes stand as stacks of hulls do, and that nothing
//! kicks what slides and rolls.

use glam::DVec3;
use impinge_simulation::block::Material;
use impinge_simulation::scenes::{Floor, Stack, roll, slide};
use impinge_simulation::solver::Simulation;

const MESH: Material = Material::Mesh(2);

/// Runs a simulation and returns how far the bodies moved, and their greatest speed at the end.
fn run(mut simulation: Simulation, steps: usize) -> (f64, f64) {
    let start: Vec<DVec3> = simulation.bodies().iter().map(|body| body.position).collect();
    for _ in 0..steps {
        simulation.step().unwrap();
    }
    let moved = simulation.bodies().iter().zip(&start).map(|(body, start)| body.position.distance(*start));
    let speed = simulation.bodies().iter().map(|body| body.velocity.length());
    (moved.fold(0.0, f64::max), speed.fold(0.0, f64::max))
}

#[test]
fn stacks_of_meshes_stand_as_stacks_of_hulls_do() {
    for (stack, steps) in [(Stack::Tower, 40), (Stack::Pyramid, 20), (Stack::Arch, 40)] {
        for material in [Material::Hull, MESH] {
            let (moved, speed) = run(stack.simulation(material).unwrap(), steps);
            assert!(moved < 3e-4 && speed < 5e-3, "{stack:?} {material:?}: {moved} {speed}");
        }
    }
}

#[test]
fn a_crate_slides_over_triangles_and_tiles_as_over_a_plane() {
    let end = |material, floor| {
        let mut simulation = slide(material, floor).unwrap();
        for step in 0..40 {
            simulation.step().unwrap();
            let body = simulation.bodies()[0];
            let is_level = body.velocity.z.abs() < 1e-3 && body.spin.length() < 0.01;
            assert!(is_level, "{material:?} {floor:?} step {step}: {body:?}");
        }
        simulation.bodies()[0].position
    };
    let on_plane = end(Material::Hull, Floor::Plane);
    assert!(on_plane.x > -5.5);
    for material in [Material::Hull, MESH] {
        for floor in [Floor::Plane, Floor::Mesh, Floor::Tiles] {
            let apart = end(material, floor).distance(on_plane);
            assert!(apart < 5e-3, "{material:?} {floor:?}: {apart}");
        }
    }
}

#[test]
fn a_ball_rolls_over_hills_without_a_kick() {
    let mut simulation = roll().unwrap();
    let start = simulation.energy();
    for _ in 0..240 {
        simulation.step().unwrap();
        assert!(simulation.energy() < 1.002 * start, "{}", simulation.energy() / start);
        assert!(simulation.deepest() < 5e-3, "{}", simulation.deepest());
    }
    assert!(simulation.bodies()[0].velocity.length() > 0.1 && simulation.energy() > 0.5 * start);
}
