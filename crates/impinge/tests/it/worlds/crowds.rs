//! Worlds of bodies of all kinds in few places, against brute force.

use impinge::Pose;
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, Kind, NarrowPhase, Options, Traits, World};
use impinge_testkit::generate::Rng;

const KINDS: [Kind; 4] = [Kind::Static, Kind::Kinematic, Kind::Moving, Kind::Moving];

/// Returns the pairs whose boxes overlap and whose traits admit them, compared one by one.
fn brute_force(world: &World) -> Vec<[BodyId; 2]> {
    let all: Vec<BodyId> = world.bodies().collect();
    let overlap = |a: BodyId, b: BodyId| match (world.bounds(a).unwrap(), world.bounds(b).unwrap()) {
        (Some(a), Some(b)) => (0..3).all(|k| a.min()[k] <= b.max()[k] && b.min()[k] <= a.max()[k]),
        _ => true, // each half-space of this test contains all places
    };
    let mut pairs = Vec::new();
    for (at, &a) in all.iter().enumerate() {
        for &b in &all[at + 1..] {
            let [traits_a, traits_b] = [a, b].map(|body| world.traits(body).unwrap());
            if traits_a.admit(traits_b) && overlap(a, b) {
                pairs.push([a, b]);
            }
        }
    }
    pairs
}

/// Bodies on few places of a grid change their kind, layers, owner, place and shape, and come and
/// go. After each step all broad phases know the pairs of brute force.
#[test]
fn bodies_of_all_kinds_are_paired_as_by_brute_force() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(901);
        let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
        let cube = Shape::cuboid([0.5; 3]).unwrap();
        let everything = Shape::half_space([0.0, 0.0, 1.0], 1e6).unwrap();
        let place = |rng: &mut Rng| Pose::from_translation([0; 3].map(|_| rng.integer(-2, 2) as f64)).unwrap();
        let traits = |rng: &mut Rng| Traits {
            kind: rng.choose(&KINDS),
            owner: rng.one_in(4).then_some(rng.integer(0, 2) as u64),
            ..Traits::default()
        };
        let mut met = [0; 3];
        for step in 0..300 {
            let alive: Vec<BodyId> = world.bodies().collect();
            if alive.len() < 150 {
                let shape = if rng.one_in(30) { &everything } else { &cube };
                let Traits { kind, owner, .. } = traits(&mut rng);
                let mut body = Body::new(shape.clone()).at(place(&mut rng)).kind(kind);
                if let Some(owner) = owner {
                    body = body.owner(owner);
                }
                (0..rng.integer(0, 9)).for_each(|_| _ = world.insert(body.clone()).unwrap());
            }
            let mut moves = Vec::new();
            let share = rng.choose(&[2, 40]);
            for &body in &alive {
                match rng.integer(0, 120) {
                    0 => _ = world.remove(body).unwrap(),
                    1 | 2 => world.set_traits(body, traits(&mut rng)).unwrap(),
                    3 => world.set_pose(body, place(&mut rng)).unwrap(),
                    4 => world.set_shape(body, if rng.one_in(9) { &everything } else { &cube }).unwrap(),
                    _ if rng.one_in(share) && world.traits(body).unwrap().kind != Kind::Static => {
                        moves.push((body, place(&mut rng)));
                    }
                    _ => {}
                }
            }
            moves.retain(|(body, _)| world.traits(*body).is_ok_and(|traits| traits.kind != Kind::Static));
            world.step(&moves).unwrap();
            let mut expected = brute_force(&world);
            let mut found: Vec<[BodyId; 2]> = world.pairs().map(|pair| [pair.key.a, pair.key.b]).collect();
            expected.sort_unstable();
            found.sort_unstable();
            assert!(found == expected, "{broad_phase:?}, step {step}: {} of {}", found.len(), expected.len());
            for pair in &expected {
                let guided = pair.iter().filter(|&&body| world.traits(body).unwrap().kind != Kind::Moving).count();
                let is_unbounded = pair.iter().any(|&body| world.bounds(body).unwrap().is_none());
                met[if is_unbounded { 2 } else { guided }] += 1;
            }
        }
        assert!(met.iter().all(|&met| met > 1000), "{broad_phase:?}: {met:?}");
    }
}
