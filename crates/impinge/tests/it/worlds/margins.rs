//! Pairs of bodies with margins, against single queries.

use impinge::query::{self, ContactOptions, Manifold, Proximity, Query};
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, NarrowPhase, Options, Snapshot, World, WorldError};
use impinge::{InputErrorKind, Pose};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::kinds::{pose_on_grid, world_on_grid};

const MARGINS: [f64; 4] = [0.0, 0.0, 0.25, 0.5];

/// Returns the pair of two bodies as single queries with the sum of the margins find it.
fn alone(world: &World, [a, b]: [BodyId; 2]) -> Option<(Proximity, Vec<Manifold>)> {
    let [a, b] = [a, b].map(|body| world.body(body).unwrap());
    if !a.traits().admit(b.traits()) {
        return None;
    }
    let margin = a.margin() + b.margin();
    let [a, b] = [a, b].map(|body| body.shape().at(*body.world_from_body()).unwrap());
    let proximity = Query::new().nearness(&a, &b, margin);
    let contacts = ContactOptions { margin, ..ContactOptions::default() };
    (proximity != Proximity::Apart).then(|| (proximity, Query::new().with_contacts(contacts).contacts(&a, &b)))
}

#[test]
fn pairs_equal_single_queries_with_the_sum_of_the_margins() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(321);
        let (mut across, mut began, mut ended, mut exact) = (0, 0, 0, 0);
        for _ in 0..rounds(3) {
            let (mut world, bodies) = world_on_grid(&mut rng, broad_phase, 20, 3);
            for &body in &bodies {
                world.set_margin(body, rng.choose(&MARGINS)).unwrap();
            }
            let mut before: Vec<[BodyId; 2]> = Vec::new();
            for step in 0..6 {
                // The third step changes margins and moves nothing.
                let moved = if step == 3 { &[] } else { &bodies[1..] };
                let moves: Vec<(BodyId, Pose)> = moved.iter().map(|&body| (body, pose_on_grid(&mut rng, 3))).collect();
                if step == 3 {
                    world.set_margin(bodies[2], 1.0).unwrap();
                    world.set_margin(bodies[4], 0.0).unwrap();
                }
                let events = world.step(&moves).unwrap().clone();
                let mut now = Vec::new();
                for (nth, &a) in bodies.iter().enumerate() {
                    for &b in &bodies[nth + 1..] {
                        let pair = world.pair(a, b).unwrap();
                        let key = pair.map(|pair| [pair.key.a, pair.key.b]);
                        let expected = alone(&world, key.unwrap_or([a, b]));
                        let found = pair.map(|pair| (pair.proximity, pair.manifolds.to_vec()));
                        assert_eq!(found, expected, "{broad_phase:?} {step}");
                        let Some((_, manifolds)) = expected else { continue };
                        let deepest = manifolds.iter().flat_map(|found| &found.points).map(|at| at.upper);
                        let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
                        let sum = world.margin(a).unwrap() + world.margin(b).unwrap();
                        across += u32::from(deepest < 0.0);
                        exact += u32::from(sum > 0.0 && !is_within(&world, [a, b], sum.next_down()));
                        now.extend(key);
                    }
                }
                now.sort();
                let listed = |pairs: &[impinge::world::PairKey]| {
                    let mut pairs: Vec<[BodyId; 2]> = pairs.iter().map(|pair| [pair.a, pair.b]).collect();
                    pairs.sort();
                    pairs
                };
                let not_in = |these: &[[BodyId; 2]], those: &[[BodyId; 2]]| -> Vec<[BodyId; 2]> {
                    these.iter().copied().filter(|pair| !those.contains(pair)).collect()
                };
                assert_eq!(listed(&events.began), not_in(&now, &before));
                assert_eq!(listed(&events.ended), not_in(&before, &now));
                began += events.began.len();
                ended += events.ended.len();
                before = now;
            }
        }
        assert!(across > 80 && began > 180 && ended > 140 && exact > 30, "{across} {began} {ended} {exact}");
    }
}

fn is_within(world: &World, bodies: [BodyId; 2], clearance: f64) -> bool {
    let [a, b] = bodies.map(|body| world.body(body).unwrap());
    let [a, b] = [a, b].map(|body| body.shape().at(*body.world_from_body()).unwrap());
    query::within(&a, &b, clearance)
}

#[test]
fn invalid_margins_are_rejected_and_change_nothing() {
    let mut world = World::new();
    let sphere = Body::new(Shape::sphere([0.0; 3], 1.0).unwrap());
    let body = world.insert(sphere.clone().with_margin(0.5)).unwrap();
    let negative = InputErrorKind::Negative { what: "margin", index: 0 };
    let infinite = InputErrorKind::NonFinite { what: "margin", index: 0 };
    for (margin, kind) in [(-1.0, negative), (f64::NAN, infinite.clone()), (f64::INFINITY, infinite)] {
        let kind_of = |error: WorldError| match error {
            WorldError::Input { error, .. } => error.kind().clone(),
            other => panic!("{other}"),
        };
        assert_eq!(kind_of(world.set_margin(body, margin).unwrap_err()), kind);
        assert_eq!(kind_of(world.insert(sphere.clone().with_margin(margin)).unwrap_err()), kind);
    }
    assert_eq!((world.margin(body).unwrap(), world.len()), (0.5, 1));
    let bounds = world.bounds(body).unwrap().unwrap();
    assert!(bounds.max().iter().all(|&x| (1.5..1.5 + 1e-12).contains(&x)));
    assert_eq!(world.remove(body).unwrap().margin(), 0.5);
    assert_eq!(world.margin(body).unwrap_err(), WorldError::Stale { body });
}

#[test]
fn margins_survive_records_and_half_spaces_have_them() {
    for narrow_phase in [NarrowPhase::Contacts, NarrowPhase::Intersections, NarrowPhase::Boxes] {
        let options = Options { narrow_phase, ..Options::default() };
        let mut world = World::with_options(options);
        let floor = Shape::half_space([0.0, 0.0, 3.0], 0.0).unwrap();
        let floor = world.insert(Body::new(floor).with_margin(0.25)).unwrap();
        let sphere = Body::new(Shape::sphere([0.0; 3], 0.5).unwrap()).with_margin(0.25);
        let near = world.insert(sphere.clone().at(Pose::from_translation([0.0, 0.0, 1.0]).unwrap())).unwrap();
        let far = world.insert(sphere.at(Pose::from_translation([9.0, 0.0, 1.0625]).unwrap())).unwrap();
        let mut other = World::with_options(options);
        other.restore(&Snapshot::from_record(&world.save().to_record(), &options).unwrap());
        for world in [&mut world, &mut other] {
            world.step(&[]).unwrap();
            assert!(world.pair(floor, near).unwrap().is_some(), "{narrow_phase:?}");
            assert!(world.pair(floor, far).unwrap().is_none(), "{narrow_phase:?}");
        }
        assert_eq!(other.margin(near).unwrap(), 0.25);
    }
}
