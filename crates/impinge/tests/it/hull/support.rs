//! Support vertices of hulls: by scanning all vertices and by climbing, against rationals.

use dashu_ratio::RBig;
use impinge::hull::Hull;
use impinge_testkit::generate::{Rng, cos, sin};

use crate::hull::oracle::{FAMILIES, floats, small_set};

/// Returns the first vertex with the largest exact dot product.
fn farthest(hull: &Hull, direction: [f64; 3]) -> u32 {
    let exact = |x: f64| RBig::try_from(x).expect("finite");
    let value = |p: &[f64; 3]| (0..3).map(|k| exact(direction[k]) * exact(p[k])).fold(RBig::ZERO, |sum, x| sum + x);
    let values: Vec<RBig> = hull.positions().iter().map(value).collect();
    let most = values.iter().max().expect("a vertex");
    values.iter().position(|x| x == most).expect("it is one of them") as u32
}

/// Returns a direction: many have ties, others have any length.
fn direction(rng: &mut Rng, case: usize) -> [f64; 3] {
    match case % 5 {
        0 => std::array::from_fn(|_| rng.integer(-1, 1) as f64),
        1 => std::array::from_fn(|_| rng.integer(-3, 3) as f64 * 0.1),
        2 => std::array::from_fn(|_| rng.uniform(-1.0, 1.0)),
        3 => {
            let scale = rng.choose(&[1e-320, 1e-300, 1e300, 1e308]);
            std::array::from_fn(|_| scale * rng.integer(-1, 1) as f64)
        }
        // Close to a direction with ties.
        _ => std::array::from_fn(|_| rng.integer(-1, 1) as f64 + rng.integer(-1, 1) as f64 * 1e-16),
    }
}

#[test]
fn climbing_finds_the_farthest_vertex_from_every_start() {
    let mut rng = Rng::new(31);
    let mut ties = 0;
    for case in 0..3000 {
        let hull =
            Hull::new(&floats(&small_set(&mut rng, case % FAMILIES), [0, 0, 60, -500][case % 4])).expect("legal");
        for turn in 0..3 {
            let direction = direction(&mut rng, case + turn);
            let expected = farthest(&hull, direction);
            assert_eq!(hull.support(direction), expected, "{direction:?} of {:?}", hull.positions());
            for start in 0..hull.vertices().len() as u32 {
                assert_eq!(hull.support_from(direction, start), expected, "{direction:?} from {start}");
            }
            let reversed = farthest(&hull, direction.map(|x| -x));
            ties += usize::from(hull.neighbors(expected).iter().any(|&other| {
                let along = |v: u32| (0..3).map(|k| direction[k] * hull.positions()[v as usize][k]).sum::<f64>();
                along(other) == along(expected) && other != reversed
            }));
        }
    }
    assert!(ties > 900, "{ties}");
    let hull = Hull::new(&[[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0]]).expect("legal");
    assert_eq!(hull.support([f64::NAN, 1.0, f64::INFINITY]), 0);
    assert_eq!(hull.support_from([1.0, f64::NAN, 0.0], 0), 1);
}

/// Checks prisms, whose ends are plateaus of many vertices. Far from the origin all dot products
/// nearly tie.
#[test]
fn climbing_passes_plateaus_near_and_far_from_the_origin() {
    let mut rng = Rng::new(32);
    for offset in [0.0, 1e7] {
        let sides = 500;
        let prism: Vec<[f64; 3]> = (0..2 * sides)
            .map(|i| {
                let angle = f64::from(i / 2) * (std::f64::consts::TAU / f64::from(sides));
                [offset + cos(angle), sin(angle) - offset, offset + f64::from(i % 2)]
            })
            .collect();
        let hull = Hull::new(&prism).expect("legal");
        assert!(hull.vertices().len() > 900);
        for case in 0..60 {
            let direction = direction(&mut rng, case);
            let expected = farthest(&hull, direction);
            assert_eq!(hull.support(direction), expected);
            for _ in 0..4 {
                let start = rng.integer(0, hull.vertices().len() as i64 - 1) as u32;
                assert_eq!(hull.support_from(direction, start), expected, "{direction:?} from {start}");
            }
        }
    }
}
