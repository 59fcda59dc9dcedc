//! Static bodies of one surface, compared with one compound.

use std::collections::BTreeMap;

use impinge::query::{ContactPoint, Manifold};
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BroadPhase, Change, Kind, Options, PairKey, Snapshot, Traits, World};
use impinge::{Mesh, Pose};
use impinge_testkit::generate::{Rng, solids};
use impinge_testkit::rounds;

/// Number of tiles along each side of a floor.
const SIDE: usize = 4;

/// Half of the edges of a tile. Tiles are flush on a grid of integers.
const TILE: [f64; 3] = [0.5, 0.5, 0.25];

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).unwrap()
}

/// Returns the pose of each tile; their tops are at height zero.
fn places() -> Vec<Pose> {
    let middle = |i: usize| i as f64 - SIDE as f64 / 2.0 + 0.5;
    (0..SIDE * SIDE).map(|i| at([middle(i % SIDE), middle(i / SIDE), -0.25])).collect()
}

/// Returns shapes that slide over a floor, each with the height of its origin over its foot, and a
/// sphere that is small and deep in the floor.
fn sliders() -> Vec<(Shape, f64)> {
    let cuboid = Shape::cuboid([0.5; 3]).unwrap();
    let small = Shape::cuboid([0.25, 0.25, 0.5]).unwrap();
    let feet = [(small.clone(), at([-0.5, 0.0, 0.0])), (small, at([0.5, 0.0, 0.0]))];
    let box_mesh = solids::cuboid([-0.5; 3], [0.5; 3]);
    vec![
        (cuboid, 0.5),
        (Shape::sphere([0.0; 3], 0.25).unwrap(), 0.25),
        (Shape::compound(&feet).unwrap(), 0.5),
        (Shape::capsule([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], 0.25).unwrap(), 0.25),
        (Shape::solid(&Mesh::new(box_mesh.vertices, box_mesh.faces).unwrap()), 0.5),
        (Shape::sphere([0.0; 3], 0.05).unwrap(), -0.15),
    ]
}

/// Returns a place over the floor with coordinates on a grid of quarters, near it, or anywhere.
fn place(rng: &mut Rng, height: f64) -> Pose {
    let depth = [0.0, 0.0, 1e-6, 1e-3, 0.02, -0.01, 0.1][rng.integer(0, 6) as usize];
    let [x, y] = [0; 2].map(|_| {
        let tie = 0.25 * rng.integer(-8, 8) as f64;
        match rng.integer(0, 3) {
            0 | 1 => tie,
            2 => tie + rng.uniform(-0.02, 0.02),
            _ => rng.uniform(-2.0, 2.0),
        }
    });
    at([x, y, height - depth])
}

/// Returns the parts of a manifold that do not name a part of the floor.
fn plain(manifold: &Manifold) -> impl PartialEq + std::fmt::Debug + use<> {
    let of = |at: &ContactPoint| (at.point_a, at.point_b, at.lower, at.upper, at.id.feature_a, at.id.feature_b);
    (manifold.normal, manifold.points.iter().map(of).collect::<Vec<_>>())
}

/// Checks bodies of one surface against one compound of the same tiles, bit for bit.
#[test]
fn tiles_of_one_surface_have_the_contacts_of_a_compound() {
    let (mut compared, mut buried) = (0, 0);
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(5_201);
        for round in 0..rounds(6) {
            let tile = Shape::cuboid(TILE).unwrap();
            let tiles: Vec<Pose> = places().into_iter().filter(|_| rng.integer(0, 7) > 0).collect();
            let parts: Vec<_> = tiles.iter().map(|&pose| (tile.clone(), pose)).collect();
            let options = Options { broad_phase, ..Options::default() };
            // The floor comes first in half of the pairs.
            let tag = if round % 2 == 0 { 0 } else { 100 };
            let floor = |shape: Shape| Body::new(shape).kind(Kind::Static).tag(tag);
            let (mut split, mut alone, mut whole) =
                (World::with_options(options), World::with_options(options), World::with_options(options));
            let mut of_tile = Vec::new();
            for &pose in &tiles {
                of_tile.push(split.insert(floor(tile.clone()).at(pose).surface(7)).unwrap());
                alone.insert(floor(tile.clone()).at(pose)).unwrap();
            }
            let compound = whole.insert(floor(Shape::compound(&parts).unwrap())).unwrap();
            let sliders: Vec<_> = sliders()
                .into_iter()
                .map(|(shape, height)| {
                    let body = Body::new(shape).tag(50).owner(1).at(place(&mut rng, height));
                    ([&mut split, &mut alone, &mut whole].map(|world| world.insert(body.clone()).unwrap()), height)
                })
                .collect();
            for _ in 0..8 {
                // Some rest.
                let moves: Vec<_> =
                    sliders.iter().filter(|_| rng.integer(0, 2) > 0).map(|(ids, height)| (*ids, *height)).collect();
                let moves: Vec<_> = moves.into_iter().map(|(ids, height)| (ids, place(&mut rng, height))).collect();
                let of = |world: usize| moves.iter().map(|(ids, pose)| (ids[world], *pose)).collect::<Vec<_>>();
                split.step(&of(0)).unwrap();
                alone.step(&of(1)).unwrap();
                whole.step(&of(2)).unwrap();
                for (ids, _) in &sliders {
                    let all = whole.pair(compound, ids[2]).unwrap().map_or(&[][..], |pair| pair.manifolds);
                    let lone = alone.pairs_of(ids[1]).unwrap().map(|pair| pair.manifolds.len()).sum::<usize>();
                    let mut sum = 0;
                    for (part, &body) in of_tile.iter().enumerate() {
                        let found = split.pair(body, ids[0]).unwrap().map_or(&[][..], |pair| pair.manifolds);
                        let part_of = |manifold: &Manifold| {
                            let id = manifold.points[0].id;
                            if tag == 0 { id.part_a } else { id.part_b }
                        };
                        let wanted: Vec<_> =
                            all.iter().filter(|manifold| part_of(manifold) == part as u32).map(plain).collect();
                        assert_eq!(found.iter().map(plain).collect::<Vec<_>>(), wanted, "{broad_phase:?} {round}");
                        sum += found.len();
                    }
                    assert_eq!(sum, all.len());
                    compared += sum;
                    buried += lone - sum;
                }
            }
        }
    }
    assert!(compared > 3_000 && buried > 80, "{compared} {buried}");
}

/// Checks that nothing is pushed sideways on tiles of one surface, and that some would be if the
/// tiles were bodies of their own.
#[test]
fn what_slides_and_rolls_over_tiles_of_one_surface_is_only_lifted() {
    let mut sideways = [0; 2];
    for (shape, height) in sliders().into_iter().filter(|(_, height)| *height > 0.0) {
        for (nth, surface) in [Some(1), None].into_iter().enumerate() {
            let mut world = World::new();
            for pose in places() {
                let tile = Body::new(Shape::cuboid(TILE).unwrap()).kind(Kind::Static).at(pose);
                world.insert(if let Some(surface) = surface { tile.surface(surface) } else { tile }).unwrap();
            }
            let slider = world.insert(Body::new(shape.clone()).with_margin(0.02)).unwrap();
            for depth in [-0.01, 0.0, 1e-6, 1e-3, 0.01] {
                for step in -64..=64 {
                    let [x, y] = [f64::from(step) / 64.0, f64::from(step) / 256.0];
                    world.step(&[(slider, at([x, y, height - depth]))]).unwrap();
                    let mut deepest = f64::NEG_INFINITY;
                    for manifold in world.pairs_of(slider).unwrap().flat_map(|pair| pair.manifolds) {
                        sideways[nth] += usize::from(manifold.normal[2] < 1.0 - 1e-6);
                        deepest = manifold.points.iter().map(|at| at.upper).fold(deepest, f64::max);
                    }
                    assert!(
                        surface.is_none() || (deepest - depth).abs() < 1e-6 * depth.abs() + 1e-9,
                        "{x} {depth} {deepest}"
                    );
                }
            }
        }
    }
    assert!(sideways[0] == 0 && sideways[1] > 300, "{sideways:?}");
}

/// Returns a world with the same bodies, which never saw another step.
fn anew(world: &World) -> World {
    let mut record = world.save().to_record();
    record.pairs.clear();
    record.departed.clear();
    for body in &mut record.bodies {
        body.change = Change::Traits;
    }
    let mut made = World::with_options(*world.options());
    made.restore(&Snapshot::from_record(&record, world.options()).unwrap());
    made
}

/// Returns the manifolds of all pairs.
fn manifolds_of(world: &World) -> BTreeMap<PairKey, Vec<Manifold>> {
    world.pairs().map(|pair| (pair.key, pair.manifolds.to_vec())).collect()
}

/// Checks that the contacts with a surface follow from the bodies as they are, after changes in any
/// step.
#[test]
fn contacts_with_a_surface_do_not_depend_on_what_changed_before() {
    let mut differences = 0;
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(5_202);
        for _ in 0..rounds(24) {
            let mut world = World::with_options(Options { broad_phase, ..Options::default() });
            let tile = Body::new(Shape::cuboid(TILE).unwrap()).kind(Kind::Static);
            let places = places();
            let mut tiles: Vec<(BodyId, usize)> = (0..places.len())
                .map(|at| {
                    (world.insert(tile.clone().at(places[at]).surface(rng.integer(0, 9) as u64 / 9)).unwrap(), at)
                })
                .collect();
            let sliders: Vec<_> = sliders()
                .into_iter()
                .map(|(shape, height)| {
                    (world.insert(Body::new(shape).owner(1).at(place(&mut rng, height))).unwrap(), height)
                })
                .collect();
            world.step(&[]).unwrap();
            for _ in 0..24 {
                let before = manifolds_of(&world);
                let nth = rng.integer(0, tiles.len() as i64 - 1) as usize;
                let (body, at_place) = tiles[nth];
                match rng.integer(0, 5) {
                    0 | 1 => {
                        world.remove(body).unwrap();
                        tiles.swap_remove(nth);
                        // Sometimes back at once, in the same step.
                        if rng.integer(0, 1) == 0 {
                            tiles.push((world.insert(tile.clone().at(places[at_place]).surface(0)).unwrap(), at_place));
                        }
                    }
                    2 => {
                        let lower = [0.0, -0.0, -0.25, 1e-7][rng.integer(0, 3) as usize];
                        let [x, y, z] = *places[at_place].translation();
                        world.set_pose(body, at([x, y, z + lower])).unwrap();
                    }
                    3 => {
                        let traits = *world.traits(body).unwrap();
                        let surface = [None, Some(0), Some(1)][rng.integer(0, 2) as usize];
                        world.set_traits(body, Traits { surface, ..traits }).unwrap();
                    }
                    4 => world.set_margin(body, [0.0, 0.01][rng.integer(0, 1) as usize]).unwrap(),
                    _ => {
                        let shape = Shape::cuboid([0.5, [0.5, 0.25][rng.integer(0, 1) as usize], 0.25]).unwrap();
                        world.set_shape(body, &shape).unwrap();
                    }
                }
                let (slider, height) = sliders[rng.integer(0, sliders.len() as i64 - 1) as usize];
                let moves = if rng.integer(0, 2) == 0 { vec![(slider, place(&mut rng, height))] } else { vec![] };
                let rests = moves.is_empty();
                world.step(&moves).unwrap();
                let mut fresh = anew(&world);
                fresh.step(&[]).unwrap();
                let found = manifolds_of(&world);
                assert_eq!(found, manifolds_of(&fresh), "{broad_phase:?}");
                // Contacts of a pair of which neither body changed.
                let is_other = |key: &PairKey| key.a != body && key.b != body;
                let is_new = |(key, manifolds): (&PairKey, &Vec<Manifold>)| {
                    is_other(key) && before.get(key).is_some_and(|before| before != manifolds)
                };
                differences += found.iter().filter(|pair| rests && is_new(*pair)).count();
            }
        }
    }
    assert!(differences > 40, "{differences}");
}
