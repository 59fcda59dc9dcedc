//! Height fields against the meshes of the same triangles: every verb, on grids full of ties.

use impinge::input::InputErrorKind;
use impinge::mesh::Ray;
use impinge::query::{self, ContactOptions, Feature, Manifold, Query};
use impinge::shape::{PlacedShape, Shape};
use impinge::sweep::{Motion, time_of_impact};
use impinge::world::{Body, RayOptions, World};
use impinge::{HeightField, Mesh, Pose, partition};
use impinge_testkit::generate::solids::icosphere;
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::rounds;

use crate::shapes::hulls::pose;
use crate::shapes::support::{Known, at, engine};

/// A height field with the mesh of its triangles.
struct Twin {
    field: HeightField,
    mesh: Mesh,
    /// For each face of the mesh, its number in the field.
    faces: Vec<u32>,
}

impl Twin {
    /// Returns a field of up to 30 by 30 cells, whose heights are on a grid or anywhere.
    fn random(rng: &mut Rng, with_holes: bool) -> Self {
        let most = if rng.one_in(4) { 31 } else { 9 };
        let [rows, columns] = [0; 2].map(|_| rng.integer(2, most) as usize);
        let spacing = [0; 2].map(|_| rng.choose(&[0.25, 0.5, 1.0, 0.3]));
        let kind = rng.integer(0, 3);
        let heights: Vec<f32> = (0..rows * columns)
            .map(|at| match kind {
                0 => 0.0,
                1 => rng.integer(-1, 1) as f32 / 4.0,
                2 => (at % columns) as f32 / 8.0,
                _ => rng.uniform(-0.75, 0.75) as f32,
            })
            .collect();
        let holes: Vec<bool> = (0..rows * columns).map(|_| with_holes && rng.one_in(4)).collect();
        let field =
            HeightField::with_holes(rows, columns, spacing, heights, |row, column| holes[row * columns + column]);
        let field = field.unwrap();
        let cells = 2 * (rows as u32 - 1) * (columns as u32 - 1);
        let faces = (0..cells).filter(|&face| field.face(face).is_some()).collect();
        Self { mesh: field.to_mesh().unwrap(), field, faces }
    }

    fn at(&self, pose: Pose) -> [PlacedShape; 2] {
        [Shape::height_field(&self.field), Shape::mesh(&self.mesh)].map(|shape| shape.at(pose).unwrap())
    }

    /// Renames the faces of the mesh as those of the field.
    fn named(&self, mut manifolds: Vec<Manifold>) -> Vec<Manifold> {
        for point in manifolds.iter_mut().flat_map(|manifold| &mut manifold.points) {
            if let Feature::Face(face) = point.id.feature_a {
                point.id.feature_a = Feature::Face(self.faces[face as usize]);
            }
        }
        sorted(manifolds)
    }

    /// Returns a place near the surface, in the frame of the field.
    fn place(&self, rng: &mut Rng) -> [f64; 3] {
        let [x, y] = self.field.spacing();
        let along = |rng: &mut Rng, count: usize| rng.integer(-1, 4 * count as i64) as f64 / 4.0;
        let [column, row] = [along(rng, self.field.columns()), along(rng, self.field.rows())];
        [column * x, row * y, rng.integer(-4, 6) as f64 / 4.0]
    }
}

fn sorted(mut manifolds: Vec<Manifold>) -> Vec<Manifold> {
    for manifold in &mut manifolds {
        manifold.points.sort_by_key(|point| point.id);
    }
    manifolds
}

/// Checks that manifolds have the same features, and equal numbers up to rounding: the mesh and the
/// field have boxes of other sizes, which are the unit of the arithmetic.
fn assert_same(found: &[Manifold], wanted: &[Manifold], context: &dyn Fn() -> String) {
    let are_near = |p: &[f64; 3], q: &[f64; 3]| (0..3).all(|k| (p[k] - q[k]).abs() <= 1e-9);
    assert_eq!(found.len(), wanted.len(), "{found:?} {wanted:?} {}", context());
    for (one, other) in found.iter().zip(wanted) {
        assert!(are_near(&one.normal, &other.normal), "{one:?} {other:?} {}", context());
        assert_eq!(one.points.len(), other.points.len(), "{one:?} {other:?} {}", context());
        for (p, q) in one.points.iter().zip(&other.points) {
            assert_eq!(p.id, q.id, "{one:?} {other:?} {}", context());
            assert!(are_near(&p.point_a, &q.point_a) && are_near(&p.point_b, &q.point_b), "{p:?} {q:?} {}", context());
            assert!(p.lower <= q.upper && q.lower <= p.upper, "{p:?} {q:?} {}", context());
        }
    }
}

/// Returns the identity, a turn by a right angle, a rotation or a shear.
fn any_pose(rng: &mut Rng) -> Pose {
    let linear = match rng.integer(0, 3) {
        0 => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        1 => [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
        2 => poses::rotation(rng).linear,
        _ => [[1.0, 0.5, 0.0], [0.0, 1.5, 0.25], [0.0, 0.0, -0.75]],
    };
    Pose::new(linear, [0; 3].map(|_| rng.integer(-4, 4) as f64 / 4.0)).unwrap()
}

#[test]
fn height_fields_and_shapes_answer_as_meshes_do() {
    let mut rng = Rng::new(721);
    let known = Known::all();
    let (mut meeting, mut apart, mut points) = (0, 0, 0);
    for round in 0..rounds(900) {
        let twin = Twin::random(&mut rng, true);
        let there = any_pose(&mut rng);
        let known = &known[round % known.len()];
        let mut place = if rng.one_in(2) { poses::rotation(&mut rng) } else { impinge_testkit::Affine::IDENTITY };
        place.translation = there.apply(twin.place(&mut rng));
        let other = known.shape().at(pose(&place)).unwrap();
        let [field, mesh] = twin.at(there);
        let context = || format!("{:?} {there:?} {known:?} {place:?}", twin.field);
        let proximity = query::proximity(&mesh, &other);
        assert_eq!(query::proximity(&field, &other), proximity, "{}", context());
        assert_eq!(query::proximity(&other, &field), proximity, "{}", context());
        for clearance in [0.25, 0.5, 3.0] {
            let within = query::within(&mesh, &other, clearance);
            assert_eq!(query::within(&field, &other, clearance), within, "{clearance} {}", context());
        }
        let [found, wanted] = [&field, &mesh].map(|surface| query::distance(surface, &other));
        assert_eq!((found.upper, found.proximity), (wanted.upper, wanted.proximity), "{}", context());
        assert!((found.lower - wanted.lower).abs() <= 1e-12 || wanted.lower == f64::INFINITY, "{}", context());
        let margin = rng.choose(&[0.0, 0.0, 0.25]);
        let options = ContactOptions { margin, ..ContactOptions::default() };
        let [found, wanted] =
            [&field, &mesh].map(|surface| Query::new().with_contacts(options).contacts(surface, &other));
        let wanted = twin.named(wanted);
        assert_same(&sorted(found), &wanted, &context);
        points += wanted.iter().map(|manifold| manifold.points.len()).sum::<usize>();
        let meets = query::intersects(&mesh, &other);
        (meeting, apart) = (meeting + usize::from(meets), apart + usize::from(!meets));
        let depth = query::penetration(&field, &other);
        assert_eq!(depth.is_some(), meets, "{}", context());
        if matches!(known, Known::HalfSpace(..)) {
            let wanted = query::penetration(&mesh, &other);
            assert_eq!(depth.map(|depth| depth.upper), wanted.map(|depth| depth.upper), "{}", context());
        }
    }
    assert!(meeting > 250 && apart > 250 && points > 400, "{meeting} {apart} {points}");
}

#[test]
fn height_fields_and_meshes_and_other_fields_answer_as_meshes_do() {
    let mut rng = Rng::new(722);
    let ball = engine(&icosphere(1));
    let (mut meeting, mut apart) = (0, 0);
    for _ in 0..rounds(150) {
        let (twin, other) = (Twin::random(&mut rng, true), Twin::random(&mut rng, true));
        let there = any_pose(&mut rng);
        let mut place = if rng.one_in(2) { poses::rotation(&mut rng) } else { impinge_testkit::Affine::IDENTITY };
        place.translation = there.apply(twin.place(&mut rng));
        let [field, mesh] = twin.at(there);
        let others = match rng.integer(0, 2) {
            0 => other.at(pose(&place)),
            1 => [0; 2].map(|_| Shape::mesh(&ball).at(pose(&place)).unwrap()),
            _ => [0; 2].map(|_| Shape::solid(&ball).at(pose(&place)).unwrap()),
        };
        let [other, other_mesh] = &others;
        let context = || format!("{:?} {there:?} {other:?} {place:?}", twin.field);
        let proximity = query::proximity(&mesh, other_mesh);
        assert_eq!(query::proximity(&field, other), proximity, "{}", context());
        assert_eq!(query::proximity(other, &field), proximity, "{}", context());
        assert_eq!(query::within(&field, other, 0.5), query::within(&mesh, other_mesh, 0.5), "{}", context());
        let (found, wanted) = (query::distance(&field, other), query::distance(&mesh, other_mesh));
        let is_near = |x: f64, y: f64| x == y || (x - y).abs() <= 1e-12;
        assert!(is_near(found.lower, wanted.lower) && is_near(found.upper, wanted.upper), "{found:?} {}", context());
        let meets = query::intersects(&mesh, other_mesh);
        assert_eq!(!query::contacts(&field, other).is_empty(), meets, "{}", context());
        (meeting, apart) = (meeting + usize::from(meets), apart + usize::from(!meets));
    }
    assert!(meeting > 30 && apart > 30, "{meeting} {apart}");
}

#[test]
fn rays_hit_height_fields_as_they_hit_meshes() {
    let mut rng = Rng::new(723);
    let (mut hits, mut misses, mut culled) = (0, 0, 0);
    for _ in 0..rounds(600) {
        let twin = Twin::random(&mut rng, true);
        for _ in 0..8 {
            let (origin, target) = (twin.place(&mut rng), twin.place(&mut rng));
            let direction: [f64; 3] = std::array::from_fn(|k| target[k] - origin[k]);
            if direction == [0.0; 3] {
                continue;
            }
            let ray = Ray::new(origin, direction).unwrap();
            let wanted = twin.mesh.ray_cast(&ray).map(|hit| (hit.t, twin.faces[hit.face as usize], hit.point));
            let found = twin.field.ray_cast(&ray).map(|hit| (hit.t, hit.face, hit.point));
            assert_eq!(found, wanted, "{:?} {ray:?}", twin.field);
            (hits, misses) = (hits + usize::from(found.is_some()), misses + usize::from(found.is_none()));
        }
        let there = any_pose(&mut rng);
        let [from, to] = [0; 2].map(|_| there.apply(twin.place(&mut rng)));
        let direction: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
        if direction == [0.0; 3] {
            continue;
        }
        for culls_back_faces in [false, true] {
            let ray = partition::Ray::new(from, direction, 2.0).unwrap();
            let cast = |shape: Shape| {
                let mut world = World::new();
                world.insert(Body::new(shape).at(there)).unwrap();
                let options = RayOptions { culls_back_faces };
                world.ray_cast_with(&ray, options, |_| true).map(|hit| (hit.t, hit.face, hit.point, hit.normal))
            };
            let found = cast(Shape::height_field(&twin.field));
            let wanted = cast(Shape::mesh(&twin.mesh));
            let wanted =
                wanted.map(|(t, face, point, normal)| (t, face.map(|face| twin.faces[face as usize]), point, normal));
            assert_eq!(found, wanted, "{:?} {there:?} {ray:?}", twin.field);
            culled += usize::from(culls_back_faces && found.is_none());
        }
    }
    assert!(hits > 800 && misses > 800 && culled > 100, "{hits} {misses} {culled}");
}

#[test]
fn shapes_land_on_height_fields_when_they_land_on_meshes() {
    let mut rng = Rng::new(724);
    let known = Known::all();
    let (mut hits, mut misses) = (0, 0);
    for round in 0..rounds(60) {
        let twin = Twin::random(&mut rng, true);
        let shape = &known[round % known.len()];
        if matches!(shape, Known::HalfSpace(..)) {
            continue;
        }
        let turn = poses::rotation(&mut rng).linear;
        let [mut from, to] = [0; 2].map(|_| twin.place(&mut rng));
        from[2] += 4.0;
        let fall = Motion::between(Pose::new(turn, from).unwrap(), Pose::new(turn, to).unwrap()).unwrap();
        let still = Motion::between(Pose::IDENTITY, Pose::IDENTITY).unwrap();
        let shape = shape.shape();
        let [found, wanted] = [Shape::height_field(&twin.field), Shape::mesh(&twin.mesh)]
            .map(|surface| time_of_impact(&surface, &shape, &still, &fall).unwrap());
        assert_eq!(found.hit(), wanted.hit(), "{found:?} {wanted:?}");
        assert!(found.t_lower <= wanted.t_upper && wanted.t_lower <= found.t_upper, "{found:?} {wanted:?}");
        assert!(!found.hit() || (found.t_lower - wanted.t_lower).abs() < 1e-9, "{found:?} {wanted:?}");
        (hits, misses) = (hits + usize::from(found.hit()), misses + usize::from(!found.hit()));
    }
    assert!(hits > 15 && misses > 5, "{hits} {misses}");
}

/// Checks bodies of a world on a height field, and a compound with a field as a part.
#[test]
fn worlds_and_compounds_of_height_fields_report_the_pairs_of_meshes() {
    let mut rng = Rng::new(725);
    let known = Known::all();
    let (mut touching, mut alone) = (0, 0);
    for _ in 0..rounds(15) {
        let twin = Twin::random(&mut rng, false);
        let there = any_pose(&mut rng);
        let bodies: Vec<(Shape, Pose)> = (0..12)
            .map(|_| {
                let mut place = poses::rotation(&mut rng);
                place.translation = there.apply(twin.place(&mut rng));
                (known[rng.integer(0, known.len() as i64 - 1) as usize].shape(), pose(&place))
            })
            .collect();
        let beside = (Shape::cuboid([0.25; 3]).unwrap(), at([0.0, 0.0, 9.0]));
        let report = |terrain: Shape| {
            let terrain = Shape::compound(&[(terrain, Pose::IDENTITY), beside.clone()]).unwrap();
            let mut world = World::new();
            world.insert(Body::new(terrain).at(there).tag(100)).unwrap();
            for (tag, (shape, pose)) in (0..).zip(&bodies) {
                world.insert(Body::new(shape.clone()).at(*pose).tag(tag)).unwrap();
            }
            let events = world.step(&[]).unwrap();
            events.began.iter().map(|key| [key.tag_a, key.tag_b]).collect::<Vec<[u64; 2]>>()
        };
        let found = report(Shape::height_field(&twin.field));
        assert_eq!(found, report(Shape::mesh(&twin.mesh)), "{:?}", twin.field);
        let with_terrain = found.iter().filter(|tags| tags.contains(&100)).count();
        (touching, alone) = (touching + with_terrain, alone + 12 - with_terrain);
    }
    assert!(touching > 30 && alone > 30, "{touching} {alone}");
}

/// Checks that a crate which slides over a flat field is only lifted, wherever it is.
#[test]
fn inner_edges_of_a_flat_height_field_are_no_obstacles() {
    let field = HeightField::new(20, 20, [0.5, 0.25], vec![0.0; 400]).unwrap();
    let terrain = Shape::height_field(&field).at(Pose::IDENTITY).unwrap();
    let mut rng = Rng::new(726);
    for body in [Shape::cuboid([0.4, 0.3, 0.2]), Shape::cuboid([0.3, 0.2, 0.1]).and_then(|core| core.rounded(0.1))] {
        let body = body.unwrap();
        for _ in 0..rounds(100) {
            let [x, y, down] = [rng.uniform(1.0, 8.0), rng.uniform(1.0, 3.5), rng.uniform(1e-4, 0.05)];
            let turn = Pose::from_axis_angle([0.0, 0.0, 1.0], rng.uniform(0.0, 6.0), [x, y, 0.2 - down]).unwrap();
            let found = query::contacts(&terrain, body.at(turn).unwrap());
            let [manifold] = &found[..] else { panic!("one manifold is expected, not {found:?}") };
            assert!(manifold.normal[2] > 1.0 - 1e-9 && manifold.points.len() == 4, "{found:?}");
        }
    }
}

#[test]
fn a_field_of_4096_by_4096_points_answers_from_its_heights_and_its_tree() {
    const SIDE: usize = 4096;
    let heights: Vec<f32> = (0..SIDE * SIDE).map(|at| ((at % SIDE) % 64) as f32 / 4.0).collect();
    let field = HeightField::new(SIDE, SIDE, [0.5, 0.5], heights).unwrap();
    let cells = (SIDE - 1) * (SIDE - 1);
    assert!(field.memory() as f64 <= 4.16 * cells as f64, "{}", field.memory());
    let terrain = Shape::height_field(&field).at(Pose::IDENTITY).unwrap();
    // The crest of a ridge is at x = 31.5 and at multiples of 32 from there.
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let over = |z: f64| ball.at(at([31.5 + 32.0 * 50.0, 1000.0, z])).unwrap();
    assert!(query::intersects(&terrain, over(16.75)) && !query::intersects(&terrain, over(17.0)));
    let found = query::distance(&terrain, over(100.0));
    assert!(found.lower <= 83.25 && 83.25 <= found.upper && found.upper - found.lower < 1e-9, "{found:?}");
    assert_eq!(query::contacts(&terrain, over(16.5)).len(), 1);
    let ray = Ray::new([5.0, 5.0, 15.7], [1.0, 1.0, 0.0]).unwrap();
    let hit = field.ray_cast(&ray).expect("the slope before a crest");
    assert!((hit.point[0] - 31.4).abs() < 1e-6 && field.face(hit.face).is_some(), "{hit:?}");
    let still = Motion::between(Pose::IDENTITY, Pose::IDENTITY).unwrap();
    let fall = Motion::between(at([1631.5, 1000.0, 116.75]), at([1631.5, 1000.0, 6.75])).unwrap();
    let impact = time_of_impact(&field, &ball, &still, &fall).unwrap();
    assert!(impact.t_lower <= 100.0 / 110.0 && impact.t_lower > 100.0 / 110.0 - 1e-6, "{impact:?}");
    let plane = Shape::half_space([0.0, 0.0, 1.0], 15.0).unwrap().at(Pose::IDENTITY).unwrap();
    assert!(query::intersects(&terrain, &plane));
}

#[test]
fn invalid_height_fields_are_rejected() {
    let kind = |rows, columns, spacing, heights: Vec<f32>| {
        HeightField::new(rows, columns, spacing, heights).unwrap_err().kind().clone()
    };
    assert_eq!(kind(1, 4, [1.0; 2], vec![0.0; 4]), InputErrorKind::Empty { what: "cells" });
    let other = InputErrorKind::OtherCount { what: "heights", count: 5, expected: 4 };
    assert_eq!(kind(2, 2, [1.0; 2], vec![0.0; 5]), other);
    let bad = kind(2, 2, [1.0; 2], vec![0.0, 0.0, f32::NAN, 0.0]);
    assert_eq!(bad, InputErrorKind::NonFinite { what: "height", index: 2 });
    assert!(matches!(kind(2, 2, [1.0, 0.0], vec![0.0; 4]), InputErrorKind::OutOfRange { index: 1, .. }));
    assert!(matches!(kind(2, 2, [f64::NAN, 1.0], vec![0.0; 4]), InputErrorKind::NonFinite { index: 0, .. }));
    assert!(matches!(kind(2, 2, [1e39, 1.0], vec![0.0; 4]), InputErrorKind::OutOfRange { index: 0, .. }));
    assert!(matches!(kind(1 << 40, 1 << 40, [1.0; 2], vec![]), InputErrorKind::TooMany { .. }));
    let empty = HeightField::with_holes(3, 3, [1.0; 2], vec![0.0; 9], |_, _| true).unwrap();
    let nothing = Shape::height_field(&empty).at(Pose::IDENTITY).unwrap();
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap().at(Pose::IDENTITY).unwrap();
    assert!(!query::intersects(&nothing, &ball) && nothing.bounds().is_none());
    assert_eq!(query::distance(&nothing, &ball).lower, f64::INFINITY);
    assert!(empty.ray_cast(&Ray::new([1.0, 1.0, 1.0], [0.0, 0.0, -1.0]).unwrap()).is_none());
}
