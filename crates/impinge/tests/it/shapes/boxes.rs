//! Penetration depth of two boxes against separating axes in rationals.

use dashu_ratio::RBig;
use impinge::Pose;
use impinge::query;
use impinge::shape::Shape;
use impinge_testkit::Affine;
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;

type Point = [RBig; 3];

fn rational(x: f64) -> RBig {
    RBig::try_from(x).expect("finite")
}

fn dot(p: &Point, q: &Point) -> RBig {
    (0..3).fold(RBig::ZERO, |sum, k| sum + p[k].clone() * q[k].clone())
}

fn cross(p: &Point, q: &Point) -> Point {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        p[i].clone() * q[j].clone() - p[j].clone() * q[i].clone()
    })
}

/// Returns the squared depth, or `None` if the boxes are apart.
///
/// It is the smallest overlap along the cross products of all pairs of edge directions.
fn squared_depth(half: [[f64; 3]; 2], places: [&Affine; 2]) -> Option<RBig> {
    let generators: Vec<Point> = (0..2)
        .flat_map(|i| {
            (0..3).map(move |j| std::array::from_fn(|k| rational(places[i].linear[k][j]) * rational(half[i][j])))
        })
        .collect();
    let between: Point =
        std::array::from_fn(|k| rational(places[1].translation[k]) - rational(places[0].translation[k]));
    let magnitude = |x: RBig| if x < RBig::ZERO { -x } else { x };
    let mut least: Option<RBig> = None;
    for i in 0..6 {
        for j in i + 1..6 {
            let n = cross(&generators[i], &generators[j]);
            let squared = dot(&n, &n);
            if squared == RBig::ZERO {
                continue;
            }
            let reach = generators.iter().fold(RBig::ZERO, |sum, g| sum + magnitude(dot(&n, g)));
            let overlap = reach - magnitude(dot(&n, &between));
            if overlap < RBig::ZERO {
                return None;
            }
            let depth = overlap.clone() * overlap / squared;
            if least.as_ref().is_none_or(|least| depth < *least) {
                least = Some(depth);
            }
        }
    }
    least
}

#[test]
fn depths_of_boxes_agree_with_separating_axes() {
    let mut rng = Rng::new(54);
    let (mut meeting, mut apart, mut widest) = (0, 0, 0.0_f64);
    for case in 0..1_500 {
        let on_grid = case % 3 == 0;
        let mut extents = || -> [f64; 3] {
            std::array::from_fn(|_| if on_grid { rng.integer(1, 3) as f64 } else { rng.uniform(0.1, 2.0) })
        };
        let half = [extents(), extents()];
        let mut places = [poses::rotation(&mut rng), poses::rotation(&mut rng)];
        if on_grid {
            places = places.map(|_| Affine::new(poses::cube_symmetry(&mut rng), [0.0; 3]));
        }
        places[0].translation = [0.0; 3];
        places[1].translation =
            std::array::from_fn(|_| if on_grid { rng.integer(-5, 5) as f64 } else { rng.uniform(-2.5, 2.5) });
        let [a, b] = [0, 1].map(|i| Shape::cuboid(half[i]).unwrap().at(pose(&places[i])).unwrap());
        let (truth, found) = (squared_depth(half, [&places[0], &places[1]]), query::penetration(&a, &b));
        match (truth, found) {
            (None, None) => apart += 1,
            (Some(truth), Some(found)) => {
                let square = |x: f64| rational(x) * rational(x);
                assert!(square(found.lower) <= truth && truth <= square(found.upper), "{half:?} {places:?} {found:?}");
                widest = widest.max(found.upper - found.lower);
                meeting += 1;
            }
            (truth, found) => panic!("{half:?} {places:?}: {truth:?} {found:?}"),
        }
    }
    assert!(meeting > 500 && apart > 300, "{meeting} {apart}");
    assert!(widest < 1e-12, "{widest:e}");
}

/// Checks two of FCL's analytic cases (`test_fcl_box_box.cpp`).
#[test]
fn two_cases_of_fcl_have_their_depths() {
    let eighth = std::f64::consts::FRAC_PI_8;
    let turn = |axis, angle, translation| Pose::from_axis_angle(axis, angle, translation).unwrap();
    let unit = Shape::cuboid([0.5; 3]).unwrap();
    let large = Shape::cuboid([1.5; 3]).unwrap();
    let depth = |a: &Shape, pose_a, b: &Shape, pose_b| {
        query::penetration(a.at(pose_a).unwrap(), b.at(pose_b).unwrap()).unwrap().upper
    };
    let face = depth(
        &unit,
        turn([0.0, 1.0, 0.0], 2.0 * eighth, [0.0; 3]),
        &large,
        Pose::from_translation([0.0, 0.0, -1.5]).unwrap(),
    );
    assert!((face - 0.5_f64.sqrt()).abs() < 1e-13, "{face}");
    let tilted = depth(
        &unit,
        turn([1.0, 0.0, 0.0], eighth, [0.0; 3]),
        &unit,
        turn([0.0, 0.0, 1.0], 2.0 * eighth, [0.0, 0.0, -0.75]),
    );
    assert!((tilted - (0.5_f64.sqrt() * eighth.cos() - 0.25)).abs() < 1e-13, "{tilted}");
}
