//! Distances up to a limit, and intersections proved by floats, on scenes full of ties.

use super::*;
use crate::convex::posed::Core;
use crate::math::Pose;
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::rounds;

/// Corners with small integer coordinates, a pose on a grid or a rotated one, and a radius.
struct Polytope {
    corners: Vec<[f64; 3]>,
    pose: Pose,
    radius: f64,
}

impl Polytope {
    fn random(rng: &mut Rng, corners: usize) -> Self {
        let corners = (0..corners).map(|_| [0; 3].map(|_: i32| rng.integer(-2, 2) as f64)).collect();
        let linear = if rng.one_in(2) { poses::cube_symmetry(rng) } else { poses::rotation(rng).linear };
        let translation = [0; 3].map(|_: i32| rng.integer(-4, 4) as f64 * 0.5);
        let radius = if rng.one_in(3) { 0.25 } else { 0.0 };
        Self { corners, pose: Pose::new(linear, translation).unwrap(), radius }
    }

    fn swept(&self) -> Swept<'_> {
        Swept { core: Core::Points(&self.corners), pose: &self.pose, radius: [self.radius; 2] }
    }
}

/// Compares with the complete distance. One state serves all pairs, as for the faces of a mesh.
#[test]
fn a_limit_leaves_out_only_what_is_farther() {
    let mut rng = Rng::new(8_101);
    let mut known = Coherence::default();
    let (mut near, mut far) = (0, 0);
    for _ in 0..rounds(6_000) {
        let (a, b) = (Polytope::random(&mut rng, 3), Polytope::random(&mut rng, 6));
        let [a, b] = if rng.one_in(2) { [a.swept(), b.swept()] } else { [b.swept(), a.swept()] };
        let whole = separation(&a, &b);
        for limit in [0.0, 0.5, whole.lower.next_down(), whole.lower, whole.upper, 2.0 * whole.upper] {
            let limit = limit.max(0.0);
            match separation_within(&a, &b, limit, &mut known) {
                None => {
                    assert!(whole.upper > limit, "{whole:?} {limit}");
                    far += 1;
                }
                Some(found) => {
                    let bits = |found: &Separation| (found.proximity, found.lower, found.upper, found.points);
                    assert_eq!(bits(&found), bits(&whole), "{limit}");
                    assert!(whole.lower <= limit * (1.0 + 1e-9) + 1e-9, "{whole:?} {limit}");
                    near += 1;
                }
            }
        }
    }
    assert!(near > 10_000 && far > 5_000, "{near} {far}");
}

/// Compares with integers, which decide whether two polytopes have a common point.
#[test]
fn floats_prove_intersections_that_are_there() {
    let mut rng = Rng::new(8_102);
    let (mut proved, mut left, mut apart) = (0, 0, 0);
    for _ in 0..rounds(4_000) {
        let (mut a, mut b) = (Polytope::random(&mut rng, 3), Polytope::random(&mut rng, 8));
        (a.radius, b.radius) = (0.0, 0.0);
        let pair = Pair::new(&a.swept(), &b.swept());
        let gap = gap(&pair);
        let is_zero = least_distance(&pair, &gap.simplex).is_some_and(|least| least.is_zero());
        let is_proved = intersects_by_floats(&pair, &gap);
        assert!(is_zero || !is_proved, "{:?} {:?} {:?} {:?}", a.corners, a.pose, b.corners, b.pose);
        *(if is_proved {
            &mut proved
        } else if is_zero {
            &mut left
        } else {
            &mut apart
        }) += 1;
    }
    // Polytopes that only touch are left to integers.
    assert!(proved > 500 && left > 15 && apart > 700 && left < proved / 4, "{proved} {left} {apart}");
}
