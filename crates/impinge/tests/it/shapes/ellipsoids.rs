//! Ellipsoids, which are swept by balls, against the same sets with their own support functions.

use std::sync::Arc;

use impinge::Pose;
use impinge::convex::Support;
use impinge::query::{self, Proximity};
use impinge::shape::{PlacedShape, Shape};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::rounds;

/// An ellipsoid about the origin, by its half-axes.
#[derive(Debug)]
struct Whole([f64; 3]);

impl Support for Whole {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let stretched: [f64; 3] = std::array::from_fn(|k| self.0[k] * direction[k]);
        let length = stretched.iter().map(|x| x * x).sum::<f64>().sqrt();
        std::array::from_fn(|k| if length > 0.0 { self.0[k] * (stretched[k] / length) } else { 0.0 })
    }

    fn reach(&self) -> [f64; 3] {
        self.0
    }
}

/// Returns an ellipsoid in both forms, with sizes and poses on a grid or anywhere.
fn random(rng: &mut Rng, on_grid: bool, span: f64) -> [PlacedShape; 2] {
    let mut size = || if on_grid { rng.choose(&[0.0, 0.25, 0.5, 1.0]) } else { rng.uniform(0.2, 1.0) };
    let half_axes = [size(), size(), size()];
    let linear = if on_grid { poses::cube_symmetry(rng) } else { poses::rotation(rng).linear };
    let mut at = || if on_grid { 0.25 * rng.integer(-2, 2) as f64 } else { rng.uniform(-span, span) };
    let pose = Pose::new(linear, [at(), at(), at()]).expect("a pose");
    let whole = Shape::custom(Arc::new(Whole(half_axes))).expect("a set");
    [Shape::ellipsoid(half_axes).expect("a shape"), whole].map(|shape| shape.at(pose).expect("a rigid pose"))
}

#[test]
fn ellipsoids_agree_with_their_support_functions() {
    let mut rng = Rng::new(577);
    let (mut meets, mut apart, mut narrow) = ([0; 2], [0; 2], 0);
    for round in 0..rounds(600) {
        let on_grid = round % 2 == 0;
        let [a, whole_a] = random(&mut rng, on_grid, 1.0);
        let [b, whole_b] = random(&mut rng, on_grid, 1.0);
        let (proximity, expected) = (query::proximity(&a, &b), query::proximity(&whole_a, &whole_b));
        let is_decided = proximity != Proximity::Undecided && expected != Proximity::Undecided;
        assert!(!is_decided || proximity == expected, "{round}: {proximity:?} {expected:?}");
        let (found, expected) = (query::distance(&a, &b), query::distance(&whole_a, &whole_b));
        assert!(found.lower <= expected.upper && expected.lower <= found.upper, "{round}: {found:?} {expected:?}");
        apart[round % 2] += u32::from(found.lower > 0.0);
        let (found, expected) = (query::penetration(&a, &b), query::penetration(&whole_a, &whole_b));
        if let (Some(found), Some(expected)) = (found, expected) {
            assert!(found.lower <= expected.upper && expected.lower <= found.upper, "{round}: {found:?} {expected:?}");
            meets[round % 2] += u32::from(found.lower > 0.0);
            narrow += u32::from(found.lower > 0.0 && found.upper - found.lower < 1e-9);
            let deepest = |manifolds: Vec<query::Manifold>| {
                let depths = manifolds.iter().flat_map(|manifold| &manifold.points).map(|point| point.upper);
                depths.fold(f64::NEG_INFINITY, f64::max)
            };
            let contacts = deepest(query::contacts(&a, &b));
            assert!((contacts - expected.upper).abs() < 1.0 / 4096.0, "{round}: {contacts} {expected:?}");
        }
    }
    assert!(meets.iter().all(|&meets| meets > 60) && apart.iter().all(|&apart| apart > 20), "{meets:?} {apart:?}");
    assert!(10 * narrow > 9 * (meets[0] + meets[1]), "{narrow} {meets:?}");
}
