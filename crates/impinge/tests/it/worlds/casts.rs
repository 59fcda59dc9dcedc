//! Moving shapes through worlds, against the sweep with each body alone.

use impinge::shape::Shape;
use impinge::sweep::{Motion, Sweep};
use impinge::world::{Body, BodyId, BodyImpact, BroadPhase, Traits, World};
use impinge::{InputErrorKind, Pose};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::kinds::{pose_on_grid, shapes_on_grid, world_on_grid};

/// Returns the impacts on all wanted bodies, each by a sweep of its own, in the order of time, tag
/// and handle.
fn one_by_one(
    world: &World,
    bodies: &[BodyId],
    (shape, motion): (&Shape, &Motion),
    sweep: Sweep<'_>,
    wanted: impl Fn(&Traits) -> bool,
) -> Vec<BodyImpact> {
    let mut impacts: Vec<BodyImpact> = bodies
        .iter()
        .filter(|&&body| wanted(world.traits(body).unwrap()))
        .map(|&id| {
            let body = world.body(id).unwrap();
            let rest = Motion::resting(*body.world_from_body());
            let impact = sweep.time_of_impact(shape, body.shape(), motion, &rest).unwrap();
            BodyImpact { tag: body.traits().tag, body: id, impact }
        })
        .filter(|found| found.impact.hit())
        .collect();
    impacts.sort_by(|one, other| {
        one.impact.t_lower.total_cmp(&other.impact.t_lower).then((one.tag, one.body).cmp(&(other.tag, other.body)))
    });
    impacts
}

/// Returns a motion along the grid: straight, or with a turn about an axis.
fn motion_on_grid(rng: &mut Rng, reach: i64) -> Motion {
    let start = pose_on_grid(rng, reach);
    let path = [0; 3].map(|_| rng.integer(-reach, reach) as f64);
    match rng.integer(0, 3) {
        0 => {
            let mut angular = [0.0; 3];
            angular[rng.integer(0, 2) as usize] = rng.choose(&[0.5, 1.0, -2.0]);
            let pivot = rng.one_in(2).then(|| path.map(|x| -0.5 * x));
            Motion::screw(start, path, angular, pivot).unwrap()
        }
        _ => Motion::screw(start, path, [0.0; 3], None).unwrap(),
    }
}

#[test]
fn casts_equal_sweeps_with_each_body_alone() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(301);
        let (mut hits, mut misses, mut ties, mut later) = (0, 0, 0, 0);
        for round in 0..rounds(64) {
            let (world, bodies) = world_on_grid(&mut rng, broad_phase, 20, 4);
            let shapes = shapes_on_grid();
            let shape = &shapes[round % shapes.len()];
            let motion = motion_on_grid(&mut rng, 5);
            let sweep = match rng.integer(0, 3) {
                0 => Sweep::new().with_clearance(0.5),
                1 => Sweep::new().ignoring_touch(),
                _ => Sweep::new(),
            };
            let wanted = |traits: &Traits| round % 4 != 0 || traits.layers.on == 1;
            let expected = one_by_one(&world, &bodies, (shape, &motion), sweep, wanted);
            let found = world.shape_cast_all(shape, &motion, sweep, wanted).unwrap();
            assert_eq!(found, expected, "{broad_phase:?} {round} {shape:?} {motion:?} {sweep:?}");
            let first = world.shape_cast(shape, &motion, sweep, wanted).unwrap();
            assert_eq!(first.as_ref(), expected.first(), "{broad_phase:?} {round} {shape:?} {motion:?}");
            let time = |nth: usize| expected.get(nth).map(|found| found.impact.t_lower);
            ties += u32::from(time(0).is_some() && time(0) == time(1));
            later += u32::from(time(0).is_some_and(|t| t > 0.0));
            if expected.is_empty() { misses += 1 } else { hits += 1 }
        }
        assert!(hits > 30 && misses > 15 && ties > 4 && later > 10, "{hits} {misses} {ties} {later}");
    }
}

/// The path is much longer than the shape, so it is searched in stretches. Rows of equal bodies are
/// hit at equal times.
#[test]
fn long_casts_hit_the_first_body_of_a_row() {
    for broad_phase in [BroadPhase::Auto, BroadPhase::Every, BroadPhase::Grid] {
        let mut world = World::with_options(impinge::world::Options { broad_phase, ..Default::default() });
        let cube = Shape::cuboid([0.5; 3]).unwrap();
        let mut bodies = Vec::new();
        for x in 0..20 {
            for (y, tag) in [(0, 3), (1, 1), (-1, 2)] {
                let at = [f64::from(5 * x), f64::from(y), 0.0];
                let body = Body::new(cube.clone()).at(Pose::from_translation(at).unwrap()).tag(tag);
                bodies.push(world.insert(body).unwrap());
            }
        }
        let speck = Shape::cuboid([0.25, 1.0, 0.25]).unwrap();
        let (mut hits, mut diagonal) = (0, 0);
        for start in [-10.0, 0.0, 22.25, 47.0, 97.0] {
            for path in [[100.0, 0.0, 0.0], [-100.0, 0.0, 0.0], [64.0, 16.0, 8.0], [0.0, 0.0, 32.0]] {
                let motion = Motion::screw(Pose::from_translation([start, 0.5, 0.0]).unwrap(), path, [0.0; 3], None);
                let motion = motion.unwrap();
                let expected = one_by_one(&world, &bodies, (&speck, &motion), Sweep::new(), |_| true);
                assert_eq!(world.shape_cast_all(&speck, &motion, Sweep::new(), |_| true).unwrap(), expected);
                let first = world.shape_cast(&speck, &motion, Sweep::new(), |_| true).unwrap();
                assert_eq!(first.as_ref(), expected.first(), "{broad_phase:?} {start} {path:?}");
                hits += u32::from(first.is_some_and(|first| first.impact.t_lower > 0.0 && first.tag == 1));
                diagonal += u32::from(path[1] != 0.0 && first.is_some());
            }
        }
        assert!(hits >= 4 && diagonal >= 2, "{hits} {diagonal}");
    }
}

#[test]
fn unbounded_and_empty_shapes_are_cast() {
    let mut world = World::new();
    let cube = world.insert(Body::new(Shape::cuboid([0.5; 3]).unwrap())).unwrap();
    let rise = Motion::screw(Pose::from_translation([0.0, 0.0, -2.0]).unwrap(), [0.0, 0.0, 2.0], [0.0; 3], None);
    let rise = rise.unwrap();
    let floor = Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap();
    let hit = world.shape_cast(&floor, &rise, Sweep::new(), |_| true).unwrap().unwrap();
    assert!(hit.body == cube && (hit.impact.t_lower - 0.75).abs() < 1e-9);
    let nothing = impinge::Mesh::new(impinge::Positions::F32(Vec::new()), Vec::<[u32; 3]>::new()).unwrap();
    assert_eq!(world.shape_cast(&Shape::mesh(&nothing), &rise, Sweep::new(), |_| true).unwrap(), None);
    let near = world.shape_cast_all(&floor, &rise, Sweep::new().with_clearance(f64::INFINITY), |_| true).unwrap();
    assert_eq!(near.len(), 1);
    // Every pose of a round shape's motion must be rigid.
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    let sphere = Shape::sphere([0.0; 3], 1.0).unwrap();
    let error = world.shape_cast(&sphere, &Motion::resting(stretched), Sweep::new(), |_| true).unwrap_err();
    assert!(matches!(error.kind(), InputErrorKind::NotRigid { .. }));
}
