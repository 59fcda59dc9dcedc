//! Two shapes on a lattice: all verbs must agree with each other, in both orders.

#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use impinge::query::{self, Penetrates, Proximity};
use impinge::sweep::{Motion, time_of_impact};
use impinge::{Pose, Shape};
use impinge_fuzz::lattice;
use libfuzzer_sys::fuzz_target;

#[derive(Debug)]
struct Question {
    shapes: [Shape; 2],
    poses: [Pose; 2],
    to: [f64; 3],
}

impl<'a> Arbitrary<'a> for Question {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let shapes = [lattice::shape(bytes)?, lattice::shape(bytes)?];
        let poses = [lattice::pose(bytes)?, lattice::pose(bytes)?];
        Ok(Self { shapes, poses, to: lattice::point(bytes)? })
    }
}

fuzz_target!(|question: Question| {
    let Question { shapes: [shape_a, shape_b], poses: [pose_a, pose_b], to } = question;
    // A turn by a 3-4-5 triangle is not rigid to the last bit, which some shapes reject.
    let (Ok(a), Ok(b)) = (shape_a.at(pose_a), shape_b.at(pose_b)) else { return };
    let meets = query::intersects(&a, &b);
    let proximity = query::proximity(&a, &b);
    assert_eq!(meets, proximity != Proximity::Apart);
    assert_eq!(query::proximity(&b, &a), proximity);

    let distance = query::distance(&a, &b);
    let back = query::distance(&b, &a);
    assert_eq!((distance.lower, distance.upper), (back.lower, back.upper));
    assert_eq!(distance.proximity, proximity);
    assert!(0.0 <= distance.lower && distance.lower <= distance.upper, "{distance:?}");
    assert_eq!(distance.lower > 0.0, proximity == Proximity::Apart, "{distance:?}");
    assert!(distance.upper > 0.0 || proximity == Proximity::Intersects, "{distance:?}");
    assert!(query::within(&a, &b, distance.upper), "{distance:?}");
    // Just below the lower bound rounding may leave it undecided.
    let below = query::nearness(&a, &b, distance.lower.next_down());
    assert!(meets || below != Proximity::Intersects, "{distance:?}");

    let depth = query::penetration(&a, &b);
    assert_eq!(depth.is_some(), meets, "{depth:?}");
    let penetrates = query::penetrates(&a, &b);
    assert!(meets || penetrates == Penetrates::No);
    if let Some(depth) = depth {
        assert!(depth.lower <= depth.upper, "{depth:?}");
        assert!(depth.lower <= 0.0 || penetrates != Penetrates::No, "{depth:?}");
    }
    let contacts = query::contacts(&a, &b);
    assert_eq!(contacts.is_empty(), !meets, "{contacts:?}");
    for point in contacts.iter().flat_map(|manifold| &manifold.points) {
        assert!(point.lower <= point.upper, "{point:?}");
    }

    let still = Motion::resting(pose_a);
    let Ok(end) = Pose::new(*pose_b.linear(), to) else { return };
    let Ok(moving) = Motion::between(pose_b, end) else { return };
    let Ok(impact) = time_of_impact(shape_a.clone(), shape_b.clone(), &still, &moving) else { return };
    assert!(impact.t_lower <= impact.t_upper, "{impact:?}");
    assert!(!meets || impact.t_lower == 0.0, "{impact:?}");
    // Nothing touches before the lower bound, and no contact at the end is missed.
    let (Ok(from), Ok(to)) = (shape_b.at(moving.at(impact.t_lower.min(1.0) / 2.0)), shape_b.at(moving.at(1.0))) else {
        return;
    };
    assert!(meets || impact.t_lower == 0.0 || query::proximity(&a, &from) != Proximity::Intersects, "{impact:?}");
    assert!(impact.hit() || query::proximity(&a, &to) != Proximity::Intersects, "{impact:?}");
});
