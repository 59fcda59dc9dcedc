//! Conversions between impinge and `glam`.
//!
//! ```
//! use glam::{DAffine3, DQuat, DVec3, Vec3};
//! use impinge::{Mesh, Pose, query};
//!
//! let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
//! let mesh = Mesh::new(corners, vec![[0, 1, 2]])?;
//! let turned = DAffine3::from_rotation_translation(DQuat::from_rotation_z(1.0), DVec3::new(0.0, 0.0, 2.0));
//! assert!(!query::intersects(&mesh, mesh.at(Pose::try_from(turned)?)));
//! # Ok::<(), impinge::InputError>(())
//! ```

use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec3, Mat4, Quat, Vec3};

use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::Positions;

impl TryFrom<DAffine3> for Pose {
    type Error = InputError;

    /// Builds the pose of an affine map. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::new`].
    fn try_from(affine: DAffine3) -> Result<Self, InputError> {
        Self::new(affine.matrix3.transpose().to_cols_array_2d(), affine.translation.to_array())
    }
}

impl TryFrom<Affine3A> for Pose {
    type Error = InputError;

    /// Builds the pose of an affine map. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::new`].
    fn try_from(affine: Affine3A) -> Result<Self, InputError> {
        let rows = affine.matrix3.transpose().to_cols_array_2d();
        Self::new(rows.map(|row| row.map(f64::from)), affine.translation.to_array().map(f64::from))
    }
}

impl TryFrom<DMat4> for Pose {
    type Error = InputError;

    /// Builds the pose of a matrix. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`].
    fn try_from(matrix: DMat4) -> Result<Self, InputError> {
        Self::from_matrix(matrix.transpose().to_cols_array_2d())
    }
}

impl TryFrom<Mat4> for Pose {
    type Error = InputError;

    /// Builds the pose of a matrix. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`].
    fn try_from(matrix: Mat4) -> Result<Self, InputError> {
        Self::from_matrix(matrix.transpose().to_cols_array_2d().map(|row| row.map(f64::from)))
    }
}

impl TryFrom<(DQuat, DVec3)> for Pose {
    type Error = InputError;

    /// Builds the pose that rotates, then translates. It rounds as [`Pose::from_quaternion_wxyz`]
    /// does.
    ///
    /// # Errors
    /// As [`Pose::from_quaternion_wxyz`].
    fn try_from((rotation, translation): (DQuat, DVec3)) -> Result<Self, InputError> {
        let [x, y, z, w] = rotation.to_array();
        Self::from_quaternion_wxyz(translation.to_array(), [w, x, y, z])
    }
}

impl TryFrom<(Quat, Vec3)> for Pose {
    type Error = InputError;

    /// Builds the pose that rotates, then translates. It rounds as [`Pose::from_quaternion_wxyz`]
    /// does.
    ///
    /// # Errors
    /// As [`Pose::from_quaternion_wxyz`].
    fn try_from((rotation, translation): (Quat, Vec3)) -> Result<Self, InputError> {
        Self::try_from((rotation.as_dquat(), translation.as_dvec3()))
    }
}

impl From<Pose> for DAffine3 {
    fn from(pose: Pose) -> Self {
        let linear = DMat3::from_cols_array_2d(pose.linear()).transpose();
        Self::from_mat3_translation(linear, DVec3::from_array(*pose.translation()))
    }
}

impl From<Pose> for DMat4 {
    fn from(pose: Pose) -> Self {
        DAffine3::from(pose).into()
    }
}

impl From<Vec<Vec3>> for Positions {
    fn from(vertices: Vec<Vec3>) -> Self {
        Self::F32(vertices.into_iter().map(Vec3::into).collect())
    }
}

impl From<Vec<DVec3>> for Positions {
    fn from(vertices: Vec<DVec3>) -> Self {
        Self::F64(vertices.into_iter().map(DVec3::into).collect())
    }
}
