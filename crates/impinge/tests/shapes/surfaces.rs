//! Meshes and compounds against everything else: every face in rationals, closed forms, laws.

use std::sync::Arc;

use dashu_ratio::RBig;
use impinge::hull::Hull;
use impinge::query::shapes::{self, Feature, Proximity};
use impinge::query::{contact_patches, intersecting_pairs};
use impinge::shape::{PlacedShape, Shape};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::{cuboid, grid_soup, icosphere, plane_grid};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::oracle::squared_distance_of_hulls;
use impinge_testkit::{Affine, Mesh as Plain};

use crate::hulls::pose;
use crate::support::{Known, dot};

const IDENTITY: Affine = Affine { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

fn engine(mesh: &Plain) -> Mesh {
    Mesh::new(Positions::F64(mesh.vertices.clone()), mesh.faces.clone()).expect("a legal mesh")
}

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("in range")
}

fn square(x: f64) -> RBig {
    let x = RBig::try_from(x).expect("finite");
    x.clone() * x
}

/// The square of the distance of a polytope from the nearest face.
fn truth(mesh: &Plain, place: &Affine, points: &[[f64; 3]], points_at: &Affine) -> RBig {
    let of_face = |face: &[u32; 3]| {
        squared_distance_of_hulls(&face.map(|vertex| mesh.vertices[vertex as usize]), place, points, points_at)
    };
    mesh.faces.iter().map(of_face).min().expect("faces")
}

/// What the verbs say of two shapes whose distance is the root of a rational, each way.
fn ask(a: &PlacedShape, b: &PlacedShape, truth: &RBig, context: &str) {
    let meets = *truth == RBig::ZERO;
    assert_eq!(shapes::intersects(a, b), meets, "{context}");
    assert_ne!(shapes::proximity(a, b), Proximity::Undecided, "{context}");
    let (found, back) = (shapes::distance(a, b), shapes::distance(b, a));
    assert_eq!((found.lower, found.upper), (back.lower, back.upper), "{context}");
    assert_eq!(found.distance() == 0.0, meets, "{found:?} {context}");
    assert!(square(found.lower) <= *truth && *truth <= square(found.upper), "{found:?} {context}");
    assert!(found.upper - found.lower <= 1e-9 * found.upper || found.upper < 1e-140, "{found:?} {context}");
    assert!(shapes::within(a, b, found.upper), "{found:?} {context}");
    assert!(meets || !shapes::within(a, b, found.lower.next_down()), "{found:?} {context}");
    assert_eq!(shapes::contacts(a, b).is_empty(), !meets, "{context}");
    assert_eq!(shapes::penetration(a, b).is_some(), meets, "{context}");
}

/// Soups of small integers against boxes, hulls and points of small integers: much of it touches.
#[test]
fn faces_against_polytopes_are_as_the_rationals_say() {
    let mut rng = Rng::new(571);
    let (mut meeting, mut touching, mut apart) = (0, 0, 0);
    for case in 0..90 {
        let mesh = grid_soup(&mut rng, 12, 2, 3);
        let on_grid = rng.one_in(2);
        let mut places = if on_grid { [IDENTITY; 2] } else { [poses::rotation(&mut rng), poses::rotation(&mut rng)] };
        if rng.one_in(4) {
            places[1] = places[0];
        }
        let spread = if on_grid { 3 } else { 2 };
        places[1].translation =
            std::array::from_fn(|k| places[0].translation[k] + rng.integer(-spread, spread) as f64 / 2.0);
        let half: [f64; 3] = std::array::from_fn(|_| rng.integer(0, 2) as f64 / 2.0);
        let (shape, points): (Shape, Vec<[f64; 3]>) = match case % 3 {
            0 => {
                let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { half[k] } else { -half[k] });
                (Shape::cuboid(half).unwrap(), (0..8).map(corner).collect())
            }
            1 => {
                let points: Vec<[f64; 3]> =
                    (0..6).map(|_| std::array::from_fn(|_| rng.integer(-1, 1) as f64)).collect();
                (Shape::hull(Arc::new(Hull::new(&points).unwrap())), points)
            }
            _ => {
                let point: [f64; 3] = std::array::from_fn(|_| rng.integer(-2, 2) as f64);
                (Shape::point(point).unwrap(), vec![point])
            }
        };
        let truth = truth(&mesh, &places[0], &points, &places[1]);
        let surface = Shape::mesh(&engine(&mesh)).at(pose(&places[0])).unwrap();
        let shape = shape.at(pose(&places[1])).unwrap();
        ask(&surface, &shape, &truth, &format!("{mesh:?} {places:?} {points:?}"));
        let meets = truth == RBig::ZERO;
        meeting += usize::from(meets);
        apart += usize::from(!meets);
        touching += usize::from(meets && on_grid);
    }
    assert!(meeting > 15 && apart > 15 && touching > 8, "{meeting} {apart} {touching}");
}

/// Every kind of shape against a mesh: the distance is that of the nearest face, asked one by one.
#[test]
fn every_kind_is_as_far_from_a_mesh_as_from_its_nearest_face() {
    let mesh = icosphere(1);
    let surface = engine(&mesh);
    let mut rng = Rng::new(572);
    let (mut meeting, mut apart) = (0, 0);
    for known in Known::all() {
        for reach in [0.5, 2.5] {
            let place = poses::rotation(&mut rng);
            let mut other = poses::rotation(&mut rng);
            other.translation = std::array::from_fn(|k| place.translation[k] + reach * rng.uniform(-1.0, 1.0));
            let shape = known.shape().at(pose(&other)).unwrap();
            let faces: Vec<_> = mesh
                .faces
                .iter()
                .map(|face| {
                    let corners = face.map(|vertex| mesh.vertices[vertex as usize]);
                    let face = Shape::triangle(corners).unwrap().at(pose(&place)).unwrap();
                    shapes::distance(&face, &shape)
                })
                .collect();
            let lower = faces.iter().map(|found| found.lower).fold(f64::INFINITY, f64::min);
            let upper = faces.iter().map(|found| found.upper).fold(f64::INFINITY, f64::min);
            let placed = Shape::mesh(&surface).at(pose(&place)).unwrap();
            let found = shapes::distance(&placed, &shape);
            assert!(
                (found.lower - lower).abs() <= 1e-13 && (found.upper - upper).abs() <= 1e-13,
                "{known:?} {found:?}"
            );
            let hits = faces.iter().filter(|found| found.proximity != Proximity::Apart).count();
            assert_eq!(shapes::intersects(&placed, &shape), hits > 0, "{known:?}");
            let contacts = shapes::contacts(&placed, &shape);
            assert_eq!(contacts.is_empty(), hits == 0, "{known:?}");
            for manifold in &contacts {
                assert!((dot(&manifold.normal, &manifold.normal) - 1.0).abs() < 1e-14);
                assert!((1..=4).contains(&manifold.points.len()));
                assert!(manifold.points.iter().all(|p| p.point_a.iter().chain(&p.point_b).all(|x| x.is_finite())));
            }
            meeting += usize::from(hits > 0);
            apart += usize::from(hits == 0);
        }
    }
    assert!(meeting > 6 && apart > 4, "{meeting} {apart}");
}

/// A solid holds what is inside it, a surface does not; a shape holds a mesh either way.
#[test]
fn solids_hold_what_is_inside() {
    let hall = engine(&cuboid([-2.0; 3], [2.0; 3]));
    let [surface, solid] = [Shape::mesh(&hall), Shape::solid(&hall)].map(|shape| shape.at(Pose::IDENTITY).unwrap());
    let small = engine(&cuboid([-0.25; 3], [0.25; 3]));
    let inside = [Shape::sphere([0.5, 0.0, 0.0], 0.5).unwrap(), Shape::cuboid([0.5; 3]).unwrap(), Shape::solid(&small)];
    for shape in inside {
        let (near, far) = (shape.at(at([0.0; 3])).unwrap(), shape.at(at([0.0, 0.0, 4.0])).unwrap());
        assert!(!shapes::intersects(&surface, &near) && shapes::intersects(&solid, &near), "{shape:?}");
        assert!(!shapes::intersects(&solid, &far) && shapes::distance(&solid, &far).lower > 1.0, "{shape:?}");
        let depth = shapes::penetration(&near, &solid).expect("inside");
        assert!(depth.lower > 1.0 && depth.lower <= depth.upper && depth.upper < 2.75, "{shape:?} {depth:?}");
        let contacts = shapes::contacts(&solid, &near);
        assert_eq!(contacts.len(), 1, "{shape:?}");
        assert!(contacts[0].points[0].upper >= 1.0, "{shape:?} {contacts:?}");
    }
    let around = Shape::sphere([0.0; 3], 9.0).unwrap().at(Pose::IDENTITY).unwrap();
    assert!(shapes::intersects(&surface, &around));
}

/// A box on a floor of many triangles has its four corners and no normal but the floor's, wherever the triangles' edges are.
#[test]
fn floors_of_triangles_have_one_normal() {
    let floor = engine(&plane_grid(16, 16));
    let bounds = Shape::mesh(&floor).at(Pose::IDENTITY).unwrap().bounds().unwrap();
    let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (bounds[0][k] + bounds[1][k]));
    let size = (bounds[1][0] - bounds[0][0]).min(bounds[1][1] - bounds[0][1]);
    let half = 0.2 * size;
    let mut rng = Rng::new(573);
    let crate_ = Shape::cuboid([half; 3]).unwrap();
    let ball = Shape::sphere([0.0; 3], half).unwrap();
    let floor = Shape::mesh(&floor).at(Pose::IDENTITY).unwrap();
    for case in 0..6 {
        let depth = half * [0.0, 1e-3, 0.05][case % 3];
        let place = [centre[0] + 0.1 * size * rng.uniform(-1.0, 1.0), centre[1], centre[2] + half - depth];
        let lying = shapes::contacts(&floor, &crate_.at(at(place)).unwrap());
        assert_eq!(lying.len(), 1, "{lying:?}");
        assert!(lying[0].normal[2] > 1.0 - 1e-12, "{lying:?}");
        assert_eq!(lying[0].points.len(), 4, "{lying:?}");
        for point in &lying[0].points {
            assert!((point.upper - depth).abs() < 1e-9 * size, "{point:?} {depth}");
        }
        let spread = |k: usize| {
            let at = lying[0].points.iter().map(|point| point.point_b[k]);
            at.clone().fold(f64::NEG_INFINITY, f64::max) - at.fold(f64::INFINITY, f64::min)
        };
        assert!((spread(0) - 2.0 * half).abs() < 1e-9 && (spread(1) - 2.0 * half).abs() < 1e-9, "{lying:?}");
        let rolling = shapes::contacts(&floor, &ball.at(at(place)).unwrap());
        assert_eq!(rolling.len(), 1, "{rolling:?}");
        assert!(rolling[0].normal[2] > 1.0 - 1e-3, "{rolling:?}");
    }
}

/// A half-space against a mesh: the lowest vertex, exactly.
#[test]
fn half_spaces_reach_to_the_lowest_vertex() {
    let mesh = icosphere(2);
    let surface = engine(&mesh);
    let mut rng = Rng::new(574);
    for _ in 0..20 {
        let place = poses::rotation(&mut rng);
        let n: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
        let plane = Shape::half_space(n, 0.0).unwrap();
        let image =
            |v: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| dot(&place.linear[k], v) + place.translation[k]) };
        let length = dot(&n, &n).sqrt();
        let lowest = mesh.vertices.iter().map(|v| dot(&n, &image(v)) / length).fold(f64::INFINITY, f64::min);
        let placed = Shape::solid(&surface).at(pose(&place)).unwrap();
        for (level, meets) in [(lowest + 0.25, true), (lowest - 0.25, false)] {
            let shift: [f64; 3] = std::array::from_fn(|k| n[k] / length * level);
            let plane = plane.at(at(shift)).unwrap();
            assert_eq!(shapes::intersects(&plane, &placed), meets);
            let found = shapes::distance(&placed, &plane);
            assert!((found.upper - if meets { 0.0 } else { 0.25 }).abs() < 1e-9, "{found:?}");
            let Some(depth) = shapes::penetration(&plane, &placed) else { continue };
            assert!((depth.upper - 0.25).abs() < 1e-9 && depth.upper - depth.lower < 1e-12, "{depth:?}");
            let contacts = shapes::contacts(&plane, &placed);
            assert_eq!(contacts.len(), 1);
            let deepest = contacts[0].points.iter().map(|p| p.upper).fold(0.0, f64::max);
            assert!((deepest - 0.25).abs() < 1e-9, "{contacts:?}");
            assert!(contacts[0].points.iter().all(|p| matches!(p.id.feature_b, Feature::Vertex(_))));
        }
    }
    // Touching to the last digit: a box on the floor, and one unit in the last place above it.
    let crate_ = Shape::mesh(&engine(&cuboid([0.0; 3], [1.0; 3])));
    let floor = Shape::half_space([0.0, 0.0, 3.0], 0.0).unwrap().at(Pose::IDENTITY).unwrap();
    assert!(shapes::intersects(&floor, &crate_.at(Pose::IDENTITY).unwrap()));
    assert!(!shapes::intersects(&floor, &crate_.at(at([0.0, 0.0, f64::MIN_POSITIVE])).unwrap()));
}

/// A compound is what its parts are, and names them.
#[test]
fn compounds_are_their_parts() {
    let mut rng = Rng::new(575);
    let all = Known::all();
    let finite: Vec<&Known> = all.iter().filter(|known| !matches!(known, Known::HalfSpace(..))).collect();
    let mesh = Shape::solid(&engine(&icosphere(1)));
    let (mut meeting, mut apart) = (0, 0);
    for _ in 0..16 {
        let mut parts: Vec<(Shape, Pose)> = (0..3)
            .map(|_| {
                let mut place = poses::rotation(&mut rng);
                place.translation = std::array::from_fn(|_| rng.uniform(-2.0, 2.0));
                (rng.choose(&finite).shape(), pose(&place))
            })
            .collect();
        parts.push((mesh.clone(), at([0.0, 0.0, 3.0])));
        let compound = Shape::compound(&parts).unwrap().at(Pose::IDENTITY).unwrap();
        let mut place = poses::rotation(&mut rng);
        place.translation = std::array::from_fn(|_| rng.uniform(-3.0, 3.0));
        let other = rng.choose(&finite).shape().at(pose(&place)).unwrap();
        let singles: Vec<PlacedShape> = parts.iter().map(|(shape, pose)| shape.at(*pose).unwrap()).collect();
        let found = shapes::distance(&compound, &other);
        let least = singles.iter().map(|part| shapes::distance(part, &other).upper).fold(f64::INFINITY, f64::min);
        assert_eq!(found.upper, least);
        let hits = singles.iter().any(|part| shapes::intersects(part, &other));
        assert_eq!(shapes::intersects(&compound, &other), hits);
        let contacts = shapes::contacts(&other, &compound);
        let touched = |part: u32| contacts.iter().flat_map(|m| &m.points).any(|point| point.id.part_b == part);
        for (part, single) in (0..).zip(&singles) {
            assert_eq!(touched(part), shapes::intersects(single, &other));
        }
        if let Some(depth) = shapes::penetration(&compound, &other) {
            let by: [f64; 3] = std::array::from_fn(|k| depth.normal[k] * depth.upper * (1.0 + 1e-9));
            let pose = other.world_from_local();
            let moved = Pose::new(*pose.linear(), std::array::from_fn(|k| pose.translation()[k] + by[k])).unwrap();
            assert!(depth.lower <= depth.upper && depth.upper.is_finite(), "{depth:?}");
            // Each part is at least as deep as all are at least.
            let deepest = singles.iter().filter_map(|part| shapes::penetration(part, &other)).map(|d| d.lower);
            assert!(deepest.fold(0.0, f64::max) <= depth.upper * (1.0 + 1e-9), "{depth:?}");
            assert!(moved.translation().iter().all(|x| x.is_finite()));
            meeting += 1;
        } else {
            apart += 1;
        }
    }
    assert!(meeting > 1 && apart > 1, "{meeting} {apart}");
}

/// A compound of many parts, which has a tree, says what all its parts say one by one; beside single shapes, other compounds and
/// half-spaces, and with a half-space among its parts.
#[test]
fn many_parts_are_asked_by_a_tree() {
    let mut rng = Rng::new(577);
    let all = Known::all();
    let finite: Vec<&Known> = all.iter().filter(|known| !matches!(known, Known::HalfSpace(..))).collect();
    let scattered = |rng: &mut Rng, count: usize, reach: f64| -> Vec<(Shape, Pose)> {
        let part = |rng: &mut Rng| {
            let mut place = poses::rotation(rng);
            // On a grid, so that parts are as near as others.
            let step = |rng: &mut Rng| 3.0 * rng.integer(-4, 4) as f64;
            place.translation = [step(rng), step(rng), if rng.one_in(2) { step(rng) } else { reach * rng.unit() }];
            (rng.choose(&finite).shape(), pose(&place))
        };
        (0..count).map(|_| part(rng)).collect()
    };
    let (mut meeting, mut apart, mut contacts) = (0, 0, 0);
    for case in 0..24 {
        let mut parts = scattered(&mut rng, 150, 9.0);
        if case % 6 >= 3 {
            parts[70] = (Shape::half_space([0.0, 0.0, 1.0], -40.0).unwrap(), Pose::IDENTITY);
        }
        let others = match case % 3 {
            0 => scattered(&mut rng, 1, 40.0),
            1 => scattered(&mut rng, 40, 40.0),
            _ => vec![(Shape::half_space([0.0, 1.0, 1.0], -16.0).unwrap(), Pose::IDENTITY)],
        };
        let shift = at([0.0, 0.0, if case % 2 == 0 { 0.0 } else { 16.0 }]);
        let compound = Shape::compound(&parts).unwrap().at(Pose::IDENTITY).unwrap();
        let other = Shape::compound(&others).unwrap().at(shift).unwrap();
        let singles = |parts: &[(Shape, Pose)], by: &Pose| -> Vec<PlacedShape> {
            parts.iter().map(|(shape, place)| shape.at(by.compose(place).unwrap()).unwrap()).collect()
        };
        let (ours, theirs) = (singles(&parts, &Pose::IDENTITY), singles(&others, &shift));
        let pairs = || ours.iter().flat_map(|part| theirs.iter().map(move |other| (part, other)));
        let least = pairs().map(|(part, other)| shapes::distance(part, other).upper).fold(f64::INFINITY, f64::min);
        let found = shapes::distance(&compound, &other);
        assert_eq!(found.upper, least, "{case}");
        assert_eq!(shapes::distance(&other, &compound).upper, least, "{case}");
        assert!(found.lower <= least);
        let hit = pairs().any(|(part, other)| shapes::intersects(part, other));
        assert_eq!(shapes::intersects(&compound, &other), hit, "{case}");
        for clearance in [0.5 * least, least, 1.5 * least] {
            let near = pairs().any(|(part, other)| shapes::within(part, other, clearance));
            assert_eq!(shapes::within(&compound, &other, clearance), near, "{case} {clearance}");
        }
        let named: Vec<[u32; 2]> = {
            let manifolds = shapes::contacts(&compound, &other);
            manifolds.iter().flat_map(|m| &m.points).map(|point| [point.id.part_a, point.id.part_b]).collect()
        };
        assert!(named.is_sorted(), "{named:?}");
        for (i, part) in (0..).zip(&ours) {
            for (j, other) in (0..).zip(&theirs) {
                assert_eq!(named.contains(&[i, j]), shapes::intersects(part, other), "{case} {i} {j}");
            }
        }
        contacts += named.len();
        meeting += usize::from(hit);
        apart += usize::from(!hit);
    }
    assert!(meeting > 5 && apart > 5 && contacts > 40, "{meeting} {apart} {contacts}");
}

/// Two spheres that overlap by one half, of ever smaller triangles: the depth closes in on one half from both sides.
#[test]
fn depths_of_refined_spheres_converge() {
    let mut widths = Vec::new();
    for (subdivisions, wanted) in [(1, 0.2), (2, 0.05), (3, 0.0125)] {
        let sphere = Shape::solid(&engine(&icosphere(subdivisions)));
        let [a, b] = [[0.0; 3], [1.5, 0.0, 0.0]].map(|place| sphere.at(at(place)).unwrap());
        let depth = shapes::penetration(&a, &b).expect("they overlap");
        assert!(depth.lower <= depth.upper, "{depth:?}");
        assert!((depth.lower - 0.5).abs() < wanted && (depth.upper - 0.5).abs() < wanted, "{subdivisions} {depth:?}");
        assert!(depth.normal[0] > 1.0 - wanted, "{depth:?}");
        let moved = |by: f64| sphere.at(at([1.5 + depth.normal[0] * by, depth.normal[1] * by, depth.normal[2] * by]));
        assert!(!shapes::intersects(&a, &moved(depth.upper * (1.0 + 1e-9)).unwrap()), "{depth:?}");
        assert!(shapes::intersects(&a, &moved(depth.lower * (1.0 - 1e-9)).unwrap()), "{depth:?}");
        widths.push(depth.upper - depth.lower);
    }
    assert!(widths.iter().all(|&width| width < 1e-3), "{widths:?}");
}

/// Two boxes as meshes have the depth that they have as boxes, and a region for each place in which they meet.
#[test]
fn boxes_as_meshes_are_as_deep_as_boxes() {
    let mesh = engine(&cuboid([-0.5; 3], [0.5; 3]));
    let (solid, plain) = (Shape::solid(&mesh), Shape::cuboid([0.5; 3]).unwrap());
    let mut rng = Rng::new(576);
    for case in 0..8 {
        let mut place = if case % 2 == 0 { IDENTITY } else { poses::rotation(&mut rng) };
        place.translation = [0.25 + 0.5 * rng.unit(), 0.25 * rng.uniform(-1.0, 1.0), 0.25 * rng.uniform(-1.0, 1.0)];
        let here = |shape: &Shape| shape.at(Pose::IDENTITY).unwrap();
        let there = |shape: &Shape| shape.at(pose(&place)).unwrap();
        let truth = shapes::penetration(&here(&plain), &there(&plain)).expect("they overlap");
        for (a, b) in [(&solid, &solid), (&solid, &plain), (&plain, &solid)] {
            let depth = shapes::penetration(&here(a), &there(b)).expect("they overlap");
            assert!(depth.lower <= truth.upper && truth.lower <= depth.upper, "{depth:?} {truth:?}");
            // The way out of hulls, which is that of convex shapes, is among those that are tried.
            assert!(depth.upper <= truth.upper * (1.0 + 1e-6) + 1e-6, "{case} {depth:?} {truth:?}");
        }
    }
    // On a plate, a little in it: one region, whose normal, area and depth are those of the common box.
    let plate = engine(&cuboid([-2.0, -2.0, -0.5], [2.0, 2.0, 0.5]));
    let on_top = mesh.at(at([0.25, 0.25, 0.875]));
    let patches = contact_patches(&plate, on_top);
    assert_eq!(patches.len(), 1);
    let patch = &patches[0];
    assert!(patch.normal[2] > 1.0 - 1e-12 && (patch.area - 1.0).abs() < 1e-12, "{patch:?}");
    assert!((patch.depth - 0.125).abs() < 1e-12, "{patch:?}");
    assert_eq!(patch.pairs, intersecting_pairs(&plate, on_top));
}

/// Regions of two spheres: one, round; of two pairs of spheres: two, in the place of either pair.
#[test]
fn regions_of_spheres_are_discs() {
    let sphere = icosphere(3);
    let far = {
        let mut far = sphere.clone();
        far.vertices.iter_mut().for_each(|v| v[1] += 4.0);
        far
    };
    let (one, two) = (engine(&sphere), engine(&sphere.clone().joined(&far)));
    for (mesh, count) in [(&one, 1), (&two, 2)] {
        let patches = contact_patches(mesh, mesh.at(at([0.125, 0.0, 1.5])));
        assert_eq!(patches.len(), count);
        let direction = [0.125, 0.0, 1.5];
        let apart = dot(&direction, &direction).sqrt();
        for patch in &patches {
            assert!(dot(&patch.normal, &direction) / apart > 0.999, "{patch:?}");
            let radius_squared = 1.0 - apart * apart / 4.0;
            assert!((patch.area / (std::f64::consts::PI * radius_squared) - 1.0).abs() < 0.05, "{}", patch.area);
            assert!((patch.depth - (2.0 - apart)).abs() < 0.03, "{}", patch.depth);
            assert_eq!(patch.curves.closed(), 1);
            assert!(patch.inside.iter().all(|inside| inside.len() > 8), "{:?}", patch.inside);
        }
        let solid = Shape::solid(mesh);
        let contacts = shapes::contacts(&solid.at(Pose::IDENTITY).unwrap(), &solid.at(at([0.125, 0.0, 1.5])).unwrap());
        assert_eq!(contacts.len(), count);
        for manifold in &contacts {
            assert_eq!(manifold.points.len(), 4);
            let deepest = manifold.points.iter().map(|point| point.upper).fold(0.0, f64::max);
            assert!((deepest - (2.0 - apart)).abs() < 0.03, "{manifold:?}");
        }
    }
}
