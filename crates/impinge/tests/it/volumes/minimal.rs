//! Minimal spheres against an oracle that tries every four points, on sets for which other
//! implementations fail, in any order, and with a million points.

use dashu_ratio::RBig;
use impinge::volume::BoundingVolume;
use impinge::volume::fit::{FittedSphere, minimal_sphere};
use impinge_testkit::generate::{Rng, cos, sin};
use impinge_testkit::oracle::minimal_sphere as oracle;

use crate::volumes::exact::{Exact, point, rational};
use crate::volumes::points::{KINDS, Kind, cloud};

/// Checks the documented bound: the radius exceeds the lower bound by at most 1e-12 of it and 2
/// units in the last place of the center.
fn assert_tight(fitted: &FittedSphere) {
    let ulp = fitted.sphere.center().iter().map(|x| x.abs().next_up() - x.abs()).fold(0.0, f64::max);
    let gap = fitted.sphere.radius() - fitted.lower;
    assert!((0.0..=1e-12 * fitted.lower + 2.0 * ulp).contains(&gap), "{fitted:?}: {gap:e}");
}

#[test]
fn minimal_spheres_agree_with_the_oracle() {
    let mut rng = Rng::new(51);
    let mut ties = 0;
    for round in 0..320 {
        let count = rng.integer(1, 7) as usize;
        let points = cloud(&mut rng, KINDS[round % 8], count);
        let fitted = minimal_sphere(&points).unwrap();
        let truth = oracle(&points).expect("points");
        for (axis, &x) in fitted.sphere.center().iter().enumerate() {
            let off = |x: f64| {
                let off = rational(x) - truth.center[axis].clone();
                if off < RBig::ZERO { -off } else { off }
            };
            assert!(off(x) <= off(x.next_up()) && off(x) <= off(x.next_down()), "the center is not rounded to nearest");
        }
        let squared = |x: f64| rational(x) * rational(x);
        assert!(squared(fitted.lower) <= truth.squared_radius, "{fitted:?}");
        assert!(squared(fitted.lower.next_up()) > truth.squared_radius, "{fitted:?}");
        assert!(points.iter().all(|&p| fitted.sphere.holds(&point(p))));
        assert_tight(&fitted);
        ties += usize::from(truth.on_it > 4);
    }
    assert!(ties >= 20, "{ties} of 320 have more than four points on the sphere");
}

#[test]
fn a_thousand_degenerate_sets_have_minimal_spheres_in_any_order() {
    let hard = [Kind::Grid, Kind::Cospherical, Kind::Duplicated, Kind::Cocircular, Kind::Collinear];
    let mut rng = Rng::new(52);
    let mut sizes = [0; 3];
    for round in 0..1000 {
        let count = rng.choose(&[2, 4, 9, 30, 80]);
        let mut points = cloud(&mut rng, hard[round % 5], count);
        let fitted = minimal_sphere(&points).unwrap();
        assert!(points.iter().all(|&p| fitted.sphere.holds(&point(p))), "{fitted:?}");
        assert_tight(&fitted);
        for i in (1..count).rev() {
            points.swap(i, rng.integer(0, i as i64) as usize);
        }
        assert_eq!(minimal_sphere(&points).unwrap(), fitted, "the order changes the result");
        points.extend_from_within(..count / 2);
        assert_eq!(minimal_sphere(&points).unwrap(), fitted, "duplicates change the result");
        sizes[usize::from(count > 4) + usize::from(count > 30)] += 1;
    }
    assert!(sizes.iter().all(|&count| count > 100), "{sizes:?}");
}

#[test]
fn scaling_by_powers_of_two_scales_the_sphere() {
    let mut rng = Rng::new(53);
    for kind in KINDS {
        let points = cloud(&mut rng, kind, 20);
        let fitted = minimal_sphere(&points).unwrap();
        for exponent in [-500, -60, 60, 90] {
            let factor = 2_f64.powi(exponent);
            let scaled: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| x * factor)).collect();
            let other = minimal_sphere(&scaled).unwrap();
            assert_eq!(other.sphere.center(), fitted.sphere.center().map(|x| x * factor), "{kind:?} {exponent}");
            assert_eq!(other.sphere.radius(), fitted.sphere.radius() * factor, "{kind:?} {exponent}");
            assert_eq!(other.lower, fitted.lower * factor);
        }
    }
}

/// Checks a million points on a sphere, and 100,000 of other kinds. Reversing the order changes no
/// bit.
#[test]
fn a_million_points_have_a_minimal_sphere_in_any_order() {
    const COUNT: usize = 1_000_000;
    const MANY: usize = 100_000;
    let mut rng = Rng::new(54);
    let on_sphere: Vec<[f64; 3]> = (0..COUNT)
        .map(|_| {
            let (z, angle) = (rng.uniform(-1.0, 1.0), rng.uniform(0.0, std::f64::consts::TAU));
            let r = (1.0 - z * z).sqrt();
            [r * cos(angle), r * sin(angle), z]
        })
        .collect();
    let in_cube: Vec<[f64; 3]> = (0..MANY).map(|_| std::array::from_fn(|_| rng.uniform(-1.0, 1.0))).collect();
    let mut outlier = in_cube.clone();
    outlier[77_777] = [1e9, 1.0, 2.0];
    let duplicated: Vec<[f64; 3]> = (0..MANY).map(|i| in_cube[i % 7]).collect();
    let grid: Vec<[f64; 3]> = (0..MANY).map(|i| [i % 50, i / 50 % 50, i / 2_500].map(|x| x as f64)).collect();
    for mut points in [on_sphere, in_cube, outlier, duplicated, grid] {
        let fitted = minimal_sphere(&points).unwrap();
        assert!(points.iter().all(|&p| fitted.sphere.contains(p)));
        assert!(points.iter().step_by(9973).all(|&p| fitted.sphere.holds(&point(p))));
        assert_tight(&fitted);
        points.reverse();
        assert_eq!(minimal_sphere(&points).unwrap(), fitted);
    }
}

#[test]
fn single_precision_gives_the_same_sphere() {
    let mut rng = Rng::new(55);
    let points: Vec<[f32; 3]> = (0..20_000).map(|_| std::array::from_fn(|_| rng.uniform(-1.0, 1.0) as f32)).collect();
    let wide: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
    assert_eq!(minimal_sphere(&points).unwrap(), minimal_sphere(&wide).unwrap());
}

#[test]
fn points_at_the_limits_of_the_range_have_minimal_spheres() {
    let tiny = f64::from_bits(1);
    let sets = [
        vec![[0.0; 3], [tiny, 0.0, 0.0], [0.0, tiny, 0.0], [tiny, tiny, tiny]],
        vec![[1.5e38, 0.0, 0.0], [1.5e38, tiny, 0.0]],
        vec![[3e38, 3e38, 3e38], [-3e38, -3e38, 3e38], [0.0, -3e38, 3e38]],
        vec![[0.0, -0.0, 0.0], [-0.0; 3]],
        vec![[1.0, 0.0, 0.0], [1.0_f64.next_up(), 0.0, 0.0], [1.0, 1e-300, 0.0]],
    ];
    for points in sets {
        let fitted = minimal_sphere(&points).unwrap();
        assert!(points.iter().all(|&p| fitted.sphere.holds(&point(p))), "{points:?} {fitted:?}");
        assert!(fitted.lower <= fitted.sphere.radius());
        let reversed: Vec<[f64; 3]> = points.iter().rev().copied().collect();
        assert_eq!(minimal_sphere(&reversed).unwrap(), fitted);
    }
}
