//! What is known from the last question changes no answer.

use impinge::query::{self, Cache, Query};
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::support::Known;

#[test]
fn caches_change_no_answer() {
    let all = Known::all();
    let mut rng = Rng::new(581);
    let mut changes = 0;
    // One cache for all pairs too: what it says of others is only a bad start.
    let mut shared = Cache::default();
    for a in &all {
        for b in &all {
            let mut cache = Cache::default();
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
                    let cold = query::within(&here, &there, clearance);
                    assert_eq!(Query::new().with_cache(&mut cache).within(&here, &there, clearance), cold);
                    assert_eq!(Query::new().with_cache(&mut shared).within(&there, &here, clearance), cold);
                }
                let hit = query::intersects(&here, &there);
                changes += usize::from(last.is_some_and(|last| last != hit));
                last = Some(hit);
            }
        }
    }
    assert!(changes > 100, "{changes}");
    let (x, y) = (all[5].shape(), all[9].shape());
    let [x, y] = [x, y].map(|shape| shape.at(impinge::Pose::IDENTITY).unwrap());
    for clearance in [f64::NAN, -1.0] {
        assert!(!Query::new().with_cache(&mut shared).within(&x, &y, clearance));
    }
    assert!(Query::new().with_cache(&mut shared).within(&x, &y, f64::INFINITY));
}
