//! Conversions of poses and positions from and to glam and nalgebra, and poses stored by serde.

use std::collections::HashMap;

use impinge::{InputErrorKind, Pose, Positions};

/// Matrix of a shear with a mirror. Single precision holds all its entries.
const ROWS: [[f64; 4]; 4] =
    [[1.5, 0.25, 0.0, 7.0], [-0.5, 2.0, 0.125, -3.0], [0.75, 0.0, -1.0, 0.5], [0.0, 0.0, 0.0, 1.0]];

/// Point of half-integers, whose image under [`ROWS`] is exact.
const POINT: [f64; 3] = [3.0, -0.5, 2.5];

fn pose() -> Pose {
    Pose::from_matrix(ROWS).expect("a pose")
}

#[test]
fn poses_of_glam_map_points_as_glam_does() {
    use glam::{Affine3A, DAffine3, DMat4, DQuat, DVec3, Mat4, Quat, Vec3};
    let matrix = DMat4::from_cols_array_2d(&ROWS).transpose();
    let affine = DAffine3::from_mat4(matrix);
    let single = Affine3A::from_mat4(matrix.as_mat4());
    let made: [Result<Pose, _>; 4] =
        [matrix.try_into(), matrix.as_mat4().try_into(), affine.try_into(), single.try_into()];
    for made in made {
        assert_eq!(made.expect("a pose"), pose());
    }
    assert_eq!(pose().apply(POINT), affine.transform_point3(DVec3::from_array(POINT)).to_array());
    assert_eq!((DMat4::from(pose()), DAffine3::from(pose())), (matrix, affine));

    let quarter = Pose::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [1.0, 2.0, 3.0]).expect("a pose");
    let half = 0.5_f64.sqrt();
    let translation = DVec3::new(1.0, 2.0, 3.0);
    assert_eq!(Pose::try_from((DQuat::from_xyzw(0.0, 0.0, half, half), translation)).expect("a pose"), quarter);
    let half = half as f32;
    assert_eq!(
        Pose::try_from((Quat::from_xyzw(0.0, 0.0, half, half), translation.as_vec3())).expect("a pose"),
        quarter
    );

    let projective = Mat4::from_cols_array_2d(&ROWS.map(|row| row.map(|x| x as f32)));
    let error = Pose::try_from(projective).expect_err("its last row is a translation");
    assert!(matches!(error.kind(), InputErrorKind::NotAffine { .. }), "{error}");
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert!(matches!(Pose::try_from(flat).expect_err("flat").kind(), InputErrorKind::Singular));

    let singles = Positions::from(vec![Vec3::new(0.5, 1.0, 2.0)]);
    assert_eq!(singles, Positions::F32(vec![[0.5, 1.0, 2.0]]));
    assert_eq!(Positions::from(vec![DVec3::new(0.1, 1.0, 2.0)]), Positions::F64(vec![[0.1, 1.0, 2.0]]));
}

#[test]
fn poses_of_nalgebra_map_points_as_nalgebra_does() {
    use nalgebra::{Affine3, Isometry3, Matrix4, Point3, Quaternion, Similarity3, Translation3, UnitQuaternion};
    let matrix = Matrix4::from_fn(|row, column| ROWS[row][column]);
    let affine = Affine3::from_matrix_unchecked(matrix);
    let made: [Result<Pose, _>; 3] = [matrix.try_into(), matrix.cast::<f32>().try_into(), affine.try_into()];
    for made in made {
        assert_eq!(made.expect("a pose"), pose());
    }
    let image: [f64; 3] = affine.transform_point(&Point3::from(POINT)).into();
    assert_eq!(pose().apply(POINT), image);
    assert_eq!((Matrix4::from(pose()), Affine3::from(pose())), (matrix, affine));

    let quarter = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let half = 0.5_f64.sqrt();
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(half, 0.0, 0.0, half));
    let isometry = Isometry3::from_parts(Translation3::new(1.0, 2.0, 3.0), turn);
    let expected = Pose::new(quarter, [1.0, 2.0, 3.0]).expect("a pose");
    assert_eq!(Pose::try_from(isometry).expect("a pose"), expected);
    assert_eq!(Pose::try_from(isometry.cast::<f32>()).expect("a pose"), expected);
    let doubled = Similarity3::from_isometry(isometry, 2.0);
    let image = Pose::try_from(doubled).expect("a pose").apply(POINT);
    let theirs: [f64; 3] = doubled.transform_point(&Point3::from(POINT)).into();
    assert!((0..3).all(|k| (image[k] - theirs[k]).abs() < 1e-14), "{image:?}, not {theirs:?}");

    let error = Pose::try_from(matrix.transpose()).expect_err("transposed");
    assert!(matches!(error.kind(), InputErrorKind::NotAffine { .. }), "{error}");

    assert_eq!(Positions::from(vec![Point3::new(0.5_f32, 1.0, 2.0)]), Positions::F32(vec![[0.5, 1.0, 2.0]]));
    assert_eq!(Positions::from(vec![Point3::new(0.1, 1.0, 2.0)]), Positions::F64(vec![[0.1, 1.0, 2.0]]));
}

#[test]
fn stored_poses_come_back_to_the_bit_and_are_validated() {
    let turned = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [0.1, -0.0, 1e80]).expect("a pose");
    for pose in [pose(), turned] {
        let text = format!("pose = {}", toml::Value::try_from(pose).expect("finite numbers"));
        let read = toml::from_str::<HashMap<String, Pose>>(&text).expect("a pose")["pose"];
        let bits = |pose: &Pose| (pose.linear().map(|row| row.map(f64::to_bits)), pose.translation().map(f64::to_bits));
        assert_eq!(bits(&read), bits(&pose), "{text}");
    }
    let flat = "pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]";
    let error = toml::from_str::<HashMap<String, Pose>>(flat).expect_err("the second row is zero");
    let singular = Pose::new([[1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0]], [0.0; 3]).expect_err("singular");
    assert!(error.to_string().contains(&singular.to_string()), "{error}");
}
