//! Events that steps report, and errors.

use std::collections::BTreeSet;

use impinge::shape::Shape;
use impinge::world::{
    Body, BodyId, BroadPhase, Kind, Layers, NarrowPhase, Options, PairKey, Traits, World, WorldError,
};
use impinge::{InputErrorKind, Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;

use super::pose;

fn unit() -> Body {
    Body::new(Shape::cuboid([0.5; 3]).unwrap())
}

fn at(x: f64) -> Pose {
    Pose::from_translation([x, 0.0, 0.0]).unwrap()
}

/// Checks over steps with every kind of change that the pairs that began, without those that ended,
/// are the current pairs.
#[test]
fn events_add_up_to_the_current_pairs() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(91);
        let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Intersections });
        let shapes = [
            Shape::cuboid([0.6, 0.5, 0.4]).unwrap(),
            Shape::sphere([0.0; 3], 0.6).unwrap(),
            Shape::capsule([0.0, 0.0, -0.5], [0.0, 0.0, 0.5], 0.3).unwrap(),
        ];
        let mut alive: Vec<BodyId> = Vec::new();
        let mut present: BTreeSet<PairKey> = BTreeSet::new();
        let (mut began, mut ended) = (0, 0);
        for _ in 0..150 {
            if alive.len() < 40 {
                let owner = rng.integer(0, 5) as u64;
                let mut body =
                    Body::new(rng.choose(&[&shapes[0], &shapes[1], &shapes[2]]).clone()).at(pose(&mut rng, 2.0));
                if owner < 2 {
                    body = body.owner(owner);
                }
                alive.push(world.insert(body.tag(rng.integer(0, 3) as u64)).unwrap());
            }
            if rng.one_in(3) {
                let gone = alive.swap_remove(rng.integer(0, alive.len() as i64 - 1) as usize);
                world.remove(gone).unwrap();
            }
            if let Some(&body) = alive.first()
                && rng.one_in(4)
            {
                let kind = rng.choose(&[Kind::Static, Kind::Moving, Kind::Moving]);
                let layers = rng.choose(&[Layers::ALL, Layers { on: 1, meets: 2 }]);
                world.set_traits(body, Traits { kind, layers, ..*world.traits(body).unwrap() }).unwrap();
            }
            let mut moves = Vec::new();
            for &body in &alive {
                if world.traits(body).unwrap().kind == Kind::Moving && rng.one_in(3) {
                    moves.push((body, pose(&mut rng, 2.0)));
                }
            }
            let events = world.step(&moves).unwrap().clone();
            assert!(events.began.is_sorted() && events.ended.is_sorted());
            for key in &events.ended {
                assert!(present.remove(key), "{key:?} ended and was not there");
            }
            for key in &events.began {
                assert!(present.insert(*key), "{key:?} began twice");
            }
            let found: Vec<PairKey> = world.pairs().map(|pair| pair.key).collect();
            assert_eq!(found, present.iter().copied().collect::<Vec<_>>());
            for pair in world.pairs() {
                let (a, b) = (world.traits(pair.key.a).unwrap(), world.traits(pair.key.b).unwrap());
                assert!(a.admit(b) && (a.tag, pair.key.a) < (b.tag, pair.key.b));
            }
            (began, ended) = (began + events.began.len(), ended + events.ended.len());
        }
        assert!(began > 100 && ended > 100, "{began} {ended}");
    }
}

#[test]
fn bodies_at_rest_cost_nothing() {
    let mut world = World::new();
    let bodies: Vec<BodyId> = (0..50).map(|i| world.insert(unit().at(at(0.9 * f64::from(i)))).unwrap()).collect();
    assert_eq!(world.step(&[]).unwrap().work.examined, 49);
    assert_eq!(world.step(&[]).unwrap().work.changed, 0);
    // A pose that a body already has is no change.
    let again: Vec<(BodyId, Pose)> = bodies.iter().map(|&body| (body, *world.pose(body).unwrap())).collect();
    assert_eq!(world.step(&again).unwrap().work.changed, 0);
    let work = world.step(&[(bodies[3], at(2.8))]).unwrap().work;
    assert_eq!((work.changed, work.examined, work.candidates), (1, 2, 49));
    assert_eq!(world.pairs().count(), 49);
}

#[test]
fn the_last_pose_of_a_step_counts() {
    let mut world = World::new();
    let body = world.insert(unit()).unwrap();
    world.step(&[(body, at(3.0)), (body, at(0.0)), (body, at(5.0))]).unwrap();
    assert_eq!(world.pose(body).unwrap(), &at(5.0));
    world.step(&[(body, at(3.0)), (body, at(5.0))]).unwrap();
    assert_eq!(world.pose(body).unwrap(), &at(5.0));
}

#[test]
fn stale_handles_are_errors_everywhere() {
    let mut world = World::new();
    let body = world.insert(unit()).unwrap();
    let still = world.insert(unit()).unwrap();
    world.step(&[]).unwrap();
    world.remove(body).unwrap();
    let next = world.insert(unit()).unwrap();
    assert_ne!(body, next);
    let stale = WorldError::Stale { body };
    assert_eq!(world.remove(body).unwrap_err(), stale);
    assert_eq!(world.pose(body).unwrap_err(), stale);
    assert_eq!(world.traits(body).unwrap_err(), stale);
    assert_eq!(world.bounds(body).unwrap_err(), stale);
    assert_eq!(world.body(body).unwrap_err(), stale);
    assert_eq!(world.pair(body, next).unwrap_err(), stale);
    assert_eq!(world.pair(next, body).unwrap_err(), stale);
    assert_eq!(world.pairs_of(body).err(), Some(stale.clone()));
    assert_eq!(world.set_traits(body, Traits::default()).unwrap_err(), stale);
    assert_eq!(world.set_pose(body, at(1.0)).unwrap_err(), stale);
    assert_eq!(world.set_shape(body, &Shape::cuboid([1.0; 3]).unwrap()).unwrap_err(), stale);
    assert_eq!(world.refit(body, Positions::F32(Vec::new())).unwrap_err(), stale);
    assert_eq!(world.step(&[(next, at(9.0)), (body, at(1.0))]).unwrap_err(), stale);
    assert_eq!(world.pose(next).unwrap(), &Pose::IDENTITY, "the step was rejected as a whole");
    assert_eq!(stale.to_string(), "body 0#1 is not in this world (any more)");
    for bits in [0, 1 << 32, u64::MAX, body.to_bits()] {
        assert!(world.pose(BodyId::from_bits(bits)).is_err());
    }
    assert_eq!(BodyId::from_bits(next.to_bits()), next);
    let events = world.step(&[]).unwrap();
    assert_eq!((events.ended.len(), events.ended[0].a, events.ended[0].b), (1, body, still));
    assert_eq!(events.began.len(), 1);
}

#[test]
fn an_invalid_pose_is_rejected_by_body_and_changes_nothing() {
    let mut world = World::new();
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    let ball = Body::new(Shape::sphere([0.0; 3], 0.5).unwrap());
    assert!(matches!(world.insert(ball.clone().at(stretched)), Err(WorldError::Input { body: None, .. })));
    assert!(world.is_empty());
    let (cube, ball) = (world.insert(unit()).unwrap(), world.insert(ball.at(at(0.5))).unwrap());
    let wall = world.insert(unit().at(at(50.0)).kind(Kind::Static)).unwrap();
    world.step(&[]).unwrap();
    let before: Vec<PairKey> = world.pairs().map(|pair| pair.key).collect();
    assert_eq!(before.len(), 1);
    for error in
        [world.step(&[(cube, at(9.0)), (ball, stretched)]).unwrap_err(), world.set_pose(ball, stretched).unwrap_err()]
    {
        let WorldError::Input { body: Some(body), error } = error else { panic!("{error}") };
        assert!(body == ball && matches!(error.kind(), InputErrorKind::NotRigid { .. }));
    }
    assert_eq!(world.step(&[(cube, at(9.0)), (wall, at(51.0))]).unwrap_err(), WorldError::Static { body: wall });
    assert_eq!(world.step(&[]).unwrap().work.changed, 0);
    assert_eq!(world.pairs().map(|pair| pair.key).collect::<Vec<_>>(), before);
    assert_eq!(world.pose(cube).unwrap(), &Pose::IDENTITY);
    // A box may be stretched, and a wall may be moved outside of a step.
    world.step(&[(cube, stretched)]).unwrap();
    world.set_pose(wall, at(1.5)).unwrap();
    assert_eq!(world.step(&[]).unwrap().began.len(), 2);
}

#[test]
fn a_rejected_refit_changes_nothing() {
    let mut world = World::new();
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new(Positions::F32(corners.clone()), vec![[0, 1, 2]]).unwrap();
    let (body, cube) = (world.insert(Body::new(Shape::mesh(&mesh))).unwrap(), world.insert(unit()).unwrap());
    world.step(&[]).unwrap();
    let error = world.refit(body, Positions::F32(vec![[0.0; 3], [f32::NAN; 3], [0.0; 3]])).unwrap_err();
    assert!(matches!(error, WorldError::Input { body: Some(b), .. } if b == body));
    assert_eq!(world.refit(cube, Positions::F32(corners)).unwrap_err(), WorldError::NotAMesh { body: cube });
    assert_eq!((world.step(&[]).unwrap().work.changed, world.pairs().count()), (0, 1));
}

#[test]
fn filters_decide_inside_the_broad_phase() {
    let mut world = World::new();
    for tag in 0..10 {
        world.insert(unit().tag(tag)).unwrap();
    }
    world.set_filter(|a: (BodyId, &Traits), b: (BodyId, &Traits)| (a.1.tag + b.1.tag).is_multiple_of(2));
    let work = world.step(&[]).unwrap().work;
    assert_eq!((work.candidates, work.examined), (20, 20), "pairs that the filter rejects are no candidates");
    world.set_filter(|a: (BodyId, &Traits), b: (BodyId, &Traits)| a.1.tag == 0 || b.1.tag == 0);
    let events = world.step(&[]).unwrap();
    assert_eq!((events.began.len(), events.ended.len()), (5, 16));
    world.clear_filter();
    assert_eq!((world.step(&[]).unwrap().began.len(), world.pairs().count()), (36, 45));
}
