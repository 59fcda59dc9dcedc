//! The exact decision about two triangles against linear programming in integers, and its
//! invariants.

use crate::exact_oracle::*;
use impinge::Pose;
use impinge::exact::{Corners, Placement, Tier, decide_triangles, triangles_intersect};

/// Counts of cases, hits and deciding tiers of a run. They make the test fail if its cases become
/// one-sided.
#[derive(Default, Debug)]
struct Tally {
    cases: usize,
    hits: usize,
    tiers: [usize; 4],
}

impl Tally {
    fn check(&mut self, world_from_a: &Pose, world_from_b: &Pose, a: &Corners, b: &Corners) {
        let decision = decide_triangles(&Placement::new(world_from_a, world_from_b), a, b);
        let truth = oracle_intersects(world_from_a, world_from_b, a, b);
        assert_eq!(decision.intersects, truth, "{world_from_a:?} {world_from_b:?} {a:?} {b:?}");
        self.cases += 1;
        self.hits += usize::from(truth);
        self.tiers[decision.tier as usize] += 1;
    }

    fn assert_hit_rate(&self, low: f64, high: f64) {
        let rate = self.hits as f64 / self.cases as f64;
        assert!((low..=high).contains(&rate), "{self:?}");
    }

    fn assert_tier_rate(&self, tier: Tier, low: f64, high: f64) {
        let rate = self.tiers[tier as usize] as f64 / self.cases as f64;
        assert!((low..=high).contains(&rate), "{tier:?} {self:?}");
    }
}

#[test]
fn ties_in_one_frame_are_decided() {
    let mut random = Random(1);
    let mut tally = Tally::default();
    for _ in 0..4000 {
        let (a, b) = tied_pair(&mut random);
        tally.check(&Pose::IDENTITY, &Pose::IDENTITY, &a, &b);
        let pose = rotation(&mut random);
        tally.check(&pose, &pose, &a, &b);
    }
    tally.assert_hit_rate(0.3, 0.7);
    tally.assert_tier_rate(Tier::Fixed, 0.1, 0.7);
    tally.assert_tier_rate(Tier::Unbounded, 0.0, 0.0);
}

#[test]
fn ties_under_grid_poses() {
    let mut random = Random(2);
    let mut tally = Tally::default();
    for _ in 0..6000 {
        let (a, b) = tied_pair(&mut random);
        let linear_a = integer_linear(&mut random, 1);
        let linear_b = random.pick(&[linear_a, linear_a, linear_a, *Pose::IDENTITY.linear()]);
        let offset_a = integer_offset(&mut random, 3);
        let mut offset_b = offset_a;
        offset_b[random.integer(0, 2) as usize] += random.integer(-1, 1) as f64;
        let world_from_a = Pose::new(linear_a, offset_a).expect("legal");
        let world_from_b = Pose::new(linear_b, offset_b).expect("legal");
        tally.check(&world_from_a, &world_from_b, &a, &b);
    }
    tally.assert_hit_rate(0.2, 0.7);
    tally.assert_tier_rate(Tier::Fixed, 0.1, 0.7);
    tally.assert_tier_rate(Tier::Unbounded, 0.0, 0.0);
}

#[test]
fn ties_under_integer_affine_poses() {
    let mut random = Random(3);
    let mut tally = Tally::default();
    for _ in 0..6000 {
        let (a, b) = tied_pair(&mut random);
        let world_from_a = Pose::new(integer_linear(&mut random, 3), integer_offset(&mut random, 2)).expect("legal");
        if random.one_in(4) {
            let offset = integer_offset(&mut random, 2);
            let world_from_b = Pose::new(integer_linear(&mut random, 2), offset).expect("legal");
            tally.check(&world_from_a, &world_from_b, &a, &b);
        }
        // The same map up to a scale, which the corners undo half of the time.
        let factor = random.pick(&[0.5, -2.0, 3.0]);
        let other = Pose::new(world_from_a.linear().map(|row| row.map(|x| x * factor)), *world_from_a.translation());
        tally.check(&world_from_a, &other.expect("legal"), &a, &scaled_corners(&b, random.pick(&[1.0 / factor, 1.0])));
    }
    tally.assert_hit_rate(0.3, 0.7);
    tally.assert_tier_rate(Tier::Wide, 0.3, 0.9);
}

#[test]
fn ties_under_rotations() {
    let mut random = Random(4);
    let mut tally = Tally::default();
    for _ in 0..4000 {
        let (a, b) = tied_pair(&mut random);
        let world_from_a = rotation(&mut random);
        // The columns are doubled and the corners halved, so that exact ties survive a general
        // rotation.
        let factor = random.pick(&[0.5, 2.0, -1.0]);
        let linear = world_from_a.linear().map(|row| row.map(|x| x * factor));
        let world_from_b = Pose::new(linear, *world_from_a.translation()).expect("legal");
        tally.check(&world_from_a, &world_from_b, &a, &scaled_corners(&b, 1.0 / factor));
        // Each triangle has a rotation of its own.
        tally.check(&world_from_a, &rotation(&mut random), &a, &b);
    }
    tally.assert_hit_rate(0.25, 0.7);
    tally.assert_tier_rate(Tier::Wide, 0.1, 0.7);
    tally.assert_tier_rate(Tier::Filter, 0.3, 0.9);
}

#[test]
fn random_pairs_under_rotations_need_no_exact_arithmetic() {
    let mut random = Random(5);
    let mut tally = Tally::default();
    for _ in 0..3000 {
        let mut corners =
            || -> Corners { std::array::from_fn(|_| std::array::from_fn(|_| f64::from(random.unit() as f32))) };
        let (a, b) = (corners(), corners());
        let (world_from_a, world_from_b) = (rotation(&mut random), rotation(&mut random));
        let nearer = |pose: &Pose| Pose::new(*pose.linear(), pose.translation().map(|t| 0.3 * t)).expect("legal");
        tally.check(&nearer(&world_from_a), &nearer(&world_from_b), &a, &b);
    }
    tally.assert_hit_rate(0.2, 0.7);
    tally.assert_tier_rate(Tier::Filter, 0.999, 1.0);
}

#[test]
fn pairs_one_unit_in_the_last_place_from_touching_are_decided() {
    let mut random = Random(6);
    let mut tally = Tally::default();
    for _ in 0..4000 {
        let (mut a, b) = tied_pair(&mut random);
        // The shift is off the grid, so that differences round.
        let shift = [random.unit(), random.unit(), random.unit()];
        let world_from_a = Pose::from_translation(shift).expect("legal");
        let nudged = shift.map(|t| match random.integer(0, 3) {
            0 => t.next_up(),
            1 => t.next_down(),
            _ => t,
        });
        let world_from_b = Pose::from_translation(nudged).expect("legal");
        tally.check(&world_from_a, &world_from_b, &a, &b);
        let corner = &mut a[random.integer(0, 2) as usize][random.integer(0, 2) as usize];
        *corner = if random.one_in(2) { corner.next_up() } else { corner.next_down() };
        tally.check(&world_from_a, &world_from_b, &a, &b);
        tally.check(&Pose::IDENTITY, &Pose::IDENTITY, &a, &b);
    }
    tally.assert_hit_rate(0.3, 0.7);
}

/// Checks coordinates, translations and linear parts from subnormal numbers to the largest that are
/// valid.
#[test]
fn triangles_from_subnormal_to_the_largest_scale_are_decided() {
    let mut random = Random(7);
    let mut tally = Tally::default();
    for _ in 0..600 {
        let (a, b) = tied_pair(&mut random);
        let world_from_a = Pose::new(integer_linear(&mut random, 2), integer_offset(&mut random, 1)).expect("legal");
        let world_from_b = if random.one_in(2) {
            world_from_a
        } else {
            Pose::new(*world_from_a.linear(), integer_offset(&mut random, 1)).expect("legal")
        };
        for exponent in [-1074, -1073, -1060, -1022, -530, -353, -340, -149, -140, -60, 60, 100, 123] {
            let corner_scale = power_of_two(exponent);
            // The smallest corners cannot be halved exactly.
            let (a, b) = (scaled_corners(&a, 4.0), scaled_corners(&b, 4.0));
            let (a, b) = (scaled_corners(&a, corner_scale), scaled_corners(&b, corner_scale));
            let at = |pose: &Pose, linear: f64| {
                let translation = pose.translation().map(|t| t * 4.0 * corner_scale * linear);
                Pose::new(pose.linear().map(|row| row.map(|x| x * linear)), translation).expect("legal")
            };
            let linear_scale = power_of_two(random.integer(-60, 60) as i32);
            tally.check(&at(&world_from_a, 1.0), &at(&world_from_b, 1.0), &a, &b);
            if exponent > -1000 {
                tally.check(&at(&world_from_a, linear_scale), &at(&world_from_b, linear_scale), &a, &b);
            }
        }
    }
    tally.assert_tier_rate(Tier::Wide, 0.1, 0.9);
    tally.assert_hit_rate(0.3, 0.7);
}

#[test]
fn triangles_of_mixed_scales_are_decided() {
    let mut random = Random(8);
    let mut tally = Tally::default();
    for _ in 0..3000 {
        let (mut a, mut b) = tied_pair(&mut random);
        // A power of two for each axis keeps all ties, and one for each corner keeps some.
        let axes: [f64; 3] = std::array::from_fn(|_| power_of_two(random.integer(-300, 120) as i32));
        for corner in a.iter_mut().chain(&mut b) {
            for k in 0..3 {
                corner[k] *= axes[k];
            }
        }
        if random.one_in(2) {
            let corner = random.integer(0, 2) as usize;
            a[corner] = a[corner].map(|x| x * power_of_two(random.integer(-40, 3) as i32));
        }
        tally.check(&Pose::IDENTITY, &Pose::IDENTITY, &a, &b);
        let huge = Pose::new(
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { power_of_two(64) } else { 0.0 })),
            [power_of_two(300), 0.0, -power_of_two(299)],
        )
        .expect("legal");
        tally.check(&huge, &huge, &a, &b);
        let scaled = Pose::new(huge.linear().map(|row| row.map(|x| x * 0.5)), *huge.translation()).expect("legal");
        tally.check(&huge, &scaled, &a, &scaled_corners(&b, 2.0));
    }
    tally.assert_tier_rate(Tier::Unbounded, 0.2, 0.9);
    tally.assert_hit_rate(0.3, 0.7);
}

/// Checks poses with a linear part so small that the map between the frames exceeds the largest
/// float.
#[test]
fn relative_maps_beyond_the_largest_float_are_decided() {
    let mut random = Random(9);
    let mut tally = Tally::default();
    for _ in 0..1000 {
        let (a, b) = tied_pair(&mut random);
        let tiny = power_of_two(random.pick(&[-1060, -1000, -700]));
        let linear_a = integer_linear(&mut random, 2).map(|row| row.map(|x| x * tiny));
        let linear_b = linear_a.map(|row| row.map(|x| x * power_of_two(random.pick(&[1, 30]))));
        let world_from_a = Pose::new(linear_a, [tiny, 0.0, -tiny]).expect("legal");
        let world_from_b = Pose::new(linear_b, [tiny, 0.0, -tiny]).expect("legal");
        tally.check(&world_from_a, &world_from_b, &a, &b);
        let far = Pose::new(integer_linear(&mut random, 2).map(|row| row.map(|x| x * power_of_two(60))), [0.0; 3]);
        tally.check(&world_from_a, &far.expect("legal"), &a, &b);
    }
    tally.assert_hit_rate(0.05, 0.7);
}

/// Checks that no order of the corners or of the triangles changes the answer.
#[test]
fn all_72_orders_of_corners_and_triangles_agree() {
    let mut random = Random(10);
    let mut hits = 0;
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    for case in 0..3000 {
        let (a, b) = tied_pair(&mut random);
        let world_from_a = match case % 3 {
            0 => Pose::IDENTITY,
            1 => rotation(&mut random),
            _ => Pose::new(integer_linear(&mut random, 3), [0.0; 3]).expect("legal"),
        };
        let world_from_b = if random.one_in(2) { world_from_a } else { scaled(&world_from_a, 2.0) };
        let (there, back) =
            (Placement::new(&world_from_a, &world_from_b), Placement::new(&world_from_b, &world_from_a));
        let expected = triangles_intersect(&there, &a, &b);
        hits += usize::from(expected);
        for order_a in orders {
            for order_b in orders {
                let (a, b) = (order_a.map(|i| a[i]), order_b.map(|j| b[j]));
                assert_eq!(triangles_intersect(&there, &a, &b), expected);
                assert_eq!(triangles_intersect(&back, &b, &a), expected);
            }
        }
    }
    assert!((900..2100).contains(&hits), "{hits}");
}

/// Checks that moving both triangles by one affine map, or scaling both by a power of two, changes
/// no answer.
#[test]
fn moving_both_keeps_the_answer() {
    let mut random = Random(11);
    let mut hits = 0;
    for _ in 0..5000 {
        let (a, b) = tied_pair(&mut random);
        let offset_a = integer_offset(&mut random, 1);
        let mut offset_b = offset_a;
        offset_b[random.integer(0, 2) as usize] += random.pick(&[0.0, 0.0, 1.0]);
        let linear = integer_linear(&mut random, 2);
        let world_from_a = Pose::new(linear, offset_a).expect("legal");
        let world_from_b = Pose::new(linear, offset_b).expect("legal");
        let expected = triangles_intersect(&Placement::new(&world_from_a, &world_from_b), &a, &b);
        hits += usize::from(expected);
        // The entries are small integers, so composing the poses rounds nothing.
        let moved = Pose::new(integer_linear(&mut random, 9), integer_offset(&mut random, 99)).expect("legal");
        let (moved_a, moved_b) =
            (moved.compose(&world_from_a).expect("legal"), moved.compose(&world_from_b).expect("legal"));
        assert_eq!(triangles_intersect(&Placement::new(&moved_a, &moved_b), &a, &b), expected);
        let factor = power_of_two(random.integer(-140, 58) as i32);
        let placement = Placement::new(&scaled(&moved_a, factor), &scaled(&moved_b, factor));
        assert_eq!(triangles_intersect(&placement, &a, &b), expected);
    }
    assert!((1500..3500).contains(&hits), "{hits}");
}

/// Checks that zeros of either sign are the same number.
#[test]
fn negative_zero_is_zero() {
    let mut random = Random(12);
    let negated = |x: f64| if x == 0.0 { -x } else { x };
    for _ in 0..2000 {
        let (a, b) = tied_pair(&mut random);
        let flipped = a.map(|corner| corner.map(negated));
        let placement = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        assert_eq!(triangles_intersect(&placement, &a, &b), triangles_intersect(&placement, &flipped, &b));
        let pose = Pose::new(Pose::IDENTITY.linear().map(|row| row.map(negated)), [-0.0; 3]).expect("legal");
        let placement = Placement::new(&Pose::IDENTITY, &pose);
        assert!(placement.is_shared());
    }
}

/// Checks each kind of contact against its known answer, also at a general rotation that keeps
/// ties.
#[test]
fn each_kind_of_contact_has_its_known_answer() {
    const FLOOR: Corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let point = |p: [f64; 3]| [p, p, p];
    let segment = |p: [f64; 3], q: [f64; 3]| [p, q, [0, 1, 2].map(|k| 0.5 * (p[k] + q[k]))];
    let cases: &[(&str, Corners, Corners, bool)] = &[
        ("corner on face", FLOOR, [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]], true),
        ("corner above face", FLOOR, [[1.0, 1.0, 1.0], [1.0, 1.0, 2.0], [2.0, 1.0, 2.0]], false),
        ("shared corner only", FLOOR, [[0.0, 0.0, 0.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]], true),
        ("shared edge only", FLOOR, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, -1.0, 1.0]], true),
        ("corner on edge", FLOOR, [[2.0, 0.0, 0.0], [2.0, -1.0, 1.0], [2.0, -1.0, -1.0]], true),
        ("edges cross", FLOOR, [[2.0, 0.0, 1.0], [2.0, 0.0, -1.0], [2.0, -1.0, 0.0]], true),
        ("plane cut, triangle missed", FLOOR, [[5.0, 5.0, 1.0], [5.0, 5.0, -1.0], [6.0, 5.0, 0.0]], false),
        ("coplanar, contained", FLOOR, [[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]], true),
        ("coplanar, overlapping", FLOOR, [[1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [5.0, 2.0, 0.0]], true),
        ("coplanar, corner on edge", FLOOR, [[2.0, 2.0, 0.0], [4.0, 2.0, 0.0], [2.0, 4.0, 0.0]], true),
        ("coplanar, collinear edges apart", FLOOR, [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, -1.0, 0.0]], false),
        ("coplanar, apart though boxes overlap", FLOOR, [[3.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 4.0, 0.0]], false),
        ("parallel planes", FLOOR, FLOOR.map(|[x, y, _]| [x, y, 1.0]), false),
        ("the same", FLOOR, FLOOR, true),
        ("point on face", FLOOR, point([1.0, 1.0, 0.0]), true),
        ("point on edge", FLOOR, point([2.0, 2.0, 0.0]), true),
        ("point beside", FLOOR, point([3.0, 2.0, 0.0]), false),
        ("point above", FLOOR, point([1.0, 1.0, 1.0]), false),
        ("segment through face", FLOOR, segment([1.0, 1.0, 1.0], [1.0, 1.0, -1.0]), true),
        ("segment ends on face", FLOOR, segment([1.0, 1.0, 1.0], [1.0, 1.0, 0.0]), true),
        ("segment ends above face", FLOOR, segment([1.0, 1.0, 2.0], [1.0, 1.0, 1.0]), false),
        ("segment in plane, across", FLOOR, segment([-1.0, 1.0, 0.0], [5.0, 1.0, 0.0]), true),
        ("segment in plane, touching a corner", FLOOR, segment([-1.0, 1.0, 0.0], [1.0, -1.0, 0.0]), true),
        ("segment in plane, beside", FLOOR, segment([-2.0, 1.0, 0.0], [1.0, -2.0, 0.0]), false),
        ("segments cross", segment([0.0; 3], [2.0, 2.0, 2.0]), segment([2.0, 0.0, 0.0], [0.0, 2.0, 2.0]), true),
        ("segments skew", segment([0.0; 3], [2.0, 2.0, 2.0]), segment([2.0, 0.0, 1.0], [0.0, 2.0, 2.0]), false),
        ("segments in a line, apart", segment([0.0; 3], [1.0; 3]), segment([2.0; 3], [3.0; 3]), false),
        ("segments in a line, touching", segment([0.0; 3], [1.0; 3]), segment([1.0; 3], [3.0; 3]), true),
        ("segments parallel", segment([0.0; 3], [1.0; 3]), segment([0.0, 0.0, 1.0], [1.0, 1.0, 2.0]), false),
        ("point on segment", segment([0.0; 3], [2.0; 3]), point([1.0; 3]), true),
        ("point beyond segment", segment([0.0; 3], [2.0; 3]), point([3.0; 3]), false),
        ("point beside segment", segment([0.0; 3], [2.0; 3]), point([1.0, 1.0, 0.0]), false),
        ("points equal", point([1.0; 3]), point([1.0; 3]), true),
        ("points different", point([1.0; 3]), point([1.0, 1.0, 2.0]), false),
    ];
    let turned = rotation(&mut Random(13));
    let doubled = Pose::new(turned.linear().map(|row| row.map(|x| x * 2.0)), *turned.translation()).expect("legal");
    for (name, a, b, expected) in cases {
        let halved = scaled_corners(b, 0.5);
        for (world_from_a, world_from_b, b) in
            [(&Pose::IDENTITY, &Pose::IDENTITY, b), (&turned, &turned, b), (&turned, &doubled, &halved)]
        {
            assert_eq!(triangles_intersect(&Placement::new(world_from_a, world_from_b), a, b), *expected, "{name}");
            assert_eq!(triangles_intersect(&Placement::new(world_from_b, world_from_a), b, a), *expected, "{name}");
        }
    }
}
