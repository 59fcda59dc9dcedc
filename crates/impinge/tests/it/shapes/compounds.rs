//! Compounds against their parts, queried one by one.

use impinge::query;
use impinge::shape::{PlacedShape, Shape};
use impinge::{InputErrorKind, Pose};
use impinge_testkit::generate::solids::icosphere;
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::support::{Known, at, engine};

/// Checks that a compound answers as its parts do, and that contacts name the parts.
#[test]
fn compounds_answer_as_their_parts() {
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
        let found = query::distance(&compound, &other);
        let least = singles.iter().map(|part| query::distance(part, &other).upper).fold(f64::INFINITY, f64::min);
        assert_eq!(found.upper, least);
        let hits = singles.iter().any(|part| query::intersects(part, &other));
        assert_eq!(query::intersects(&compound, &other), hits);
        let contacts = query::contacts(&other, &compound);
        let touched = |part: u32| contacts.iter().flat_map(|m| &m.points).any(|point| point.id.part_b == part);
        for (part, single) in (0..).zip(&singles) {
            assert_eq!(touched(part), query::intersects(single, &other));
        }
        if let Some(depth) = query::penetration(&compound, &other) {
            let by: [f64; 3] = std::array::from_fn(|k| depth.normal[k] * depth.upper * (1.0 + 1e-9));
            let pose = other.world_from_local();
            let moved = Pose::new(*pose.linear(), std::array::from_fn(|k| pose.translation()[k] + by[k])).unwrap();
            assert!(depth.lower <= depth.upper && depth.upper.is_finite(), "{depth:?}");
            // The lower bound of no part exceeds the upper bound of the compound.
            let deepest = singles.iter().filter_map(|part| query::penetration(part, &other)).map(|d| d.lower);
            assert!(deepest.fold(0.0, f64::max) <= depth.upper * (1.0 + 1e-9), "{depth:?}");
            assert!(moved.translation().iter().all(|x| x.is_finite()));
            meeting += 1;
        } else {
            apart += 1;
        }
    }
    assert!(meeting > 1 && apart > 1, "{meeting} {apart}");
}

/// Checks a compound with many parts, which has a tree, against all its parts one by one.
///
/// The other operand is a single shape, a compound or a half-space. Some compounds contain a
/// half-space.
#[test]
fn compounds_of_many_parts_answer_as_their_parts() {
    let mut rng = Rng::new(577);
    let all = Known::all();
    let finite: Vec<&Known> = all.iter().filter(|known| !matches!(known, Known::HalfSpace(..))).collect();
    let scattered = |rng: &mut Rng, count: usize, reach: f64| -> Vec<(Shape, Pose)> {
        let part = |rng: &mut Rng| {
            let mut place = poses::rotation(rng);
            // On a grid, so that distances tie.
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
        let least = pairs().map(|(part, other)| query::distance(part, other).upper).fold(f64::INFINITY, f64::min);
        let found = query::distance(&compound, &other);
        assert_eq!(found.upper, least, "{case}");
        assert_eq!(query::distance(&other, &compound).upper, least, "{case}");
        assert!(found.lower <= least);
        let hit = pairs().any(|(part, other)| query::intersects(part, other));
        assert_eq!(query::intersects(&compound, &other), hit, "{case}");
        for clearance in [0.5 * least, least, 1.5 * least] {
            let near = pairs().any(|(part, other)| query::within(part, other, clearance));
            assert_eq!(query::within(&compound, &other, clearance), near, "{case} {clearance}");
        }
        let named: Vec<[u32; 2]> = {
            let manifolds = query::contacts(&compound, &other);
            manifolds.iter().flat_map(|m| &m.points).map(|point| [point.id.part_a, point.id.part_b]).collect()
        };
        assert!(named.is_sorted(), "{named:?}");
        assert_eq!(!named.is_empty(), hit, "{case}");
        for (i, part) in (0..).zip(&ours) {
            for (j, other) in (0..).zip(&theirs) {
                assert!(!named.contains(&[i, j]) || query::intersects(part, other), "{case} {i} {j}");
            }
        }
        contacts += named.len();
        meeting += usize::from(hit);
        apart += usize::from(!hit);
    }
    assert!(meeting > 5 && apart > 5 && contacts > 40, "{meeting} {apart} {contacts}");
}

/// Compounds of compounds multiply their parts. They answer as a flat compound, and are refused
/// beyond the maximum before any copy.
#[test]
fn nested_compounds_have_a_maximum_number_of_parts() {
    let step = |x: f64| Pose::from_translation([x, 0.0, 0.0]).unwrap();
    let mut nested = Shape::sphere([0.0; 3], 0.25).unwrap();
    let mut flat = vec![(nested.clone(), Pose::IDENTITY)];
    for level in 0..6 {
        let by = step(f64::from(1 << level));
        nested = Shape::compound(&[(nested.clone(), Pose::IDENTITY), (nested, by)]).unwrap();
        let moved: Vec<(Shape, Pose)> =
            flat.iter().map(|(shape, pose)| (shape.clone(), by.compose(pose).unwrap())).collect();
        flat.extend(moved);
    }
    let [nested_placed, flat] = [&nested, &Shape::compound(&flat).unwrap()].map(|shape| shape.at(step(0.5)).unwrap());
    let probe = Shape::cuboid([3.0, 0.125, 0.125]).unwrap().at(step(20.25)).unwrap();
    assert_eq!(query::contacts(&nested_placed, &probe), query::contacts(&flat, &probe));
    assert!(query::contacts(&nested_placed, &probe).len() > 3);
    let repeated = vec![(nested, Pose::IDENTITY); 1 << 7];
    let many = Shape::compound(&repeated).unwrap();
    let refused = Shape::compound(&vec![(many, Pose::IDENTITY); (1 << 7) + 1]).unwrap_err();
    let expected = InputErrorKind::TooMany { what: "parts", count: (1 << 20) + (1 << 13), limit: 1 << 20 };
    assert_eq!(refused.kind(), &expected);
}
