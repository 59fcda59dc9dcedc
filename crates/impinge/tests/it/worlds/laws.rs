//! Invariants: reports do not depend on threads, on the order of insertion, or on the broad phase;
//! and a world can be restored.

use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, Events, NarrowPhase, Options, World};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::icosphere;

use super::pose;

const BODIES: u64 = 24;

/// Returns bodies of the first `kinds` kinds, each with its own tag.
fn bodies(kinds: usize) -> Vec<Body> {
    let ball = icosphere(1);
    let mesh = Mesh::new(Positions::F64(ball.vertices), ball.faces).unwrap();
    let shapes = [
        Body::new(Shape::cuboid([0.6, 0.5, 0.4]).unwrap()),
        Body::new(Shape::sphere([0.1, 0.0, 0.0], 0.6).unwrap()),
        Body::new(Shape::cylinder(0.5, 0.5).unwrap()),
        Body::new(Shape::mesh(&mesh)),
        Body::new(Shape::capsule([0.0, 0.0, -0.5], [0.0, 0.0, 0.5], 0.3).unwrap()),
    ];
    let mut rng = Rng::new(95);
    (0..BODIES).map(|tag| shapes[tag as usize % kinds].clone().tag(tag).at(pose(&mut rng, 2.0))).collect()
}

/// Returns the moves of a step, by tag.
fn moves(step: u64) -> Vec<(u64, Pose)> {
    let mut rng = Rng::new(1000 + step);
    let mut moves = Vec::new();
    for tag in 0..BODIES {
        if rng.one_in(3) {
            moves.push((tag, pose(&mut rng, 2.0)));
        }
    }
    moves
}

/// Returns everything that is reported over some steps, without handles.
fn reports(world: &mut World, ids: &[BodyId], steps: std::ops::Range<u64>) -> String {
    let mut reports = String::new();
    for step in steps {
        let moves: Vec<(BodyId, Pose)> = moves(step).into_iter().map(|(tag, pose)| (ids[tag as usize], pose)).collect();
        let Events { began, ended, work } = world.step(&moves).unwrap().clone();
        let tags =
            |keys: Vec<impinge::world::PairKey>| keys.iter().map(|key| [key.tag_a, key.tag_b]).collect::<Vec<_>>();
        reports += &format!("{:?} {:?} {work:?}\n", tags(began), tags(ended));
        for pair in world.pairs() {
            reports += &format!("{} {} {:?} {:?}\n", pair.key.tag_a, pair.key.tag_b, pair.proximity, pair.manifolds);
        }
    }
    reports
}

/// Returns a world into which the bodies were inserted in the given order, and their handles by
/// tag.
fn world(options: Options, order: &[usize]) -> (World, Vec<BodyId>) {
    let mut world = World::with_options(options);
    // Contacts of meshes and of curved shapes take long.
    let bodies = bodies(if options.narrow_phase == NarrowPhase::Contacts { 2 } else { 5 });
    let mut ids = vec![BodyId::from_bits(0); bodies.len()];
    for &at in order {
        ids[at] = world.insert(bodies[at].clone()).unwrap();
    }
    (world, ids)
}

fn in_order() -> Vec<usize> {
    (0..BODIES as usize).collect()
}

/// Returns the options and number of steps of each run: every broad phase with intersections, and
/// one with contacts, which take longer.
fn ways() -> impl Iterator<Item = (Options, u64)> {
    let intersections = |broad_phase| (Options { broad_phase, narrow_phase: NarrowPhase::Intersections }, 5);
    BroadPhase::ALL.into_iter().map(intersections).chain([(Options::default(), 2)])
}

#[test]
fn reports_do_not_depend_on_broad_phase_threads_or_order() {
    let mut backwards = in_order();
    backwards.reverse();
    for (options, steps) in ways() {
        let (mut first, ids) = world(Options { broad_phase: BroadPhase::Every, ..options }, &in_order());
        let expected = reports(&mut first, &ids, 0..steps);
        assert!(expected.lines().count() > 40, "{}", expected.lines().count());
        assert_eq!(expected.contains("upper"), options.narrow_phase == NarrowPhase::Contacts);
        for (order, threads) in [(in_order(), 2), (backwards.clone(), 1), (backwards.clone(), 5)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut world, ids) = world(options, &order);
            let found = pool.install(|| reports(&mut world, &ids, 0..steps));
            assert!(found == expected, "{options:?}, {threads} threads");
        }
    }
}

#[test]
fn a_restored_world_repeats_its_reports() {
    for (options, steps) in ways() {
        let (mut world, ids) = world(options, &in_order());
        reports(&mut world, &ids, 0..1);
        let saved = world.save();
        let expected = reports(&mut world, &ids, 1..steps);
        // Changes in between have no effect.
        world.remove(ids[3]).unwrap();
        world.insert(Body::new(Shape::cuboid([9.0; 3]).unwrap())).unwrap();
        world.step(&[]).unwrap();
        world.restore(&saved);
        assert_eq!(reports(&mut world, &ids, 1..steps), expected);
        // The same in another world.
        let mut other = World::with_options(options);
        other.restore(&saved);
        assert_eq!(reports(&mut other, &ids, 1..steps), expected);
    }
}

/// Checks that answers do not change far from the origin, at distances that keep the digits of
/// coordinates.
#[test]
fn a_large_world_is_as_exact_as_a_small_one() {
    let unit = Body::new(Shape::cuboid([0.5; 3]).unwrap());
    for far in [0.0, f64::from(1 << 20), (1_u64 << 50) as f64] {
        let mut world = World::new();
        let at = |x: f64| Pose::from_translation([far + x, -far, far]).unwrap();
        let (still, moving) =
            (world.insert(unit.clone().at(at(0.0))).unwrap(), world.insert(unit.clone().at(at(1.0))).unwrap());
        assert_eq!(world.step(&[]).unwrap().began.len(), 1, "they touch");
        let beyond = at(1.0).translation()[0].next_up();
        let apart = Pose::from_translation([beyond, -far, far]).unwrap();
        assert_eq!(world.step(&[(moving, apart)]).unwrap().ended.len(), 1, "by one unit in the last place");
        assert!(world.pair(still, moving).unwrap().is_none());
    }
}
