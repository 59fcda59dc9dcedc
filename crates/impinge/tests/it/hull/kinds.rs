//! Hulls of 1 and 2 points, and of collinear, coplanar, cospherical and duplicated points.

use impinge::InputErrorKind;
use impinge::hull::{Hull, HullKind};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use crate::hull::oracle::{self, FAMILIES, dimension, extreme, floats, orientation, small_set};
use crate::hull::surface;

const KINDS: [HullKind; 4] = [HullKind::Point, HullKind::Segment, HullKind::Polygon, HullKind::Solid];

#[test]
fn small_sets_have_the_hull_of_the_definition() {
    let mut rng = Rng::new(22);
    let mut kinds = [0; 4];
    let mut inner = 0;
    let rounds = rounds(2_000);
    for case in 0..rounds {
        let set = small_set(&mut rng, case % FAMILIES);
        let exponent = [0, 0, 40, -900][case / FAMILIES % 4];
        let points = floats(&set, exponent);
        let hull = Hull::new(&points).expect("in range");
        assert_eq!(hull.vertices(), extreme(&set), "{set:?}");
        assert_eq!(hull.kind(), KINDS[dimension(&set)], "{set:?}");
        for (&vertex, &position) in hull.vertices().iter().zip(hull.positions()) {
            assert_eq!(points[vertex as usize], position);
        }
        let unscale = f64::from_bits(((1023 - exponent) as u64) << 52);
        let integers = |points: [[f64; 3]; 4]| orientation(points.map(|p| p.map(|x| (x * unscale) as i64))) as i32;
        surface::check(&hull, points.iter().copied(), integers);
        assert!(points.iter().all(|&point| hull.contains(point)));
        kinds[dimension(&set)] += 1;
        inner += usize::from(hull.vertices().len() < set.len());
    }
    assert!(kinds.iter().all(|&count| count * 20 > rounds) && inner * 2 > rounds, "{kinds:?} {inner}");
}

/// Checks that a hull contains a point exactly if adding the point adds no vertex.
#[test]
fn contains_agrees_with_the_definition() {
    let mut rng = Rng::new(23);
    let mut held = [[0; 2]; 4];
    let rounds = rounds(1_500);
    for case in 0..rounds {
        let set = small_set(&mut rng, [0, 1, 3, 4, 5, 6][case % 6]);
        let hull = Hull::new(&floats(&set, 0)).expect("in range");
        let point = match case % 3 {
            0 => std::array::from_fn(|_| rng.integer(-3, 3)),
            // Between two points of the set, or beyond the second one.
            _ => {
                let (p, q, step) = (rng.choose(&set), rng.choose(&set), rng.integer(1, 2));
                std::array::from_fn(|k| p[k] + (q[k] - p[k]) * step / [2, 1][case % 2])
            }
        };
        let mut with = set.clone();
        with.push(point);
        let expected = !extreme(&with).contains(&(set.len() as u32));
        assert_eq!(hull.contains(point.map(|x| x as f64)), expected, "{set:?} {point:?}");
        held[dimension(&set)][usize::from(expected)] += 1;
    }
    assert!(held.iter().flatten().all(|&count| count * 100 > rounds), "{held:?}");
    let hull = Hull::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]).expect("in range");
    assert!(!hull.contains([f64::NAN, 0.0, 0.0]) && !hull.contains([f64::INFINITY, 0.0, 0.0]));
}

#[test]
fn invalid_points_are_rejected_by_index() {
    let kind = |points: &[[f64; 3]]| Hull::new(points).map(|_| ()).expect_err("refused").kind().clone();
    assert_eq!(kind(&[]), InputErrorKind::Empty { what: "points" });
    let mut points = vec![[0.5; 3]; 9];
    points[7][1] = f64::NAN;
    assert_eq!(kind(&points), InputErrorKind::NonFinite { what: "point", index: 7 });
    points[3][2] = f64::NEG_INFINITY;
    assert_eq!(kind(&points), InputErrorKind::NonFinite { what: "point", index: 3 });
    points[1][0] = 2.0_f64.powi(128);
    assert_eq!(kind(&points), InputErrorKind::OutOfRange { what: "point", index: 1, limit: "2^128" });
    // The largest and the smallest valid coordinates.
    let extremes = [[f64::from(f32::MAX); 3], [-f64::from(f32::MAX); 3], [5e-324, 0.0, 0.0], [0.0, -0.0, 5e-324]];
    let hull = Hull::new(&extremes).expect("in range");
    assert_eq!((hull.kind(), hull.vertices().len()), (HullKind::Solid, 4));
}

/// Checks that the order of the input changes only the numbering, and that single precision changes
/// nothing.
#[test]
fn the_order_of_the_points_changes_no_hull() {
    let mut rng = Rng::new(24);
    for case in 0..600 {
        let set = small_set(&mut rng, case % FAMILIES);
        let points = floats(&set, 0);
        let hull = Hull::new(&points).expect("in range");
        let single: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
        let again = Hull::new(&single).expect("in range");
        assert_eq!((again.vertices(), again.faces()), (hull.vertices(), hull.faces()));
        let mut order: Vec<usize> = (0..points.len()).collect();
        for at in (1..order.len()).rev() {
            order.swap(at, rng.integer(0, at as i64) as usize);
        }
        let shuffled: Vec<_> = order.iter().map(|&at| points[at]).collect();
        let other = Hull::new(&shuffled).expect("in range");
        let sorted = |hull: &Hull| {
            let mut positions: Vec<[i64; 3]> = hull.positions().iter().map(|p| p.map(|x| x as i64)).collect();
            positions.sort_unstable();
            positions
        };
        assert_eq!(sorted(&hull), sorted(&other));
        assert_eq!((hull.kind(), hull.faces().len()), (other.kind(), other.faces().len()));
    }
}

/// Checks that one unit in the last place decides whether a point is on a face, inside or a vertex.
#[test]
fn one_unit_in_the_last_place_decides() {
    let corners = [[0.1, 0.2, 0.3], [0.7, 0.1, 0.4], [0.2, 0.9, 0.6], [0.3, 0.3, 0.95]];
    let mut rng = Rng::new(25);
    let mut vertices = 0;
    for _ in 0..3000 {
        let [p, q, r] = [0, 1, 2].map(|k: usize| corners[k]);
        let (s, t) = (rng.uniform(0.1, 0.4), rng.uniform(0.1, 0.4));
        let mut point: [f64; 3] = std::array::from_fn(|k| p[k] + s * (q[k] - p[k]) + t * (r[k] - p[k]));
        let k = rng.integer(0, 2) as usize;
        point[k] = f64::from_bits(point[k].to_bits().wrapping_add_signed(rng.integer(-3, 3)));
        let mut points = corners.to_vec();
        points.push(point);
        let hull = Hull::new(&points).expect("in range");
        let inner = oracle::orientation_of_doubles([p, q, r, corners[3]]);
        let is_outside = oracle::orientation_of_doubles([p, q, r, point]) * inner < 0;
        assert_eq!(hull.vertices().len(), 4 + usize::from(is_outside));
        vertices += usize::from(is_outside);
    }
    assert!((600..2400).contains(&vertices), "{vertices}");
}
