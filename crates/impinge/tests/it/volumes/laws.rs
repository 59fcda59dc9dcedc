//! Invariants of every kind of volume: fitting, merging and moving lose no point, and volumes with
//! a common point are never reported apart.

use impinge::Pose;
use impinge::volume::{BoundingSphere, Capsule, CenterRadius, Kdop14, Kdop18, Kdop26, Lozenge, MinMax, MinWidths, Obb};
use impinge_testkit::generate::Rng;

use crate::volumes::exact::{Exact, Point, image, point};
use crate::volumes::points::{KINDS, cloud, motion};

/// Makes one test per volume for each invariant.
macro_rules! for_every_volume {
    ($($name:ident: $volume:ty),* $(,)?) => {
        mod chains {
            use super::*;
            $(#[test] fn $name() { no_chain_loses_a_point::<$volume>(); })*
        }
        mod overlaps {
            use super::*;
            $(#[test] fn $name() { overlapping_volumes_are_never_apart::<$volume>(); })*
        }
        mod distances {
            use super::*;
            $(#[test] fn $name() { volumes_far_apart_are_reported_apart::<$volume>(); })*
        }
    };
}

for_every_volume! {
    min_max: MinMax,
    min_widths: MinWidths,
    center_radius: CenterRadius,
    sphere: BoundingSphere,
    capsule: Capsule,
    lozenge: Lozenge,
    obb: Obb,
    kdop14: Kdop14,
    kdop18: Kdop18,
    kdop26: Kdop26,
}

/// Checks a chain of two rounds of moving and merging fitted volumes. Every point is followed
/// exactly, and the volume must contain it throughout.
fn no_chain_loses_a_point<V: Exact>() {
    let mut rng = Rng::new(11);
    let mut turned = 0;
    for round in 0..96 {
        let kind = KINDS[round % KINDS.len()];
        let count = rng.integer(1, 12) as usize;
        let (a, b) = (cloud(&mut rng, kind, count), cloud(&mut rng, KINDS[round / 8 % KINDS.len()], 5));
        let fit = |points: &[[f64; 3]]| V::of_points(points).expect("finite points");
        let (mut volume, mut held) = (fit(&a), a.iter().map(|&p| point(p)).collect::<Vec<Point>>());
        all_held(&volume, &held);
        for step in 0..2 {
            let pose = motion(&mut rng);
            volume = volume.moved(&pose).expect("a rigid motion");
            held = held.iter().map(|p| image(&pose, p)).collect();
            all_held(&volume, &held);
            turned += usize::from(pose.linear() != Pose::IDENTITY.linear());
            if step == 0 {
                let other = fit(&b);
                assert_eq!(volume.merged(&other), other.merged(&volume), "the order changes the result");
                volume = volume.merged(&other);
                held.extend(b.iter().map(|&p| point(p)));
                all_held(&volume, &held);
            }
        }
    }
    assert!((100..192).contains(&turned), "{turned} of 192 poses turn");
}

fn all_held<V: Exact>(volume: &V, points: &[Point]) {
    for p in points {
        assert!(volume.holds(p), "{volume:?} lacks {:?}", p.each_ref().map(|x| x.to_f64().value()));
    }
    assert!(volume.volume() >= 0.0 && volume.surface_area() >= 0.0 && volume.volume().is_finite());
}

/// Checks volumes of overlapping clouds, and volumes moved until points of both coincide up to
/// rounding.
fn overlapping_volumes_are_never_apart<V: Exact>() {
    let mut rng = Rng::new(12);
    let (mut met, mut touched) = (0, 0);
    for round in 0..300 {
        let a = cloud(&mut rng, KINDS[round % KINDS.len()], 6);
        let mut b = cloud(&mut rng, KINDS[round / 8 % KINDS.len()], 6);
        if rng.one_in(2) {
            // A common point, in both hulls.
            b[0] = a[1];
        }
        let (mut a, b) = (V::of_points(&a).expect("finite"), V::of_points(&b).expect("finite"));
        if rng.one_in(2) {
            a = a.moved(&motion(&mut rng)).expect("rigid");
        }
        // Move b so that a point of its boundary coincides with a point of a, up to rounding. About
        // half of these pairs touch or overlap.
        let (of_a, of_b) = (a.witnesses(), b.witnesses());
        let mut b = b;
        if let (Some(p), Some(q)) = (of_a.get(round % 5), of_b.get(round % 7)) {
            let by = std::array::from_fn(|k| (p[k].clone() - q[k].clone()).to_f64().value());
            b = b.moved(&Pose::from_translation(by).expect("in range")).expect("rigid");
            touched += 1;
        }
        let of_b = b.witnesses();
        let shared = of_b.iter().any(|q| a.holds(q)) || of_a.iter().any(|p| b.holds(p));
        assert!(!shared || a.overlaps(&b) && b.overlaps(&a), "{a:?}\n{b:?}");
        assert_eq!(a.overlaps(&b), b.overlaps(&a), "{a:?}\n{b:?}");
        for p in of_b.iter().map(|p| p.each_ref().map(|x| x.to_f64().value())) {
            assert!(!a.holds(&point(p)) || a.contains(p), "{a:?} {p:?}");
        }
        met += usize::from(shared);
    }
    assert!(met >= 100 && touched >= 100, "{met} of 300 overlap, {touched} touched");
}

/// Checks that conservative tests stay useful: volumes with a gap of 0.01 times their size are
/// reported apart.
fn volumes_far_apart_are_reported_apart<V: Exact>() {
    let mut rng = Rng::new(13);
    let mut reported = 0;
    for round in 0..200 {
        let kind = KINDS[round % KINDS.len()];
        let (a, b) = (cloud(&mut rng, kind, 6), cloud(&mut rng, kind, 6));
        let (a, b) = (V::of_points(&a).expect("finite"), V::of_points(&b).expect("finite"));
        let (Some([_, top]), Some([bottom, high])) = (a.heights(), b.heights()) else { continue };
        let size = (high - bottom.clone()).to_f64().value()
            + (top.clone() - a.heights().expect("as above")[0].clone()).to_f64().value();
        let rise = (top - bottom).to_f64().value();
        // Corners of tilted volumes stick out further than the highest witness. Twice the size
        // clears them.
        let by = [0.0, 0.0, rise + 2.01 * size + 1e-6 * (1.0 + rise.abs())];
        let b = b.moved(&Pose::from_translation(by).expect("in range")).expect("rigid");
        assert!(!a.overlaps(&b), "{a:?}\n{b:?}");
        reported += 1;
    }
    assert!(reported >= 50, "{reported} of 200");
}
