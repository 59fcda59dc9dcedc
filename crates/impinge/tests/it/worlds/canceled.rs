//! Steps that a budget ends leave the world as it was.

use std::sync::atomic::{AtomicUsize, Ordering};

use impinge::budget::{Budget, Stopped};
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, Kind, NarrowPhase, Options, RecordedBody, World, WorldError};
use impinge_testkit::generate::Rng;

use super::pose;

/// Returns everything that a step changes in a world. Shapes are left out, because they keep values
/// that a query computed.
fn described(world: &World) -> String {
    let record = world.save().to_record();
    let of = |recorded: &RecordedBody| {
        let (pose, bounds) = (recorded.body.world_from_body(), world.bounds(recorded.id).unwrap());
        format!("{} {pose:?} {bounds:?} {:?}", recorded.id, recorded.change)
    };
    let bodies: Vec<String> = record.bodies.iter().map(of).collect();
    format!("{bodies:?} {:?} {:?} {:?} {:?}", record.generations, record.free, record.pairs, record.departed)
}

/// Ends every step at its first, second, fourth, ... check, until one finishes. A twin is never
/// canceled. Both then report the same.
#[test]
fn a_canceled_step_leaves_the_world_as_it_was() {
    let shapes = [
        Shape::cuboid([0.5; 3]).unwrap(),
        Shape::sphere([0.0; 3], 0.5).unwrap(),
        Shape::half_space([0.0, 0.0, 1.0], -2.0).unwrap(),
        Shape::compound(&[
            (Shape::cuboid([0.25; 3]).unwrap(), impinge::Pose::from_translation([0.5, 0.0, 0.0]).unwrap()),
            (Shape::sphere([0.0; 3], 0.25).unwrap(), impinge::Pose::IDENTITY),
        ])
        .unwrap(),
    ];
    let (mut canceled, mut ended) = (0, 0);
    for broad_phase in BroadPhase::ALL {
        for narrow_phase in [NarrowPhase::Boxes, NarrowPhase::Contacts] {
            let mut rng = Rng::new(902);
            let mut world = World::with_options(Options { broad_phase, narrow_phase });
            let bodies: Vec<BodyId> = (0..180)
                .map(|number| {
                    let kind = if number % 5 == 0 { Kind::Kinematic } else { Kind::Moving };
                    let shape = if number % 60 == 1 { &shapes[2] } else { &shapes[[0, 1, 3][number % 3]] };
                    world.insert(Body::new(shape.clone()).at(rigid(&mut rng)).kind(kind)).unwrap()
                })
                .collect();
            let mut twin = world.clone();
            for _ in 0..3 {
                let moved = rng.choose(&[3, 170]);
                let moves: Vec<_> = (0..moved).map(|_| (rng.choose(&bodies), rigid(&mut rng))).collect();
                let before = described(&world);
                for limit in (0..).map(|power: u32| 1_usize << power) {
                    let checks = AtomicUsize::new(0);
                    let is_wanted = || checks.fetch_add(1, Ordering::Relaxed) >= limit;
                    match world.step_with_budget(&moves, &Budget::new().with_cancel(&is_wanted)) {
                        Err(WorldError::Stopped(Stopped::Canceled)) => canceled += 1,
                        Ok(events) => {
                            assert_eq!(events, twin.step(&moves).unwrap());
                            ended += events.ended.len();
                            break;
                        }
                        Err(error) => panic!("{error}"),
                    }
                    assert!(described(&world) == before, "{broad_phase:?}, {limit} checks");
                }
                assert!(described(&world) == described(&twin), "{broad_phase:?}");
                // Both are changed in the same way between the steps.
                let body = rng.choose(&bodies);
                for world in [&mut world, &mut twin] {
                    world.set_shape(body, &shapes[1]).unwrap();
                }
            }
        }
    }
    assert!(canceled > 100 && ended > 50, "{canceled} {ended}");
}

fn rigid(rng: &mut Rng) -> impinge::Pose {
    pose(rng, 3.0)
}
