//! Contact manifolds: closed forms, and properties of every pair of shapes.

use impinge::Pose;
use impinge::query::{self, ContactOptions, Feature, Manifold, Query};
use impinge::shape::Shape;
use impinge_testkit::Affine;
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::pairs::{Placed, directions, gap_along, holds};
use crate::shapes::support::{Known, dot};

fn only(manifolds: Vec<Manifold>) -> Manifold {
    assert_eq!(manifolds.len(), 1, "{manifolds:?}");
    manifolds.into_iter().next().expect("one")
}

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("in range")
}

fn sub(p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| p[k] - q[k])
}

/// Checks the properties of a manifold of a pair within `margin`, and returns its number of points.
fn check(a: &Placed, b: &Placed, manifold: &Manifold, margin: f64) -> usize {
    let context = || format!("{:?} {:?} against {:?} {:?}: {manifold:?}", a.known, a.place, b.known, b.place);
    let n = manifold.normal;
    assert!((dot(&n, &n) - 1.0).abs() < 1e-14, "{}", context());
    let along_normal = -gap_along(a, b, &n);
    let directions = directions(a, b);
    let most = manifold.points.len();
    assert!((1..=4).contains(&most), "{}", context());
    let mut deepest = f64::NEG_INFINITY;
    for point in &manifold.points {
        let between = dot(&n, &sub(&point.point_a, &point.point_b));
        assert!(point.lower <= point.upper && point.upper - point.lower < 1e-12, "{}", context());
        assert!((between - 0.5 * (point.lower + point.upper)).abs() < 1e-12, "{}", context());
        assert!(point.upper >= -margin || most == 1, "{}", context());
        // Both points are in their shapes, so no contact is deeper than the overlap along the
        // normal.
        assert!(holds(a, &point.point_a, &directions) && holds(b, &point.point_b, &directions), "{}", context());
        if along_normal.is_finite() {
            assert!(point.lower <= along_normal + 1e-12, "{along_normal} {}", context());
        }
        deepest = deepest.max(point.upper);
    }
    if along_normal.is_finite() {
        assert!(deepest >= along_normal - 1e-3, "{along_normal} {}", context());
    }
    let ids: Vec<_> = manifold.points.iter().map(|point| point.id).collect();
    assert!(ids.windows(2).all(|pair| pair[0] < pair[1]), "{}", context());
    most
}

#[test]
fn every_pair_has_contacts_exactly_if_it_intersects() {
    let all = Known::all();
    let mut rng = Rng::new(561);
    let (mut meeting, mut several, mut near) = (0, 0, 0);
    for a in &all {
        for b in &all {
            for reach in [0.5, 1.0, 2.0, 2.5] {
                let mut places = [poses::rotation(&mut rng), poses::rotation(&mut rng)];
                if rng.one_in(3) {
                    places[1] = places[0];
                }
                places[1].translation =
                    std::array::from_fn(|k| places[0].translation[k] + reach * rng.uniform(-1.0, 1.0));
                let (a, b) = (Placed::new(a, places[0]), Placed::new(b, places[1]));
                let found = query::contacts(&a.shape, &b.shape);
                assert_eq!(!found.is_empty(), query::intersects(&a.shape, &b.shape));
                let swapped = query::contacts(&b.shape, &a.shape);
                assert_eq!(found.len(), swapped.len());
                if !found.is_empty() {
                    let (manifold, back) = (only(found), only(swapped));
                    let is_plane = |placed: &Placed| matches!(placed.known, Known::HalfSpace(..));
                    if !(is_plane(&a) && is_plane(&b)) {
                        assert_eq!(manifold.normal, back.normal.map(|x| 0.0 - x));
                        let mut ids: Vec<_> =
                            back.points.iter().map(|p| (p.id.feature_b, p.id.feature_a, p.upper)).collect();
                        ids.sort_by_key(|id| (id.0, id.1));
                        let forward: Vec<_> =
                            manifold.points.iter().map(|p| (p.id.feature_a, p.id.feature_b, p.upper)).collect();
                        assert_eq!(forward, ids, "{:?} {:?} {manifold:?} {back:?}", a.known, b.known);
                        several += usize::from(check(&a, &b, &manifold, 0.0) > 1);
                    }
                    meeting += 1;
                } else {
                    let margin = query::distance(&a.shape, &b.shape).upper * 1.01;
                    let options = ContactOptions { margin, ..ContactOptions::default() };
                    let manifold = only(Query::new().with_contacts(options).contacts(&a.shape, &b.shape));
                    check(&a, &b, &manifold, margin);
                    assert!(manifold.points.iter().all(|point| point.lower < 0.0));
                    near += 1;
                }
            }
        }
    }
    assert!(meeting > 250 && near > 100 && several > 40, "{meeting} {near} {several}");
}

/// Checks a box in line on another box, turned on it, hanging over it, and on a floor: contacts are
/// the corners of the common polygon.
#[test]
fn boxes_on_boxes_have_the_corners_of_the_common_polygon() {
    let unit = Shape::cuboid([0.5; 3]).unwrap();
    let all = ContactOptions { most_points: usize::MAX, ..ContactOptions::default() };
    let base = unit.at(Pose::IDENTITY).unwrap();
    // In line and touching: four contacts, each at a corner of both boxes.
    let stacked = only(Query::new().with_contacts(all).contacts(&base, unit.at(at([0.0, 0.0, 1.0])).unwrap()));
    assert_eq!(stacked.normal, [0.0, 0.0, 1.0]);
    assert_eq!(stacked.points.len(), 4);
    assert!(stacked.points.iter().all(|p| p.lower <= 0.0 && 0.0 <= p.upper && p.point_a[2] == 0.5));
    // Turned by 45 degrees: an octagon of crossings.
    let turned = Pose::from_axis_angle([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_4, [0.0, 0.0, 0.875]).unwrap();
    let octagon = only(Query::new().with_contacts(all).contacts(&base, unit.at(turned).unwrap()));
    assert_eq!(octagon.points.len(), 8, "{octagon:?}");
    for point in &octagon.points {
        assert!(matches!((point.id.feature_a, point.id.feature_b), (Feature::Edge(..), Feature::Edge(..))));
        assert!(point.lower <= 0.125 && 0.125 <= point.upper);
        let [x, y, _] = point.point_a.map(f64::abs);
        assert!((x.max(y) - 0.5).abs() < 1e-12 && (x.min(y) - (0.5_f64.sqrt() - 0.5)).abs() < 1e-12, "{point:?}");
    }
    // Four contacts reach as far as all eight.
    let four = only(query::contacts(&base, unit.at(turned).unwrap()));
    assert_eq!(four.points.len(), 4);
    assert!(four.points.iter().all(|point| octagon.points.contains(point)));
    let spread = |k: usize| four.points.iter().map(|p| p.point_a[k].abs()).fold(0.0, f64::max);
    assert!(spread(0) > 0.45 && spread(1) > 0.45, "{four:?}");
    // Hanging over two sides: one corner of either box, and two crossings.
    let over = only(query::contacts(&base, unit.at(at([0.75, 0.75, 0.9375])).unwrap()));
    let kinds: Vec<_> = over.points.iter().map(|p| (p.id.feature_a, p.id.feature_b)).collect();
    let corners = kinds.iter().filter(|kind| matches!(kind, (Feature::Vertex(_), Feature::Face(_)))).count();
    let others = kinds.iter().filter(|kind| matches!(kind, (Feature::Face(_), Feature::Vertex(_)))).count();
    let crossings = kinds.iter().filter(|kind| matches!(kind, (Feature::Edge(..), Feature::Edge(..)))).count();
    assert_eq!((corners, others, crossings), (1, 1, 2), "{kinds:?}");
    assert!(over.points.iter().any(|p| p.id.feature_a == Feature::Vertex(7)));
    assert!(over.points.iter().any(|p| p.id.feature_b == Feature::Vertex(0)));
    // On the floor: the four lower corners.
    let floor = Shape::half_space([0.0, 0.0, 1.0], -0.5).unwrap().at(Pose::IDENTITY).unwrap();
    let standing = only(query::contacts(&floor, &base));
    let lower: Vec<_> = standing.points.iter().map(|p| p.id.feature_b).collect();
    assert_eq!(lower, [0, 1, 2, 3].map(Feature::Vertex));
}

#[test]
fn crossed_edges_have_one_contact() {
    let unit = Shape::cuboid([0.5; 3]).unwrap();
    let eighth = std::f64::consts::FRAC_PI_4;
    let roof = Pose::from_axis_angle([1.0, 0.0, 0.0], eighth, [0.0; 3]).unwrap();
    let keel = Pose::from_axis_angle([0.0, 1.0, 0.0], eighth, [0.0, 0.0, 2.0_f64.sqrt() - 0.0625]).unwrap();
    let crossed = only(query::contacts(unit.at(roof).unwrap(), unit.at(keel).unwrap()));
    assert!(crossed.normal[2] > 1.0 - 1e-12, "{crossed:?}");
    assert_eq!(crossed.points.len(), 1, "{crossed:?}");
    let point = crossed.points[0];
    assert!((point.upper - 0.0625).abs() < 1e-12, "{point:?}");
    assert_eq!((point.id.feature_a, point.id.feature_b), (Feature::Edge(6, 7), Feature::Edge(1, 3)));
}

/// Checks capsules and cylinders that lie on two points, stand on one or several, and touch each
/// other.
#[test]
fn lying_and_standing_round_shapes_have_their_contacts() {
    let base = Shape::cuboid([2.0, 2.0, 0.5]).unwrap().at(Pose::IDENTITY).unwrap();
    let pill = Shape::capsule([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25).unwrap();
    let lying = only(query::contacts(&base, pill.at(at([0.0, 0.0, 0.625])).unwrap()));
    let ends: Vec<_> = lying.points.iter().map(|p| (p.id.feature_b, p.point_b)).collect();
    assert_eq!(ends.len(), 2, "{lying:?}");
    assert_eq!(ends[0], (Feature::Vertex(0), [-1.0, 0.0, 0.375]));
    assert_eq!(ends[1], (Feature::Vertex(1), [1.0, 0.0, 0.375]));
    let upright = Pose::from_axis_angle([0.0, 1.0, 0.0], std::f64::consts::FRAC_PI_2, [0.0, 0.0, 1.625]).unwrap();
    assert_eq!(only(query::contacts(&base, pill.at(upright).unwrap())).points.len(), 1);
    let beside = only(query::contacts(pill.at(Pose::IDENTITY).unwrap(), pill.at(at([1.5, 0.0, 0.4375])).unwrap()));
    let xs: Vec<f64> = beside.points.iter().map(|p| p.point_a[0]).collect();
    assert_eq!(xs.len(), 2, "{beside:?}");
    assert!(xs.contains(&0.5) && xs.contains(&1.0), "{beside:?}");

    let can = Shape::cylinder(0.5, 0.75).unwrap();
    let standing = only(
        Query::new()
            .with_contacts(ContactOptions { most_points: 8, ..ContactOptions::default() })
            .contacts(&base, can.at(at([0.0, 0.0, 0.9375])).unwrap()),
    );
    assert_eq!(standing.points.len(), 8, "{standing:?}");
    for point in &standing.points {
        let [x, y, _] = point.point_b;
        assert!((x.hypot(y) - 0.75).abs() < 1e-6 && (point.upper - 0.0625).abs() < 1e-6, "{point:?}");
    }
    let rolled = Pose::from_axis_angle([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2, [0.0, 0.0, 1.1875]).unwrap();
    let rolling = only(query::contacts(&base, can.at(rolled).unwrap()));
    assert_eq!(rolling.points.len(), 2, "{rolling:?}");
    assert!(rolling.points.iter().all(|p| (p.point_b[1].abs() - 0.5).abs() < 1e-9), "{rolling:?}");
    let cone = Shape::cone(0.5, 0.5).unwrap().at(at([0.0, 0.0, -0.9375])).unwrap();
    assert_eq!(only(query::contacts(&cone, &base)).points.len(), 1);
}

/// Checks that ids stay the same while boxes and hulls slide a little, and while both move by a
/// symmetry of the cube.
#[test]
fn contact_ids_persist_under_small_motions() {
    let mut rng = Rng::new(562);
    let unit = Known::Cuboid([0.5, 0.75, 1.0]);
    let tetrahedron = &Known::all()[9];
    for case in 0..60 {
        let upper = if case % 2 == 0 { &unit } else { tetrahedron };
        let mut place = if case % 2 == 0 {
            Affine { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] }
        } else {
            poses::rotation(&mut rng)
        };
        let here = Placed::new(&unit, Affine { translation: [0.0; 3], ..poses::rotation(&mut rng) });
        place.translation = std::array::from_fn(|k| here.place.linear[k][2] * 1.25 + rng.uniform(-0.25, 0.25));
        let ids = |here: &Placed, place: Affine| -> Vec<_> {
            let there = Placed::new(upper, place);
            query::contacts(&here.shape, &there.shape)
                .iter()
                .flat_map(|manifold| manifold.points.iter().map(|point| (point.id, point.upper)))
                .collect()
        };
        let first = ids(&here, place);
        // The same pair in another frame: a symmetry of the cube turns without rounding.
        let turn = poses::cube_symmetry(&mut rng);
        let turned = |place: &Affine| {
            let by = |v: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| dot(&turn[k], &v)) };
            let columns: [[f64; 3]; 3] = std::array::from_fn(|j| by(std::array::from_fn(|k| place.linear[k][j])));
            Affine {
                linear: std::array::from_fn(|k| std::array::from_fn(|j| columns[j][k])),
                translation: by(place.translation),
            }
        };
        let moved = ids(
            &Placed {
                known: here.known,
                place: turned(&here.place),
                shape: here.known.shape().at(pose(&turned(&here.place))).unwrap(),
            },
            turned(&place),
        );
        let names = |found: &[(query::ContactId, f64)]| found.iter().map(|found| found.0).collect::<Vec<_>>();
        assert_eq!(names(&first), names(&moved), "{case}");
        for _ in 0..5 {
            let mut slid = place;
            slid.translation = slid.translation.map(|x| x + rng.uniform(-1e-9, 1e-9));
            let found = ids(&here, slid);
            assert_eq!(names(&first), names(&found), "{case}");
        }
    }
}

/// Checks round shapes deep in each other, whose depth has a wide interval and many equally short
/// directions. The contacts must match the reported direction.
#[test]
fn the_deepest_contact_is_as_deep_as_the_penetration() {
    let mut rng = Rng::new(61);
    let shapes = [
        Shape::ellipsoid([1.0, 0.5, 0.75]).unwrap(),
        Shape::cylinder(1.0, 0.75).unwrap(),
        Shape::cone(1.0, 0.75).unwrap(),
        Shape::sphere([0.0; 3], 1.0).unwrap(),
        Shape::capsule([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], 0.5).unwrap(),
        Shape::segment([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]).unwrap(),
        Shape::triangle([[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]).unwrap(),
        Shape::triangle([[0.0, 0.0, -2.0], [0.0, 0.0, 2.0], [0.0, 0.125, 0.0]]).unwrap(),
    ];
    let mut asked = 0;
    for round in 0..6_000 {
        let [a, b] = [&shapes[round % 3], &shapes[round / 3 % 8]];
        let linear = if rng.one_in(4) { poses::rotation(&mut rng).linear } else { poses::cube_symmetry(&mut rng) };
        let at = [0; 3].map(|_: i32| match rng.integer(0, 3) {
            0 | 1 => 0.0,
            2 => rng.integer(-8, 8) as f64 * 0.25,
            _ => rng.uniform(-2.0, 2.0),
        });
        let (a, b) = (a.at(Pose::IDENTITY).unwrap(), b.at(Pose::new(linear, at).unwrap()).unwrap());
        let (Some(depth), contacts) = (query::penetration(&a, &b), query::contacts(&a, &b)) else {
            continue;
        };
        let deepest = contacts.iter().flat_map(|manifold| &manifold.points).map(|point| point.upper);
        let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
        let is_along = |k: usize| (depth.point_a[k] - depth.point_b[k] - depth.normal[k] * depth.upper).abs() < 2e-3;
        assert!((0..3).all(is_along), "{a:?} {b:?}: {depth:?}");
        let is_as_deep = depth.lower - 1e-3 < deepest && deepest < depth.upper + 1e-3;
        assert!(is_as_deep, "{a:?} {b:?}: {deepest} of {depth:?}");
        asked += 1;
    }
    assert!(asked > 3_000, "{asked}");
}
