//! Meshes against other shapes: every face in rationals, closed forms, and invariants.

use std::sync::Arc;

use dashu_ratio::RBig;
use impinge::Pose;
use impinge::hull::Hull;
use impinge::query::{self, Feature, Proximity};
use impinge::shape::{PlacedShape, Shape};
use impinge_testkit::generate::solids::{cuboid, grid_soup, icosphere, plane_grid};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::oracle::squared_distance_of_hulls;
use impinge_testkit::{Affine, Mesh as Plain};

use crate::shapes::hulls::pose;
use crate::shapes::support::{IDENTITY, Known, at, dot, engine};

fn square(x: f64) -> RBig {
    let x = RBig::try_from(x).expect("finite");
    x.clone() * x
}

/// Returns the squared distance of a polytope from the nearest face.
fn truth(mesh: &Plain, place: &Affine, points: &[[f64; 3]], points_at: &Affine) -> RBig {
    let of_face = |face: &[u32; 3]| {
        squared_distance_of_hulls(&face.map(|vertex| mesh.vertices[vertex as usize]), place, points, points_at)
    };
    mesh.faces.iter().map(of_face).min().expect("faces")
}

/// Checks the verbs on two shapes whose squared distance is known, in both orders.
fn check_pair(a: &PlacedShape, b: &PlacedShape, truth: &RBig, context: &str) {
    let meets = *truth == RBig::ZERO;
    assert_eq!(query::intersects(a, b), meets, "{context}");
    assert_ne!(query::proximity(a, b), Proximity::Undecided, "{context}");
    let (found, back) = (query::distance(a, b), query::distance(b, a));
    assert_eq!((found.lower, found.upper), (back.lower, back.upper), "{context}");
    assert_eq!(found.distance() == 0.0, meets, "{found:?} {context}");
    assert!(square(found.lower) <= *truth && *truth <= square(found.upper), "{found:?} {context}");
    assert!(found.upper - found.lower <= 1e-9 * found.upper || found.upper < 1e-140, "{found:?} {context}");
    assert!(query::within(a, b, found.upper), "{found:?} {context}");
    assert!(meets || !query::within(a, b, found.lower.next_down()), "{found:?} {context}");
    assert_eq!(query::contacts(a, b).is_empty(), !meets, "{context}");
    // A soup is treated as a solid here, so shapes inside it count too.
    assert!(query::penetration(a, b).is_some() || !meets, "{context}");
}

/// Checks soups of small integers against boxes, hulls and points of small integers, which touch
/// often.
#[test]
fn faces_against_polytopes_agree_with_rationals() {
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
        check_pair(&surface, &shape, &truth, &format!("{mesh:?} {places:?} {points:?}"));
        let meets = truth == RBig::ZERO;
        meeting += usize::from(meets);
        apart += usize::from(!meets);
        touching += usize::from(meets && on_grid);
    }
    assert!(meeting > 15 && apart > 15 && touching > 8, "{meeting} {apart} {touching}");
}

/// Checks that the distance of every kind of shape from a mesh is that of the nearest face.
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
                    query::distance(&face, &shape)
                })
                .collect();
            let lower = faces.iter().map(|found| found.lower).fold(f64::INFINITY, f64::min);
            let upper = faces.iter().map(|found| found.upper).fold(f64::INFINITY, f64::min);
            let placed = Shape::mesh(&surface).at(pose(&place)).unwrap();
            let found = query::distance(&placed, &shape);
            assert!(
                (found.lower - lower).abs() <= 1e-13 && (found.upper - upper).abs() <= 1e-13,
                "{known:?} {found:?}"
            );
            let hits = faces.iter().filter(|found| found.proximity != Proximity::Apart).count();
            assert_eq!(query::intersects(&placed, &shape), hits > 0, "{known:?}");
            let contacts = query::contacts(&placed, &shape);
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

/// Checks that a solid contains shapes inside it and a surface does not, and that a shape contains
/// a mesh either way.
#[test]
fn solids_contain_shapes_inside_them() {
    let hall = engine(&cuboid([-2.0; 3], [2.0; 3]));
    let [surface, solid] = [Shape::mesh(&hall), Shape::solid(&hall)].map(|shape| shape.at(Pose::IDENTITY).unwrap());
    let small = engine(&cuboid([-0.25; 3], [0.25; 3]));
    let inside = [Shape::sphere([0.5, 0.0, 0.0], 0.5).unwrap(), Shape::cuboid([0.5; 3]).unwrap(), Shape::solid(&small)];
    for shape in inside {
        let (near, far) = (shape.at(at([0.0; 3])).unwrap(), shape.at(at([0.0, 0.0, 4.0])).unwrap());
        assert!(!query::intersects(&surface, &near) && query::intersects(&solid, &near), "{shape:?}");
        assert!(!query::intersects(&solid, &far) && query::distance(&solid, &far).lower > 1.0, "{shape:?}");
        let depth = query::penetration(&near, &solid).expect("inside");
        assert!(depth.lower > 1.0 && depth.lower <= depth.upper && depth.upper < 2.75, "{shape:?} {depth:?}");
        let contacts = query::contacts(&solid, &near);
        assert_eq!(contacts.len(), 1, "{shape:?}");
        assert!(contacts[0].points[0].upper >= 1.0, "{shape:?} {contacts:?}");
    }
    let around = Shape::sphere([0.0; 3], 9.0).unwrap().at(Pose::IDENTITY).unwrap();
    assert!(query::intersects(&surface, &around));
}

/// Checks that a box on a floor of many triangles has four contacts and the floor's normal,
/// wherever the edges of the triangles are.
#[test]
fn contacts_on_a_floor_of_triangles_have_one_normal() {
    let floor = engine(&plane_grid(16, 16));
    let bounds = Shape::mesh(&floor).at(Pose::IDENTITY).unwrap().bounds().unwrap();
    let center: [f64; 3] = std::array::from_fn(|k| 0.5 * (bounds[0][k] + bounds[1][k]));
    let size = (bounds[1][0] - bounds[0][0]).min(bounds[1][1] - bounds[0][1]);
    let half = 0.2 * size;
    let mut rng = Rng::new(573);
    let crate_ = Shape::cuboid([half; 3]).unwrap();
    let ball = Shape::sphere([0.0; 3], half).unwrap();
    let floor = Shape::mesh(&floor).at(Pose::IDENTITY).unwrap();
    for case in 0..6 {
        let depth = half * [0.0, 1e-3, 0.05][case % 3];
        let place = [center[0] + 0.1 * size * rng.uniform(-1.0, 1.0), center[1], center[2] + half - depth];
        let lying = query::contacts(&floor, crate_.at(at(place)).unwrap());
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
        let rolling = query::contacts(&floor, ball.at(at(place)).unwrap());
        assert_eq!(rolling.len(), 1, "{rolling:?}");
        assert!(rolling[0].normal[2] > 1.0 - 1e-3, "{rolling:?}");
    }
}

/// Checks a half-space against a mesh: the lowest vertex decides exactly.
#[test]
fn half_spaces_are_compared_with_the_lowest_vertex() {
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
            assert_eq!(query::intersects(&plane, &placed), meets);
            let found = query::distance(&placed, &plane);
            assert!((found.upper - if meets { 0.0 } else { 0.25 }).abs() < 1e-9, "{found:?}");
            let Some(depth) = query::penetration(&plane, &placed) else { continue };
            assert!((depth.upper - 0.25).abs() < 1e-9 && depth.upper - depth.lower < 1e-12, "{depth:?}");
            let contacts = query::contacts(&plane, &placed);
            assert_eq!(contacts.len(), 1);
            let deepest = contacts[0].points.iter().map(|p| p.upper).fold(0.0, f64::max);
            assert!((deepest - 0.25).abs() < 1e-9, "{contacts:?}");
            assert!(contacts[0].points.iter().all(|p| matches!(p.id.feature_b, Feature::Vertex(_))));
        }
    }
    // Touching exactly: a box on the floor, and one unit in the last place above it.
    let crate_ = Shape::mesh(&engine(&cuboid([0.0; 3], [1.0; 3])));
    let floor = Shape::half_space([0.0, 0.0, 3.0], 0.0).unwrap().at(Pose::IDENTITY).unwrap();
    assert!(query::intersects(&floor, crate_.at(Pose::IDENTITY).unwrap()));
    assert!(!query::intersects(&floor, crate_.at(at([0.0, 0.0, f64::MIN_POSITIVE])).unwrap()));
}
