//! Worlds of shapes and meshes against single queries, and world queries against all bodies one by
//! one.

use std::sync::Arc;

use impinge::hull::Hull;
use impinge::query;
use impinge::shape::Shape;
use impinge::volume::MinMax;
use impinge::world::{Body, BodyId, BroadPhase, NarrowPhase, Options, Realignment, World};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::icosphere;

use super::pose;

fn every_shape() -> Vec<Shape> {
    let mut rng = Rng::new(61);
    let points: Vec<[f64; 3]> = (0..30).map(|_| [0; 3].map(|_| rng.uniform(-0.7, 0.7))).collect();
    vec![
        Shape::sphere([0.2, 0.0, 0.0], 0.5).unwrap(),
        Shape::capsule([0.0, 0.0, -0.5], [0.0, 0.0, 0.5], 0.3).unwrap(),
        Shape::cuboid([0.5, 0.25, 0.75]).unwrap(),
        Shape::cylinder(0.5, 0.4).unwrap(),
        Shape::cone(0.6, 0.5).unwrap(),
        Shape::ellipsoid([0.5, 0.3, 0.7]).unwrap(),
        Shape::hull(Arc::new(Hull::new(&points).unwrap())),
        Shape::hull(Arc::new(Hull::new(&points[..9]).unwrap())).rounded(0.25).unwrap(),
        Shape::cuboid([0.5, 0.25, 0.125]).unwrap().rounded(0.125).unwrap(),
        Shape::tapered_capsule([0.0, 0.0, -0.5], [0.25, 0.0, 0.5], [0.25, 0.5]).unwrap(),
        Shape::triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]).unwrap(),
        Shape::half_space([0.1, 0.2, 1.0], -1.5).unwrap(),
        Shape::point([0.1, 0.2, 0.3]).unwrap(),
        dumbbell(),
    ]
}

/// Checks that a step updates a moved shape as placing the shape anew does. The two are separate
/// code.
#[test]
fn a_body_moved_by_a_step_equals_one_placed_there() {
    let mut rng = Rng::new(64);
    let (mut refused, mut taken, mut boxes, mut kept) = (0, 0, 0, 0);
    let mesh = knot();
    let meshes = [Shape::solid(&mesh), Shape::mesh(&mesh)];
    for shape in every_shape().into_iter().chain(meshes) {
        let mut world = World::new();
        let id = world.insert(Body::new(shape.clone())).unwrap();
        for step in 0..60 {
            let rigid = pose(&mut rng, 3.0);
            let scale = 1.0 + if step % 3 == 0 { 0.5 } else { 1e-5 * rng.uniform(-1.0, 1.0) };
            // Values that depend on the linear part alone are not computed again.
            let keeps = step % 3 != 0 && rng.one_in(2);
            let scaled = rigid.linear().map(|row| row.map(|x| x * scale));
            let linear = if keeps { *world.pose(id).unwrap().linear() } else { scaled };
            let to = Pose::new(linear, *rigid.translation()).unwrap();
            let before = format!("{:?} {:?}", world.pose(id).unwrap(), world.bounds(id).unwrap());
            let other = shape.at(to);
            let outcome = world.step(&[(id, to)]).map(|_| ());
            assert_eq!(outcome.is_ok(), other.is_ok());
            let Ok(other) = other else {
                refused += 1;
                assert_eq!(format!("{:?} {:?}", world.pose(id).unwrap(), world.bounds(id).unwrap()), before);
                continue;
            };
            taken += 1;
            kept += u32::from(keeps);
            let bounds = world.bounds(id).unwrap().map(|bounds| [bounds.min(), bounds.max()]);
            assert_eq!(format!("{bounds:?}"), format!("{:?}", other.bounds()), "{shape:?}");
            boxes += u32::from(bounds.is_some());
            assert_eq!(world.pose(id).unwrap(), &to);
        }
    }
    assert!(refused > 40 && taken > 400 && boxes > 400, "{refused} rejected, {taken} moved, {boxes} in boxes");
    assert!(kept > 150, "{kept} moved without a turn");
}

fn dumbbell() -> Shape {
    let at = |x| Pose::from_translation([x, 0.0, 0.0]).unwrap();
    let end = Shape::sphere([0.0; 3], 0.3).unwrap();
    Shape::compound(&[(end.clone(), at(-0.6)), (Shape::cuboid([0.6, 0.1, 0.1]).unwrap(), at(0.0)), (end, at(0.6))])
        .unwrap()
}

/// Checks for every method of realigning that boxes contain their shapes: no intersecting pair is
/// missed.
#[test]
fn pairs_of_shapes_agree_with_single_queries() {
    let ways = [Realignment::Own, Realignment::Rotated, Realignment::Loose, Realignment::Hull, Realignment::Climbing];
    for broad_phase in [BroadPhase::Tree, BroadPhase::Columns] {
        for way in ways {
            let mut rng = Rng::new(62);
            let mut world = World::with_options(Options { broad_phase, narrow_phase: NarrowPhase::Intersections });
            let shapes: Vec<Shape> = every_shape().into_iter().cycle().take(44).collect();
            let ids: Vec<BodyId> = shapes
                .iter()
                .map(|shape| {
                    world.insert(Body::new(shape.clone()).realigned_by(way).unwrap().at(pose(&mut rng, 2.0))).unwrap()
                })
                .collect();
            let mut met = 0;
            for _ in 0..4 {
                let moves: Vec<(BodyId, Pose)> = ids
                    .iter()
                    .copied()
                    .filter(|id| (id.to_bits() >> 32) % 3 != 0)
                    .map(|id| (id, pose(&mut rng, 2.0)))
                    .collect();
                world.step(&moves).unwrap();
                let placed: Vec<_> =
                    shapes.iter().zip(&ids).map(|(shape, &id)| shape.at(*world.pose(id).unwrap()).unwrap()).collect();
                for a in 0..ids.len() {
                    for b in a + 1..ids.len() {
                        let pair = world.pair(ids[a], ids[b]).unwrap();
                        assert_eq!(
                            pair.map(|pair| pair.proximity),
                            Some(query::proximity(&placed[a], &placed[b])).filter(|p| *p != query::Proximity::Apart),
                            "{way:?} {a} {b}"
                        );
                        met += u32::from(pair.is_some());
                    }
                }
            }
            assert!(met > 150 && met < 2500, "{met}");
        }
    }
}

#[test]
fn contacts_agree_with_single_queries() {
    let mut rng = Rng::new(65);
    let mut world = World::new();
    // Shapes whose contacts are fast: spheres, capsules and boxes.
    let shapes: Vec<Shape> = every_shape().into_iter().take(3).chain([dumbbell()]).cycle().take(24).collect();
    let ids: Vec<BodyId> =
        shapes.iter().map(|shape| world.insert(Body::new(shape.clone()).at(pose(&mut rng, 1.5))).unwrap()).collect();
    world.step(&[]).unwrap();
    let placed = |id: BodyId| {
        let at = ids.iter().position(|&other| other == id).unwrap();
        shapes[at].at(*world.pose(id).unwrap()).unwrap()
    };
    let mut points = 0;
    for pair in world.pairs() {
        assert_eq!(pair.manifolds, query::contacts(placed(pair.key.a), placed(pair.key.b)));
        points += pair.manifolds.iter().map(|manifold| manifold.points.len()).sum::<usize>();
    }
    assert!(points > 50, "{points}");
}

fn knot() -> Mesh {
    let ball = icosphere(3);
    let vertices = ball.vertices.iter().map(|&[x, y, z]| [x, 0.5 * y * (1.0 + x * x), z * (1.0 + y)]).collect();
    Mesh::new(Positions::F64(vertices), ball.faces).unwrap()
}

#[test]
fn pairs_of_meshes_agree_with_single_queries() {
    let mesh = knot();
    for (solid, way) in [(false, Realignment::Own), (true, Realignment::Climbing)] {
        let mut rng = Rng::new(63);
        let mut world = World::with_options(Options { narrow_phase: NarrowPhase::Intersections, ..Options::default() });
        let shape = if solid { Shape::solid(&mesh) } else { Shape::mesh(&mesh) };
        let body = Body::new(shape).realigned_by(way).unwrap();
        let ids: Vec<BodyId> = (0..20).map(|_| world.insert(body.clone().at(pose(&mut rng, 2.0))).unwrap()).collect();
        let (mut met, mut apart) = (0, 0);
        for _ in 0..10 {
            let moves: Vec<(BodyId, Pose)> = ids.iter().map(|&id| (id, pose(&mut rng, 2.0))).collect();
            world.step(&moves).unwrap();
            for a in 0..ids.len() {
                for b in a + 1..ids.len() {
                    let place = |i: usize| *world.pose(ids[i]).unwrap();
                    let expected = if solid {
                        query::intersects(mesh.solid().at(place(a)), mesh.solid().at(place(b)))
                    } else {
                        query::intersects(mesh.at(place(a)), mesh.at(place(b)))
                    };
                    assert_eq!(world.pair(ids[a], ids[b]).unwrap().is_some(), expected, "{a} {b}");
                    if expected { met += 1 } else { apart += 1 }
                }
            }
        }
        assert!(met > 200 && apart > 200, "{met} {apart}");
    }
}

#[test]
fn world_queries_agree_with_queries_of_each_body() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(64);
        let mut world = World::with_options(Options { broad_phase, ..Options::default() });
        let shapes: Vec<Shape> = every_shape().into_iter().cycle().take(55).collect();
        let ids: Vec<BodyId> = shapes
            .iter()
            .enumerate()
            .map(|(tag, shape)| {
                world.insert(Body::new(shape.clone()).tag(tag as u64 % 7).at(pose(&mut rng, 3.0))).unwrap()
            })
            .collect();
        let mut found_in_all = 0;
        for round in 0..60 {
            let (probe, at) = (rng.choose(&every_shape().iter().collect::<Vec<_>>()).clone(), pose(&mut rng, 3.0));
            let placed = probe.at(at).unwrap();
            let tag = round % 7;
            let mut expected: Vec<(u64, BodyId)> = ids
                .iter()
                .zip(&shapes)
                .filter(|&(&id, shape)| {
                    world.traits(id).unwrap().tag != tag
                        && query::intersects(&placed, shape.at(*world.pose(id).unwrap()).unwrap())
                })
                .map(|(&id, _)| (world.traits(id).unwrap().tag, id))
                .collect();
            expected.sort();
            let found = world.overlapping(&probe, at, |traits| traits.tag != tag).unwrap();
            assert_eq!(found.iter().map(|hit| (hit.tag, hit.body)).collect::<Vec<_>>(), expected);
            found_in_all += found.len();

            let corner = [0; 3].map(|_| rng.uniform(-3.0, 3.0));
            let bounds = MinMax::new(corner, corner.map(|x| x + 1.0)).unwrap();
            let in_box = world.overlapping_boxes(&bounds, |_| true);
            let boxes = ids.iter().filter(|&&id| {
                world.bounds(id).unwrap().is_some_and(|own| {
                    (0..3).all(|k| own.min()[k] <= bounds.max()[k] && bounds.min()[k] <= own.max()[k])
                })
            });
            assert!(boxes.clone().all(|&id| in_box.iter().any(|hit| hit.body == id)));
            let bounded = in_box.iter().filter(|hit| world.bounds(hit.body).unwrap().is_some());
            assert_eq!(bounded.count(), boxes.count());
            let at_corner = world.at_point(corner, |_| true).unwrap();
            assert!(at_corner.iter().all(|hit| in_box.contains(hit)));
        }
        assert!(found_in_all > 100, "{found_in_all}");
    }
}

#[test]
fn an_empty_mesh_has_no_pairs() {
    let mut world = World::new();
    let empty =
        world.insert(Body::new(Shape::mesh(&Mesh::new(Positions::F32(Vec::new()), Vec::new()).unwrap()))).unwrap();
    world.insert(Body::new(Shape::cuboid([1.0; 3]).unwrap())).unwrap();
    world.insert(Body::new(Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap())).unwrap();
    assert_eq!(world.step(&[]).unwrap().began.len(), 1);
    world.step(&[(empty, Pose::from_translation([1.0; 3]).unwrap())]).unwrap();
    assert_eq!((world.pairs().count(), world.bounds(empty).unwrap()), (1, None));
}
