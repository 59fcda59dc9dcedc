//! Pairs of boxes against brute force, over thousands of steps in which bodies are added, removed
//! and moved.

use std::collections::BTreeMap;

use impinge::Pose;
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, Kind, NarrowPhase, Options, World};
use impinge_testkit::generate::Rng;

/// Box as its corners.
type Corners = [[f64; 3]; 2];

/// Returns the overlapping pairs, compared one by one.
fn brute_force(boxes: &BTreeMap<BodyId, Corners>) -> Vec<[BodyId; 2]> {
    let all: Vec<(&BodyId, &Corners)> = boxes.iter().collect();
    let mut pairs = Vec::new();
    for (at, (a, [min, max])) in all.iter().enumerate() {
        for (b, [other_min, other_max]) in &all[at + 1..] {
            if (0..3).all(|k| min[k] <= other_max[k] && other_min[k] <= max[k]) {
                pairs.push([**a, **b]);
            }
        }
    }
    pairs
}

/// Parameters of a run: number of steps, maximum number of bodies, and distributions of sizes and
/// places.
struct Churn {
    steps: usize,
    max_bodies: usize,
    size: fn(&mut Rng) -> f64,
    random_pose: fn(&mut Rng) -> f64,
}

fn churned(broad_phase: BroadPhase, seed: u64, churn: &Churn) {
    let mut rng = Rng::new(seed);
    let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
    let mut alive: Vec<BodyId> = Vec::new();
    let (mut met, mut gained) = (0, 0);
    let random_pose = |rng: &mut Rng| Pose::from_translation([0; 3].map(|_| (churn.random_pose)(rng))).unwrap();
    for step in 0..churn.steps {
        while alive.len() < churn.max_bodies && rng.one_in(2) {
            let shape = Shape::cuboid([0; 3].map(|_| (churn.size)(&mut rng))).unwrap();
            alive.push(world.insert(Body::new(shape).at(random_pose(&mut rng))).unwrap());
        }
        while alive.len() > 2 && rng.one_in(6) {
            let gone = alive.swap_remove(rng.integer(0, alive.len() as i64 - 1) as usize);
            world.remove(gone).unwrap();
        }
        let mut moves = Vec::new();
        for _ in 0..rng.integer(0, alive.len() as i64 / 4) {
            let body = rng.choose(&alive);
            let pose = if rng.one_in(3) {
                random_pose(&mut rng)
            } else {
                let from = *world.pose(body).unwrap().translation();
                Pose::from_translation(from.map(|x| x + rng.uniform(-0.5, 0.5))).unwrap()
            };
            // Some are moved outside of a step.
            if rng.one_in(10) {
                world.set_pose(body, pose).unwrap();
            } else {
                moves.push((body, pose));
            }
        }
        gained += world.step(&moves).unwrap().work.gained;
        let boxes = alive.iter().map(|&body| {
            let bounds = world.bounds(body).unwrap().unwrap();
            (body, [bounds.min(), bounds.max()])
        });
        let expected = brute_force(&boxes.collect());
        let found: Vec<[BodyId; 2]> = world.pairs().map(|pair| [pair.key.a, pair.key.b]).collect();
        assert!(found == expected, "{broad_phase:?}, step {step}: {} pairs for {}", found.len(), expected.len());
        // Slots are reused, so that memory does not grow.
        assert!(alive.iter().all(|body| body.to_bits() >> 32 <= churn.max_bodies as u64));
        met += expected.len();
    }
    assert!(met > churn.steps && gained > churn.steps / 4, "{broad_phase:?}: {met} pairs, {gained} gained");
}

#[test]
fn boxes_of_like_size_are_paired_as_by_brute_force() {
    for broad_phase in BroadPhase::ALL {
        let churn = Churn {
            steps: 2000,
            max_bodies: 120,
            size: |rng| rng.uniform(0.25, 0.75),
            random_pose: |rng| rng.uniform(-5.0, 5.0),
        };
        churned(broad_phase, 81, &churn);
    }
}

#[test]
fn boxes_on_a_grid_that_touch_are_paired_as_by_brute_force() {
    for broad_phase in BroadPhase::ALL {
        let churn = Churn {
            steps: 1000,
            max_bodies: 60,
            size: |rng| rng.choose(&[0.0, 0.5, 0.5, 1.0]),
            random_pose: |rng| rng.integer(-4, 4) as f64,
        };
        churned(broad_phase, 82, &churn);
    }
}

#[test]
fn boxes_of_any_size_are_paired_as_by_brute_force() {
    for broad_phase in BroadPhase::ALL {
        let churn = Churn {
            steps: 1000,
            max_bodies: 60,
            size: |rng| rng.choose(&[0.0, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e30]) * rng.unit(),
            random_pose: |rng| rng.choose(&[0.0, 1.0, 1e3, 1e6, 1e12, 1e36]) * rng.uniform(-1.0, 1.0),
        };
        churned(broad_phase, 83, &churn);
    }
}

#[test]
fn boxes_that_coincide_are_paired_as_by_brute_force() {
    for broad_phase in BroadPhase::ALL {
        let churn =
            Churn { steps: 100, max_bodies: 60, size: |_| 1.0, random_pose: |rng| rng.choose(&[0.0, 0.0, 0.0, 5.0]) };
        churned(broad_phase, 84, &churn);
    }
}

#[test]
fn static_bodies_are_not_paired_with_each_other() {
    for broad_phase in BroadPhase::ALL {
        let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Boxes });
        let unit = Body::new(Shape::cuboid([1.0; 3]).unwrap());
        let kinds = [Kind::Static, Kind::Kinematic, Kind::Moving];
        for (tag, kind) in kinds.iter().chain(&kinds).enumerate() {
            world.insert(unit.clone().kind(*kind).tag(tag as u64)).unwrap();
        }
        world.step(&[]).unwrap();
        let pairs: Vec<[u64; 2]> = world.pairs().map(|pair| [pair.key.tag_a, pair.key.tag_b]).collect();
        assert_eq!(pairs, [[0, 2], [0, 5], [1, 2], [1, 5], [2, 3], [2, 4], [2, 5], [3, 5], [4, 5]]);
    }
}
