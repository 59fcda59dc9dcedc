//! Shapes without a radius, without a volume, or in one place; and numbers at the limits of the
//! range.

use std::sync::Arc;

use impinge::hull::Hull;
use impinge::input::InputErrorKind;
use impinge::query::{self, Proximity};
use impinge::shape::{PlacedShape, Shape};
use impinge::{InputError, Pose};

fn here(shape: Result<Shape, InputError>) -> PlacedShape {
    shape.unwrap().at(Pose::IDENTITY).unwrap()
}

fn at(shape: Result<Shape, InputError>, translation: [f64; 3]) -> PlacedShape {
    shape.unwrap().at(Pose::from_translation(translation).unwrap()).unwrap()
}

/// Returns the depth interval of two overlapping shapes, after checking that all its numbers are
/// finite.
fn depth(a: &PlacedShape, b: &PlacedShape) -> [f64; 2] {
    let found = query::penetration(a, b).expect("they intersect");
    assert!((found.normal.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14, "{found:?}");
    assert!(0.0 <= found.lower && found.lower <= found.upper && found.upper.is_finite(), "{found:?}");
    assert!(found.point_a.iter().chain(&found.point_b).all(|x| x.is_finite()), "{found:?}");
    [found.lower, found.upper]
}

#[test]
fn zero_radii_and_extents_are_valid() {
    let point = here(Shape::sphere([0.0; 3], 0.0));
    assert_eq!(query::proximity(&point, &point), Proximity::Intersects);
    assert_eq!(query::distance(&point, &point).upper, 0.0);
    assert!(depth(&point, &point)[1] < 1e-15);
    let pill = here(Shape::capsule([1.0; 3], [1.0; 3], 0.0));
    let found = query::distance(&point, &pill);
    assert!(found.lower <= 3_f64.sqrt() && 3_f64.sqrt() <= found.upper && found.upper - found.lower < 1e-12);
    let line = here(Shape::cylinder(1.0, 0.0));
    assert!(!query::intersects(&line, at(Shape::cone(0.0, 0.5), [0.0, 0.0, 2.0])));
    let disc = here(Shape::ellipsoid([0.0, 1.0, 2.0]));
    assert!(depth(&disc, &line)[1] < 1e-9);
    let nothing = here(Shape::ellipsoid([0.0; 3]));
    assert!(depth(&nothing, &disc)[1] < 1e-9);
    let refused = [Shape::sphere([0.0; 3], -1.0), Shape::capsule([0.0; 3], [1.0; 3], -0.5), Shape::cone(-1.0, 1.0)];
    for refused in refused {
        assert!(matches!(refused.unwrap_err().kind(), InputErrorKind::Negative { .. }));
    }
}

#[test]
fn invalid_numbers_and_maps_that_are_not_rigid_are_rejected() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for refused in [
            Shape::sphere([0.0, bad, 0.0], 1.0),
            Shape::sphere([0.0; 3], bad),
            Shape::cuboid([1.0, 1.0, bad]),
            Shape::cylinder(bad, 1.0),
            Shape::half_space([0.0, 0.0, 1.0], bad),
            Shape::triangle([[0.0; 3], [1.0; 3], [bad; 3]]),
        ] {
            assert!(matches!(refused.unwrap_err().kind(), InputErrorKind::NonFinite { .. }));
        }
    }
    assert!(matches!(Shape::point([1e39, 0.0, 0.0]).unwrap_err().kind(), InputErrorKind::OutOfRange { .. }));
    assert!(matches!(Shape::half_space([0.0; 3], 1.0).unwrap_err().kind(), InputErrorKind::ZeroAxis));
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    for round in [Shape::sphere([0.0; 3], 1.0), Shape::cylinder(1.0, 1.0), Shape::ellipsoid([1.0, 2.0, 3.0])] {
        let refused = round.unwrap().at(stretched).unwrap_err();
        assert!(matches!(refused.kind(), InputErrorKind::NotRigid { .. }), "{refused}");
    }
    assert!(Shape::cuboid([1.0; 3]).unwrap().at(stretched).is_ok());
}

/// Checks a sphere under a map that is not quite rigid. Its image is uncertain, so touching is
/// undecided, which counts as a hit.
#[test]
fn touching_under_a_nearly_rigid_map_is_undecided() {
    let nearly = Pose::new([[1.0 + 1e-7, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let a = ball.at(nearly).unwrap();
    for (x, wanted) in [(1.99, Proximity::Intersects), (2.0, Proximity::Undecided), (2.01, Proximity::Apart)] {
        let b = ball.at(Pose::from_translation([0.0, x, 0.0]).unwrap()).unwrap();
        assert_eq!(query::proximity(&a, &b), wanted, "{x}");
        assert_eq!(query::distance(&a, &b).distance() == 0.0, wanted != Proximity::Apart, "{x}");
    }
    let exactly = ball.at(Pose::IDENTITY).unwrap();
    let touching = ball.at(Pose::from_translation([0.0, 2.0, 0.0]).unwrap()).unwrap();
    assert_eq!(query::proximity(&exactly, &touching), Proximity::Intersects);
    let apart = ball.at(Pose::from_translation([0.0, 2_f64.next_up(), 0.0]).unwrap()).unwrap();
    assert_eq!(query::proximity(&exactly, &apart), Proximity::Apart);
    assert!(query::distance(&exactly, &apart).distance() > 0.0);
}

/// Checks round shapes of equal orientation, which have tied support points and an origin on the
/// border of the first simplex. Deep overlap must be proved anyway.
#[test]
fn aligned_round_shapes_certainly_intersect() {
    let shapes = [
        Shape::cylinder(1.0, 1.0).unwrap(),
        Shape::cone(1.0, 1.0).unwrap(),
        Shape::ellipsoid([1.0, 1.0, 1.0]).unwrap(),
        Shape::ellipsoid([1.0, 0.5, 0.25]).unwrap(),
    ];
    let steps = [0.0, 0.125, 0.25, -0.25];
    let mut asked = 0;
    for (a, b) in shapes.iter().flat_map(|a| shapes.iter().map(move |b| (a, b))) {
        for (x, y) in steps.iter().flat_map(|&x| steps.iter().map(move |&y| (x, y))) {
            for z in [0.0, 0.0625] {
                let pose = Pose::from_translation([x, y, z]).unwrap();
                let (a, b) = (a.at(Pose::IDENTITY).unwrap(), b.at(pose).unwrap());
                assert_eq!(query::proximity(&a, &b), Proximity::Intersects, "{a:?} {b:?}");
                assert_eq!((query::distance(&a, &b).lower, query::distance(&a, &b).upper), (0.0, 0.0));
                asked += 1;
            }
        }
    }
    assert_eq!(asked, 512);
    // Touching is undecided, and shapes farther apart are apart.
    let drum = &shapes[0];
    for (x, wanted) in [(1.999, Proximity::Intersects), (2.0, Proximity::Undecided), (2.001, Proximity::Apart)] {
        let b = drum.at(Pose::from_translation([x, 0.0, 0.0]).unwrap()).unwrap();
        assert_eq!(query::proximity(drum.at(Pose::IDENTITY).unwrap(), &b), wanted, "{x}");
    }
}

#[test]
fn flat_and_pointlike_polytopes_have_depths() {
    let hull = |points: &[[f64; 3]]| Ok(Shape::hull(Arc::new(Hull::new(points).unwrap())));
    let flat = [
        here(hull(&[[0.0; 3]])),
        here(hull(&[[0.0; 3]; 5])),
        here(hull(&[[-1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]])),
        here(hull(&[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 2.0, 0.0]])),
        here(Shape::cuboid([1.0, 1.0, 0.0])),
        here(Shape::cuboid([1.0, 0.0, 0.0])),
        here(Shape::cuboid([0.0; 3])),
        here(Shape::segment([[-1.0; 3], [1.0; 3]])),
        here(Shape::triangle([[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 2.0]])),
    ];
    for (i, a) in flat.iter().enumerate() {
        for (j, b) in flat.iter().enumerate() {
            assert_eq!(query::proximity(a, b), Proximity::Intersects, "{i} {j}");
            let found = depth(a, b);
            assert!(found[1] - found[0] < 1e-13, "{i} {j} {found:?}");
            // In one plane, or for points and segments, no interiors overlap and the depth is zero.
            assert!(i > 6 || j > 6 || found[1] < 1e-13, "{i} {j} {found:?}");
        }
    }
}

/// Checks two equal shapes in the same place.
#[test]
fn coincident_shapes_have_normals() {
    let wanted = [
        (here(Shape::sphere([0.0; 3], 1.5)), 3.0, 1e-13),
        (here(Shape::capsule([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.5)), 1.0, 1e-13),
        (here(Shape::cuboid([1.0, 2.0, 0.5])), 1.0, 1e-13),
        (here(Shape::cylinder(2.0, 0.5)), 1.0, 1e-3),
        (here(Shape::cone(1.0, 0.25)), 0.496, 1e-2),
        (here(Shape::ellipsoid([1.0, 2.0, 0.5])), 1.0, 1e-3),
    ];
    for (shape, value, tolerance) in wanted {
        let [lower, upper] = depth(&shape, &shape);
        assert!(lower - 1e-3 <= value && value <= upper + 1e-3, "{shape:?} {lower} {upper}");
        assert!(upper - lower < tolerance, "{shape:?} {lower} {upper}");
    }
}

/// Checks sizes and places at the limits of the range.
#[test]
fn shapes_of_any_size_are_decided() {
    for exponent in [-1060, -500, -140, 0, 60, 120] {
        let size = 2_f64.powi(exponent.max(-1020)) * if exponent < -1020 { 2_f64.powi(exponent + 1020) } else { 1.0 };
        let unit = Shape::cuboid([size; 3]);
        let (a, touching) = (here(unit.clone()), at(unit.clone(), [2.0 * size, 0.0, 0.0]));
        assert!(query::intersects(&a, &touching), "{exponent}");
        let apart = at(unit.clone(), [3.0 * size, 0.0, 0.0]);
        let found = query::distance(&a, &apart);
        assert!(!query::intersects(&a, &apart) && found.lower <= size && size <= found.upper, "{exponent} {found:?}");
        let inside = at(unit, [size, 0.0, 0.0]);
        let [lower, upper] = depth(&a, &inside);
        assert!(lower <= size && size <= upper && upper > 0.0, "{exponent} {lower:e} {upper:e}");
    }
    let plate = here(Shape::cuboid([1e6, 1e6, 1.0]));
    let screw = at(Shape::cylinder(1e-3, 1e-4), [5e5, -7e5, 1.0 + 2e-3]);
    let found = query::distance(&plate, &screw);
    assert!(found.lower > 0.0 && (found.upper - 1e-3).abs() < 1e-7, "{found:?}");
    let far = at(Shape::sphere([0.0; 3], 1.0), [1e90, 0.0, -1e90]);
    assert!(query::distance(&plate, &far).lower > 1e90);
}

/// Checks round shapes in cylinders, for which rounding may tangle the expanded polytope. The
/// search then returns the bounds proved so far.
#[test]
fn tangled_polytopes_end_with_proved_bounds() {
    let capsule = Shape::capsule([-0.25, 0.0, 0.0], [0.25, 0.0, 0.0], 0.25).unwrap().at(Pose::IDENTITY).unwrap();
    let sphere = Shape::sphere([0.0; 3], 0.5).unwrap().at(Pose::IDENTITY).unwrap();
    let cylinder = Shape::cylinder(0.5, 0.375).unwrap();
    let mut state = 5_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    let mut meeting = 0;
    for _ in 0..40 {
        let (axis, angle) = ([next(), next(), next()], 3.0 * next());
        let pose = Pose::from_axis_angle(axis, angle, [0.75 * next(), 0.75 * next(), 0.75 * next()]).unwrap();
        let cylinder = cylinder.at(pose).unwrap();
        for other in [&capsule, &sphere] {
            let Some(depth) = query::penetration(other, &cylinder) else { continue };
            assert!(depth.lower <= depth.upper && depth.upper - depth.lower < 1e-6, "{depth:?}");
            meeting += 1;
        }
    }
    assert!(meeting > 30, "{meeting}");
}
