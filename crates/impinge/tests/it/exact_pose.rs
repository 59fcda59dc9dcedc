//! Validation of poses, and exact decisions about them: singular or not, mirroring or not.

use crate::exact_oracle::*;
use impinge::{InputErrorKind, Pose};
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::{large_integer_map, rotation};

fn kind(result: Result<Pose, impinge::InputError>) -> InputErrorKind {
    result.expect_err("to be refused").kind().clone()
}

const EYE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn matrix_of(linear: [[f64; 3]; 3], translation: [f64; 3]) -> [[f64; 4]; 4] {
    let row = |i: usize| [linear[i][0], linear[i][1], linear[i][2], translation[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// Checks that each entry that is not finite is reported by its index.
#[test]
fn every_nonfinite_entry_is_rejected_by_index() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for index in 0..16 {
            let mut matrix = matrix_of(EYE, [1.0, 2.0, 3.0]);
            matrix[index / 4][index % 4] = bad;
            assert_eq!(kind(Pose::from_matrix(matrix)), InputErrorKind::NonFinite { what: "pose entry", index });
        }
        assert!(matches!(
            kind(Pose::from_quaternion_wxyz([0.0; 3], [1.0, bad, 0.0, 0.0])),
            InputErrorKind::NonFinite { index: 1, .. }
        ));
        assert!(matches!(
            kind(Pose::from_quaternion_wxyz([0.0, 0.0, bad], [1.0, 0.0, 0.0, 0.0])),
            InputErrorKind::NonFinite { index: 11, .. }
        ));
        assert!(matches!(
            kind(Pose::from_axis_angle([0.0, bad, 0.0], 1.0, [0.0; 3])),
            InputErrorKind::NonFinite { index: 1, .. }
        ));
        assert!(matches!(
            kind(Pose::from_axis_angle([0.0, 1.0, 0.0], bad, [0.0; 3])),
            InputErrorKind::NonFinite { what: "angle", .. }
        ));
    }
}

/// Checks that the largest permitted numbers are accepted, and that the next floats beyond them are
/// rejected.
#[test]
fn limits_of_pose_entries_are_inclusive() {
    let (linear_limit, translation_limit) = (power_of_two(64), power_of_two(300));
    for sign in [1.0, -1.0] {
        for index in 0..12 {
            let mut matrix = matrix_of(EYE, [0.0; 3]);
            let (limit, text) = if index % 4 < 3 { (linear_limit, "2^64") } else { (translation_limit, "2^300") };
            matrix[index / 4][index % 4] = sign * limit;
            assert!(Pose::from_matrix(matrix).is_ok());
            matrix[index / 4][index % 4] = sign * limit.next_up();
            assert_eq!(
                kind(Pose::from_matrix(matrix)),
                InputErrorKind::OutOfRange { what: "pose entry", index, limit: text }
            );
        }
    }
}

/// Checks that a projective last row is an error, and that a matrix stored by columns gets a hint.
#[test]
fn projective_and_transposed_matrices_are_rejected() {
    let mut projective = matrix_of(EYE, [1.0, 2.0, 3.0]);
    projective[3][2] = 1e-9;
    let error = Pose::from_matrix(projective).expect_err("projective");
    assert_eq!(error.hint(), None);
    let matrix = matrix_of(EYE, [1.0, 2.0, 3.0]);
    let transposed = std::array::from_fn(|i| std::array::from_fn(|j| matrix[j][i]));
    let error = Pose::from_matrix(transposed).expect_err("transposed");
    assert_eq!(*error.kind(), InputErrorKind::NotAffine { last_row: [1.0, 2.0, 3.0, 1.0] });
    assert_eq!(error.hint(), Some("looks transposed"));
}

/// Checks that singular matrices are detected exactly, no matter how small or large the determinant
/// is.
#[test]
fn singular_matrices_are_detected_exactly() {
    let third_row = |last: f64| [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.5, 0.7, last]];
    // The decimals 0.1 + 0.4 and so on are rounded in binary, so this matrix has an inverse.
    assert!(Pose::new(third_row(0.9), [0.0; 3]).is_ok());
    // A row that is a multiple of another by a power of two makes the matrix singular.
    let mut random = Random(41);
    let mut mirrored = 0;
    for _ in 0..2000 {
        let mut linear: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| random.unit()));
        let scale = power_of_two(random.pick(&[-1000, -600, -360, -357, -354, -350, -300, -1, 0, 30]));
        linear[2] = linear[0].map(|x| x * 0.5);
        assert_eq!(kind(Pose::new(linear.map(|row| row.map(|x| x * scale)), [0.0; 3])), InputErrorKind::Singular);
        linear[2][1] = linear[2][1].next_up();
        let pose = Pose::new(linear.map(|row| row.map(|x| x * scale)), [0.0; 3]);
        // Scaling may round subnormal entries so that the matrix becomes singular. Above them
        // scaling is exact.
        if scale > 1e-290 {
            let pose = pose.expect("invertible");
            // The determinant is that of the change alone: its cofactor times a positive number.
            let cofactor =
                rational(linear[0][2]) * rational(linear[1][0]) - rational(linear[0][0]) * rational(linear[1][2]);
            assert_eq!(pose.mirrors(), cofactor < rational(0.0));
            mirrored += usize::from(pose.mirrors());
        }
    }
    assert!((300..1700).contains(&mirrored), "{mirrored}");
    let tiny = f64::from_bits(1);
    assert!(
        Pose::new([[tiny, 0.0, 0.0], [0.0, -tiny, 0.0], [0.0, 0.0, tiny]], [0.0; 3]).expect("invertible").mirrors()
    );
}

/// Checks that quaternions too far from unit length are rejected, and that those within the
/// tolerance are normalized.
#[test]
fn quaternions_far_from_unit_length_are_rejected() {
    for bad in
        [[0.0; 4], [2.0, 0.0, 0.0, 0.0], [0.998, 0.0, 0.0, 0.0], [1e200, 1e200, 0.0, 0.0], [1e-200, 0.0, 0.0, 0.0]]
    {
        assert!(matches!(kind(Pose::from_quaternion_wxyz([0.0; 3], bad)), InputErrorKind::NotUnitQuaternion { .. }));
    }
    let mut random = Random(42);
    for _ in 0..1000 {
        let raw: [f64; 4] = std::array::from_fn(|_| random.unit());
        let length = raw.iter().map(|x| x * x).sum::<f64>().sqrt() * (1.0 + 9e-4 * random.unit());
        let pose = Pose::from_quaternion_wxyz([1.0, 2.0, 3.0], raw.map(|x| x / length)).expect("nearly of length one");
        let m = pose.linear();
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| m[i][k] * m[j][k]).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 3e-15);
            }
        }
        assert!(!pose.mirrors());
    }
}

#[test]
fn axis_turns_are_exact() {
    let half = 0.5_f64.sqrt();
    let quarter_about_z = Pose::from_quaternion_wxyz([0.0; 3], [half, 0.0, 0.0, half]).expect("unit");
    assert_eq!(*quarter_about_z.linear(), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let half_about_x = Pose::from_quaternion_wxyz([0.0; 3], [0.0, 1.0, 0.0, 0.0]).expect("unit");
    assert_eq!(*half_about_x.linear(), [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    let third_about_diagonal = Pose::from_quaternion_wxyz([0.0; 3], [0.5; 4]).expect("unit");
    assert_eq!(third_about_diagonal.apply([1.0, 2.0, 3.0]), [3.0, 1.0, 2.0]);
    assert_eq!(Pose::from_quaternion_wxyz([0.0; 3], [1.0, 0.0, 0.0, 0.0]), Ok(Pose::IDENTITY));
    let turned = Pose::from_axis_angle([0.0, 0.0, 1e-200], std::f64::consts::FRAC_PI_2, [0.0; 3]).expect("an axis");
    assert!((turned.apply([1.0, 0.0, 0.0])[1] - 1.0).abs() < 1e-15);
    assert_eq!(kind(Pose::from_axis_angle([0.0; 3], 1.0, [0.0; 3])), InputErrorKind::ZeroAxis);
}

#[test]
fn composition_applies_the_inner_map_first() {
    let mut random = Random(43);
    for _ in 0..500 {
        let (outer, inner) = (
            Pose::new(integer_linear(&mut random, 9), integer_offset(&mut random, 99)).expect("legal"),
            Pose::new(integer_linear(&mut random, 9), integer_offset(&mut random, 99)).expect("legal"),
        );
        let point = integer_offset(&mut random, 9);
        let both = outer.compose(&inner).expect("legal");
        assert_eq!(both.apply(point), outer.apply(inner.apply(point)));
        assert_eq!(both.mirrors(), outer.mirrors() != inner.mirrors());
    }
    let large = Pose::new(EYE.map(|row| row.map(|x| x * power_of_two(40))), [0.0; 3]).expect("legal");
    assert!(matches!(kind(large.compose(&large)), InputErrorKind::OutOfRange { index: 0, .. }));
}

/// Checks that each entry of an inverse is the float nearest to the entry of the rational inverse.
#[test]
fn inverses_are_rounded_once() {
    let mut rng = Rng::new(4807);
    let mut turned = 0;
    for round in 0..300 {
        let map = match round % 3 {
            0 => rotation(&mut rng),
            1 => large_integer_map(&mut rng),
            _ => Affine::new(
                [0; 3].map(|_| [0; 3].map(|_: i32| rng.uniform(-2.0, 2.0))),
                [0; 3].map(|_: i32| rng.uniform(-9.0, 9.0)),
            ),
        };
        let Ok(pose) = Pose::new(map.linear, map.translation) else { continue };
        let Ok(inverse) = pose.inverse() else { continue };
        let exact = map.linear.map(|row| row.map(rational));
        let minor = |i: usize, j: usize| {
            let ([p, q], [r, s]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
            &exact[p][r] * &exact[q][s] - &exact[p][s] * &exact[q][r]
        };
        let determinant = (0..3).map(|j| &exact[0][j] * minor(0, j)).fold(rational(0.0), |sum, x| sum + x);
        for i in 0..3 {
            let row = [0, 1, 2].map(|j| minor(j, i) / &determinant);
            let moved = (0..3).map(|j| &row[j] * rational(-map.translation[j])).fold(rational(0.0), |sum, x| sum + x);
            let entries = row.into_iter().zip(inverse.linear()[i]).chain([(moved, inverse.translation()[i])]);
            for (exact, rounded) in entries {
                let off = |x: f64| (rational(x) - &exact) * (rational(x) - &exact);
                assert!(off(rounded) <= off(rounded.next_up()) && off(rounded) <= off(rounded.next_down()), "{map:?}");
                turned += 1;
            }
        }
    }
    assert!(turned > 3000, "{turned}");
    assert_eq!(Pose::IDENTITY.inverse(), Ok(Pose::IDENTITY));
    let tiny = Pose::new([[1e-30, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).expect("a pose");
    assert!(matches!(kind(tiny.inverse()), InputErrorKind::OutOfRange { index: 0, .. }));
}
