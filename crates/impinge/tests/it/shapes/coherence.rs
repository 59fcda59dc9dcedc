//! Caches of shape queries, which must change no answer.

use impinge::query::{self, Cache, Query};
use impinge::{Pose, Shape};
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::support::Known;

#[test]
fn caches_change_no_answer() {
    let all = Known::all();
    let mut rng = Rng::new(581);
    let mut changes = 0;
    // One more cache serves all pairs. Its state of another pair is only a bad start.
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
    let [x, y] = [x, y].map(|shape| shape.at(Pose::IDENTITY).unwrap());
    for clearance in [f64::NAN, -1.0] {
        assert!(!Query::new().with_cache(&mut shared).within(&x, &y, clearance));
    }
    assert!(Query::new().with_cache(&mut shared).within(&x, &y, f64::INFINITY));
}

#[test]
fn a_cache_changes_no_undecided_verdict() {
    // Cylinders and boxes that touch, or are apart by units in the last place.
    let drum = Shape::cylinder(1.0, 0.5).unwrap();
    let (block, ball) = (Shape::cuboid([0.5, 0.5, 1.0]).unwrap(), Shape::sphere([0.0; 3], 1.0).unwrap());
    let mut seen = [0; 3];
    for (a, b) in [(&drum, &drum), (&drum, &block), (&block, &block), (&ball, &drum)] {
        let here = a.at(Pose::IDENTITY).unwrap();
        let mut cache = Cache::default();
        for steps in [0, 1, 8, 16, 32, 64, 128, 512, 1 << 20, 1] {
            for (sign, beside) in [(1, 0.0), (-1, 0.0), (1, 0.375), (1, 0.15625)] {
                let apart = f64::from_bits((2.0_f64.to_bits() as i64 + sign * steps) as u64);
                let there = b.at(Pose::from_translation([beside, 0.5 * beside, apart]).unwrap()).unwrap();
                let cold = query::proximity(&here, &there);
                assert_eq!(Query::new().with_cache(&mut cache).proximity(&here, &there), cold, "{apart:e}");
                assert_eq!(Query::new().with_cache(&mut Cache::default()).proximity(&there, &here), cold, "{apart:e}");
                seen[cold as usize] += 1;
            }
        }
    }
    assert!(seen[0] > 4 && seen.iter().sum::<i32>() == 160, "{seen:?}");
}
