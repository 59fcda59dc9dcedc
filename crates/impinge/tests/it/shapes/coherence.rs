//! What is known from the last question changes no answer.

use impinge::query::shapes::{self, ShapeCache};
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::support::Known;

#[test]
fn caches_change_no_answer() {
    let all = Known::all();
    let mut rng = Rng::new(581);
    let mut changes = 0;
    // One cache for all pairs too: what it says of others is only a bad start.
    let mut shared = ShapeCache::default();
    for a in &all {
        for b in &all {
            let mut cache = ShapeCache::default();
            let mut place = poses::rotation(&mut rng);
            let here = a.shape().at(pose(&place)).unwrap();
            let start: [f64; 3] = std::array::from_fn(|_| rng.uniform(-3.0, 3.0));
            let mut last = None;
            let at = place.translation;
            for step in 0..12 {
                let along = 1.0 - f64::from(step) / 6.0;
                place.translation = std::array::from_fn(|k| at[k] + start[k] * along);
                let there = b.shape().at(pose(&place)).unwrap();
                for clearance in [0.0, 0.25] {
                    let cold = shapes::within(&here, &there, clearance);
                    assert_eq!(shapes::within_with(&here, &there, clearance, &mut cache), cold);
                    assert_eq!(shapes::within_with(&there, &here, clearance, &mut shared), cold);
                }
                let hit = shapes::intersects(&here, &there);
                changes += usize::from(last.is_some_and(|last| last != hit));
                last = Some(hit);
            }
        }
    }
    assert!(changes > 100, "{changes}");
    let (x, y) = (all[5].shape(), all[9].shape());
    let [x, y] = [x, y].map(|shape| shape.at(impinge::Pose::IDENTITY).unwrap());
    for clearance in [f64::NAN, -1.0] {
        assert!(!shapes::within_with(&x, &y, clearance, &mut shared));
    }
    assert!(shapes::within_with(&x, &y, f64::INFINITY, &mut shared));
}
