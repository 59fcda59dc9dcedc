//! The error bounds of the map between two frames, against exact rational inverses.

use crate::exact_oracle::*;
use dashu_ratio::RBig;
use impinge::Pose;
use impinge::math::RelativeMap;

type Matrix = [[RBig; 3]; 3];

fn rational_matrix(m: &[[f64; 3]; 3]) -> Matrix {
    m.map(|row| row.map(rational))
}

fn inverse(m: &Matrix) -> Matrix {
    let minor = |i: usize, j: usize| {
        let (r0, r1, c0, c1) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[r0][c0].clone() * m[r1][c1].clone() - m[r0][c1].clone() * m[r1][c0].clone()
    };
    let determinant = (0..3).fold(RBig::ZERO, |sum, j| sum + m[0][j].clone() * minor(0, j));
    std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant.clone()))
}

fn times(m: &Matrix, v: &[RBig; 3]) -> [RBig; 3] {
    std::array::from_fn(|i| (0..3).fold(RBig::ZERO, |sum, k| sum + m[i][k].clone() * v[k].clone()))
}

fn magnitude(x: RBig) -> RBig {
    if x < RBig::ZERO { -x } else { x }
}

/// Returns the columns of the exact linear part of the map from B's frame to A's, and its exact
/// translation.
fn truth(world_from_a: &Pose, world_from_b: &Pose) -> ([[RBig; 3]; 3], [RBig; 3]) {
    let inverse = inverse(&rational_matrix(world_from_a.linear()));
    let linear_b = rational_matrix(world_from_b.linear());
    let columns = [0, 1, 2].map(|j| times(&inverse, &[0, 1, 2].map(|k| linear_b[k][j].clone())));
    let offset: [RBig; 3] =
        std::array::from_fn(|k| rational(world_from_b.translation()[k]) - rational(world_from_a.translation()[k]));
    (columns, times(&inverse, &offset))
}

/// Checks every error bound, and returns the largest ratio of a linear error bound to the largest
/// entry of its row.
fn check(world_from_a: &Pose, world_from_b: &Pose) -> f64 {
    let map = RelativeMap::a_from_b(world_from_a, world_from_b);
    let (columns, translation) = truth(world_from_a, world_from_b);
    let holds = |true_value: &RBig, value: f64, error: f64| {
        assert!(value.is_finite() && error >= 0.0);
        error == f64::INFINITY || magnitude(true_value.clone() - rational(value)) <= rational(error)
    };
    let mut worst = 0.0_f64;
    for i in 0..3 {
        let size = (0..3).map(|j| map.linear[i][j].abs()).fold(0.0, f64::max);
        for j in 0..3 {
            assert!(
                holds(&columns[j][i], map.linear[i][j], map.linear_error[i][j]),
                "{world_from_a:?} {world_from_b:?}"
            );
            worst = worst.max(map.linear_error[i][j] / size);
        }
        assert!(
            holds(&translation[i], map.translation[i], map.translation_error[i]),
            "{world_from_a:?} {world_from_b:?}"
        );
    }
    worst
}

#[test]
fn rigid_maps_are_tight() {
    let mut random = Random(31);
    for _ in 0..2000 {
        let (a, b) = (rotation(&mut random), rotation(&mut random));
        let worst = check(&a, &b);
        assert!(worst < 1e-14, "{worst}");
        // Far from the origin but near each other: the offset is exact.
        let far = |pose: &Pose| Pose::new(*pose.linear(), pose.translation().map(|t| t + 1e9)).expect("legal");
        assert!(check(&far(&a), &far(&b)) < 1e-14);
    }
}

#[test]
fn the_offset_counts_in_full() {
    let mut random = Random(32);
    for _ in 0..1000 {
        let at = |random: &mut Random, pose: &Pose| {
            let translation = [random.unit() * 1e9, random.unit(), random.unit() * 1e-9];
            Pose::new(*pose.linear(), translation).expect("legal")
        };
        let (turned, other) = (rotation(&mut random), rotation(&mut random));
        check(&at(&mut random, &turned), &at(&mut random, &other));
        check(&at(&mut random, &Pose::IDENTITY), &at(&mut random, &other));
    }
}

#[test]
fn shears_and_scales_keep_relative_bounds() {
    let mut random = Random(33);
    for _ in 0..3000 {
        let mut pose = || {
            let base = match random.integer(0, 2) {
                0 => *rotation(&mut random).linear(),
                1 => integer_linear(&mut random, 3),
                _ => std::array::from_fn(|_| std::array::from_fn(|_| random.unit())),
            };
            let rows: [f64; 3] = std::array::from_fn(|_| power_of_two(random.integer(-60, 30) as i32));
            let columns: [f64; 3] = std::array::from_fn(|_| power_of_two(random.integer(-60, 30) as i32));
            let mut linear = base;
            for i in 0..3 {
                for j in 0..3 {
                    linear[i][j] *= rows[i] * columns[j];
                }
            }
            if random.one_in(3) {
                // Nearly singular: one row is almost the sum of the others.
                linear[2] = std::array::from_fn(|j| linear[0][j] + linear[1][j]);
                linear[2][0] *= 1.0 + f64::EPSILON;
            }
            Pose::new(linear, [random.unit(), random.unit() * 1e12, random.unit() * 1e-12])
        };
        if let (Ok(a), Ok(b)) = (pose(), pose()) {
            let worst = check(&a, &b);
            assert!(worst <= 1e-12, "{worst} {a:?} {b:?}");
        }
    }
}

/// Checks the bounds for maps whose approximate inverse has a residual above rounding, up to the
/// limit at which it is rejected.
#[test]
fn moderate_shears_keep_their_bounds() {
    let mut random = Random(37);
    for _ in 0..10_000 {
        let mut pose = || {
            let mut linear: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| random.unit()));
            let closeness = random.pick(&[1.0, 0.1, 0.01]);
            linear[2] = std::array::from_fn(|j| linear[0][j] - linear[1][j] + closeness * linear[2][j]);
            Pose::new(linear, [random.unit(), random.unit(), random.unit()]).expect("legal")
        };
        let worst = check(&pose(), &pose());
        assert!(worst <= 1e-12, "{worst}");
    }
}

#[test]
fn a_thin_scale_has_a_tight_inverse() {
    let thin = Pose::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1e-20]], [0.0; 3]).expect("legal");
    assert!(check(&thin, &Pose::IDENTITY) < 1e-14);
    let map = RelativeMap::a_from_b(&thin, &Pose::IDENTITY);
    assert!((map.linear[2][2] * 1e-20 - 1.0).abs() < 1e-15);

    // Scales of axes that differ by more than the square of a float's precision, before and after a
    // turn.
    let mut random = Random(38);
    let scales = [power_of_two(60), 1.0, power_of_two(-60)];
    for _ in 0..200 {
        let turn = *rotation(&mut random).linear();
        let rows: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| turn[i][j] * scales[i]));
        let columns: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| turn[i][j] * scales[j]));
        for linear in [rows, columns] {
            assert!(check(&Pose::new(linear, [0.0; 3]).expect("legal"), &Pose::IDENTITY) <= 1e-12);
        }
    }
    let diagonal = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { scales[i] } else { 0.0 }));
    assert!(check(&Pose::new(diagonal, [0.0; 3]).expect("legal"), &Pose::IDENTITY) < 1e-14);
}

#[test]
fn bounds_hold_at_every_scale() {
    let mut random = Random(34);
    let mut infinite = 0;
    for _ in 0..3000 {
        let mut pose = || {
            let scale = power_of_two(random.pick(&[-1060, -1000, -600, -60, 0, 60]));
            let stretch = power_of_two(random.pick(&[0, 0, -40]));
            // The stretch comes before the turn. No approximate inverse in floats survives that.
            let linear = integer_linear(&mut random, 3).map(|[x, y, z]| [x * scale, y * scale * stretch, z * scale]);
            if Pose::new(linear, [0.0; 3]).is_err() {
                // The stretch has rounded subnormal entries.
                return Pose::IDENTITY;
            }
            let far = power_of_two(random.pick(&[-1074, -600, 0, 290, 299]));
            Pose::new(linear, [random.unit() * far, 0.0, far]).expect("legal")
        };
        let (a, b) = (pose(), pose());
        check(&a, &b);
        let map = RelativeMap::a_from_b(&a, &b);
        infinite += usize::from(map.linear_error.iter().flatten().any(|error| *error == f64::INFINITY));
    }
    assert!((100..1500).contains(&infinite), "{infinite}");
}

#[test]
fn exact_parts_have_zero_error() {
    let mut random = Random(35);
    for _ in 0..200 {
        let (a, b) = (rotation(&mut random), rotation(&mut random));
        assert_eq!(RelativeMap::a_from_b(&a, &a), RelativeMap::IDENTITY);

        let from_identity = RelativeMap::a_from_b(&Pose::IDENTITY, &b);
        assert_eq!(from_identity.linear, *b.linear());
        assert_eq!(from_identity.linear_error, [[0.0; 3]; 3]);
        assert_eq!(from_identity.translation_error, [0.0; 3]);

        let beside = Pose::new(*a.linear(), *b.translation()).expect("legal");
        let same_turn = RelativeMap::a_from_b(&a, &beside);
        assert_eq!(same_turn.linear, RelativeMap::IDENTITY.linear);
        assert_eq!(same_turn.linear_error, [[0.0; 3]; 3]);

        let same_place = Pose::new(*b.linear(), *a.translation()).expect("legal");
        assert_eq!(RelativeMap::a_from_b(&a, &same_place).translation_error, [0.0; 3]);

        // One of the two translations is below the last place of the other.
        let at = |t: f64| Pose::from_translation([t, 0.0, 0.0]).expect("legal");
        let rounded = RelativeMap::a_from_b(&at(1e-30), &at(1.0));
        assert_eq!((rounded.translation[0], rounded.translation_error[0]), (1.0, 1e-30));
    }
}

#[test]
fn images_are_within_their_error() {
    let mut random = Random(36);
    for case in 0..4000 {
        let (a, b) = match case % 3 {
            0 => (rotation(&mut random), rotation(&mut random)),
            // Only the evaluation rounds here.
            1 => (Pose::IDENTITY, Pose::new(*rotation(&mut random).linear(), [0.0; 3]).expect("legal")),
            _ => (rotation(&mut random), scaled(&rotation(&mut random), power_of_two(random.integer(-500, 60) as i32))),
        };
        let map = RelativeMap::a_from_b(&a, &b);
        let (columns, translation) = truth(&a, &b);
        let size = power_of_two(random.pick(&[-1074, -1070, -500, -20, 0, 20, 127]));
        let v: [f64; 3] = std::array::from_fn(|_| random.unit() * size);
        let image = map.apply(v);
        let error = map.image_error(v.map(f64::abs));
        for i in 0..3 {
            let exact = (0..3).fold(translation[i].clone(), |sum, k| sum + columns[k][i].clone() * rational(v[k]));
            assert!(magnitude(exact - rational(image[i])) <= rational(error[i]), "{a:?} {b:?} {v:?}");
        }
    }
}
