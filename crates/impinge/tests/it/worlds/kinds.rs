//! Small worlds on a grid, full of ties: equal bodies side by side, shared sides and equal times.

use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, Kind, Layers, Options, World};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::{cuboid, plane_grid};
use impinge_testkit::generate::{Rng, poses};

fn mesh_of(mesh: impinge_testkit::Mesh) -> Mesh {
    Mesh::new(Positions::F64(mesh.vertices), mesh.faces).unwrap()
}

/// Returns shapes whose sides are on a grid of halves, of every form.
pub(super) fn shapes_on_grid() -> Vec<Shape> {
    let at = |x: f64| Pose::from_translation([x, 0.0, 0.0]).unwrap();
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    vec![
        cube.clone(),
        Shape::sphere([0.0; 3], 0.5).unwrap(),
        Shape::capsule([0.0, 0.0, -0.5], [0.0, 0.0, 0.5], 0.5).unwrap(),
        Shape::triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap(),
        Shape::point([0.5, 0.5, 0.0]).unwrap(),
        Shape::mesh(&mesh_of(plane_grid(2, 2))),
        Shape::solid(&mesh_of(cuboid([-0.5; 3], [0.5; 3]))),
        Shape::compound(&[(cube.clone(), at(-1.0)), (cube, at(1.0)), (Shape::sphere([0.0; 3], 0.5).unwrap(), at(0.0))])
            .unwrap(),
    ]
}

/// Returns a turn of a cube and a translation by halves, both exact in floats.
pub(super) fn pose_on_grid(rng: &mut Rng, reach: i64) -> Pose {
    let turn = poses::cube_symmetry(rng);
    Pose::new(turn, [0; 3].map(|_| rng.integer(-2 * reach, 2 * reach) as f64 / 2.0)).unwrap()
}

/// Returns a world of bodies on a grid, with their handles. Two bodies in three share a tag, and
/// every other one is on the second layer. A floor is below them.
pub(super) fn world_on_grid(rng: &mut Rng, broad_phase: BroadPhase, count: usize, reach: i64) -> (World, Vec<BodyId>) {
    let mut world = World::with_options(Options { broad_phase, ..Options::default() });
    let shapes = shapes_on_grid();
    let floor = Shape::half_space([0.0, 0.0, 1.0], -reach as f64).unwrap();
    let mut bodies = vec![world.insert(Body::new(floor).kind(Kind::Static).tag(1)).unwrap()];
    for nth in 0..count {
        let shape = &shapes[rng.integer(0, shapes.len() as i64 - 1) as usize];
        let body = Body::new(shape.clone()).at(pose_on_grid(rng, reach)).tag(rng.integer(0, 2) as u64 / 2);
        let layers = Layers { on: 1 + (nth as u32 & 1), ..Layers::ALL };
        bodies.push(world.insert(body.layers(layers)).unwrap());
    }
    // Handles out of the order of insertion.
    for nth in [3, 5] {
        let body = world.remove(bodies[nth]).unwrap();
        bodies[nth] = world.insert(body).unwrap();
    }
    (world, bodies)
}
