//! The five fast constructions of spheres, and overlap and containment of spheres.

use impinge::volume::fit::{
    FittedSphere, box_sphere, mean_sphere, minimal_sphere, principal_sphere, refined_sphere, ritter_sphere,
};
use impinge::volume::{BoundingSphere, BoundingVolume};
use impinge_testkit::generate::Rng;

use crate::volumes::exact::{Exact, point, rational};
use crate::volumes::points::{KINDS, cloud};

/// Checks that every construction contains all points, brackets the minimal radius, and keeps its
/// documented factor.
#[test]
fn every_construction_contains_all_points_within_its_factor() {
    type Construct = fn(&[[f64; 3]]) -> Result<FittedSphere, impinge::InputError>;
    // Each construction and the maximum ratio of its radius to the minimal one.
    let constructions: [(&str, Construct, f64); 5] = [
        ("mean", mean_sphere, 2.0),
        ("box", box_sphere, 1.7321),
        ("ritter", ritter_sphere, 2.0),
        ("principal", principal_sphere, 2.0),
        ("refined", refined_sphere, 2.0),
    ];
    let mut rng = Rng::new(41);
    let mut exact = 0;
    for round in 0..240 {
        let count = rng.integer(1, 60) as usize;
        let points = cloud(&mut rng, KINDS[round % 8], count);
        let least = minimal_sphere(&points).unwrap();
        for (name, construct, factor) in constructions {
            let FittedSphere { sphere, lower } = construct(&points).unwrap();
            assert!(points.iter().all(|&p| sphere.holds(&point(p))), "{name}: {sphere:?}");
            assert!(lower <= least.sphere.radius(), "{name}: {lower} {least:?}");
            // A center far from the origin may be rounded by more than the size of the set.
            let slack = 1e-15 * sphere.center().iter().fold(0.0_f64, |sum, x| sum + x.abs());
            assert!(sphere.radius() >= least.lower, "{name}");
            assert!(sphere.radius() <= factor * least.sphere.radius() + 4.0 * slack, "{name}: {sphere:?} {least:?}");
            exact += usize::from(sphere.radius() == least.sphere.radius());
        }
        assert!(refined_sphere(&points).unwrap().sphere.radius() <= ritter_sphere(&points).unwrap().sphere.radius());
    }
    assert!((100..1100).contains(&exact), "{exact} of 1200 are minimal");
}

#[test]
fn overlap_and_containment_are_exact() {
    let mut rng = Rng::new(42);
    let (mut met, mut held, mut close) = (0, 0, 0);
    for round in 0..4000 {
        let scale = rng.choose(&[1.0, 1e-6, 1e6, 2_f64.powi(-300), 2_f64.powi(-530), 2_f64.powi(150)]);
        let offset = rng.choose(&[0.0, 0.0, 1e7]) * scale;
        let center =
            |rng: &mut Rng| -> [f64; 3] { std::array::from_fn(|_| offset + scale * rng.integer(-4, 4) as f64) };
        let (p, q) = (center(&mut rng), center(&mut rng));
        let r = scale * rng.integer(0, 4) as f64;
        // The radius that touches from inside or outside, its neighboring floats, or any radius.
        let distance = (0..3).map(|k| (p[k] - q[k]) / scale).map(|x| x * x).sum::<f64>().sqrt() * scale;
        let touching = if round % 2 == 0 { (distance - r).abs() } else { (r - distance).max(0.0) };
        let s = match rng.integer(0, 3) {
            0 => touching,
            1 => touching.next_up(),
            2 => touching.next_down().max(0.0),
            _ => scale * rng.integer(0, 4) as f64,
        };
        let (a, b) = (BoundingSphere::new(p, r).unwrap(), BoundingSphere::new(q, s).unwrap());
        let square = |x: dashu_ratio::RBig| x.clone() * x;
        let between = (0..3).fold(dashu_ratio::RBig::ZERO, |sum, k| sum + square(rational(p[k]) - rational(q[k])));
        let truth = between <= square(rational(r) + rational(s));
        assert_eq!((a.overlaps(&b), b.overlaps(&a)), (truth, truth), "{a:?} {b:?}");
        let inside = s <= r && between <= square(rational(r) - rational(s));
        assert_eq!(a.encloses(&b), inside, "{a:?} {b:?}");
        assert_eq!(a.contains(q), a.holds(&point(q)), "{a:?} {q:?}");
        let merged = a.merged(&b);
        for pole in a.witnesses().iter().chain(&b.witnesses()) {
            assert!(merged.holds(pole), "{a:?} {b:?} {merged:?}");
        }
        met += usize::from(truth);
        held += usize::from(inside);
        close += usize::from(truth != (between <= square((rational(r) + rational(s)) * rational(0.999_999))));
    }
    assert!((1000..3000).contains(&met) && held > 100 && close > 200, "{met} overlap, {held} enclosed, {close} close");
}
