//! Distances in worlds, against the distance of each body alone.

use impinge::query;
use impinge::shape::Shape;
use impinge::world::{Body, BodyDistance, BodyHit, BroadPhase, Traits, World, WorldError};
use impinge::{Pose, world};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::kinds::{pose_on_grid, shapes_on_grid, world_on_grid};

#[test]
fn nearest_bodies_equal_those_of_a_loop_over_all() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(311);
        let (mut apart, mut ties, mut none, mut near) = (0, 0, 0, 0);
        for round in 0..rounds(60) {
            let (world, bodies) = world_on_grid(&mut rng, broad_phase, 24, 4);
            let shapes = shapes_on_grid();
            let shape = &shapes[round % shapes.len()];
            let pose = pose_on_grid(&mut rng, 5);
            let placed = shape.at(pose).unwrap();
            let limit = rng.choose(&[f64::INFINITY, f64::INFINITY, f64::INFINITY, 1.0, 0.0]);
            let wanted = |traits: &Traits| round % 3 != 0 || traits.layers.on == 2;
            let distances: Vec<BodyDistance> = bodies
                .iter()
                .map(|&id| (id, world.body(id).unwrap()))
                .filter(|(_, body)| wanted(body.traits()))
                .map(|(id, body)| {
                    let distance = query::distance(&placed, body.shape().at(*body.world_from_body()).unwrap());
                    BodyDistance { tag: body.traits().tag, body: id, distance }
                })
                .collect();
            let expected = distances.iter().filter(|found| found.distance.lower <= limit).min_by(|one, other| {
                let upper = one.distance.upper.total_cmp(&other.distance.upper);
                upper.then((one.tag, one.body).cmp(&(other.tag, other.body)))
            });
            let found = world.nearest(shape, pose, limit, wanted).unwrap();
            assert_eq!(found.as_ref(), expected, "{broad_phase:?} {round} {shape:?} {pose:?} {limit}");
            none += u32::from(found.is_none());
            apart += u32::from(found.is_some_and(|found| found.distance.lower > 0.0));
            let tied = |other: &&BodyDistance| expected.is_some_and(|one| one.distance.upper == other.distance.upper);
            ties += u32::from(distances.iter().filter(tied).count() > 1);

            let clearance = rng.choose(&[0.0, 0.5, 1.0, 1.5]);
            let mut expected: Vec<BodyHit> = distances
                .iter()
                .filter(|found| {
                    let body = world.body(found.body).unwrap();
                    query::within(&placed, body.shape().at(*body.world_from_body()).unwrap(), clearance)
                })
                .map(|found| BodyHit { tag: found.tag, body: found.body })
                .collect();
            expected.sort();
            assert_eq!(world.within(shape, pose, clearance, wanted).unwrap(), expected, "{round} {clearance}");
            near += expected.len();
        }
        assert!(apart > 20 && ties > 4 && none > 6 && near > 45, "{apart} {ties} {none} {near}");
    }
}

/// Bodies of very different sizes, far from each other: the searched region grows by itself.
#[test]
fn nearest_bodies_are_found_at_every_scale() {
    let mut world = World::new();
    let mut bodies = Vec::new();
    for exponent in [-300, -40, 0, 20, 90] {
        let size = 2.0_f64.powi(exponent);
        let at = Pose::from_translation([4.0 * size, 0.0, 0.0]).unwrap();
        bodies.push(world.insert(Body::new(Shape::cuboid([size; 3]).unwrap()).at(at)).unwrap());
    }
    let origin = Shape::point([0.0; 3]).unwrap();
    for skipped in 0..bodies.len() {
        let wanted = |traits: &Traits| traits.tag == 0;
        let found = world.nearest(&origin, Pose::IDENTITY, f64::INFINITY, wanted).unwrap().unwrap();
        assert_eq!(found.body, bodies[skipped]);
        let traits = *world.traits(found.body).unwrap();
        let body = world.remove(found.body).unwrap();
        let hidden = world.insert(body.tag(1)).unwrap();
        assert_eq!(traits.tag + 1, world.traits(hidden).unwrap().tag);
    }
    assert!(world.nearest(&origin, Pose::IDENTITY, f64::INFINITY, |traits| traits.tag == 0).unwrap().is_none());
    for limit in [-1.0, f64::NAN] {
        assert!(world.nearest(&origin, Pose::IDENTITY, limit, |_| true).unwrap().is_none());
        assert!(world.within(&origin, Pose::IDENTITY, limit, |_| true).unwrap().is_empty());
    }
}

#[test]
fn distances_of_two_bodies_follow_their_poses() {
    let mut world = World::new();
    let sphere = Body::new(Shape::sphere([0.0; 3], 1.0).unwrap()).kind(world::Kind::Static);
    let a = world.insert(sphere.clone()).unwrap();
    let b = world.insert(sphere.at(Pose::from_translation([5.0, 0.0, 0.0]).unwrap())).unwrap();
    let found = world.distance(a, b).unwrap();
    assert!(found.lower <= 3.0 && found.upper >= 3.0 && found.upper - found.lower < 1e-12);
    let [point, other] = found.points().unwrap();
    assert_eq!(world.distance(b, a).unwrap().points(), Some([other, point]));
    world.set_pose(b, Pose::from_translation([2.0, 0.0, 0.0]).unwrap()).unwrap();
    assert_eq!(world.distance(a, b).unwrap().distance(), 0.0);
    world.remove(b).unwrap();
    assert_eq!(world.distance(a, b).unwrap_err(), WorldError::Stale { body: b });
}
