//! Conversions between impinge and `nalgebra`.
//!
//! ```
//! use impinge::{Mesh, Pose, query};
//! use nalgebra::{Isometry3, Point3, Vector3};
//!
//! let corners = vec![Point3::new(0.0_f32, 0.0, 0.0), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
//! let mesh = Mesh::new(corners, vec![[0, 1, 2]])?;
//! let turned = Isometry3::new(Vector3::new(0.0, 0.0, 2.0), Vector3::z());
//! assert!(!query::intersects(&mesh, mesh.at(Pose::try_from(turned)?)));
//! # Ok::<(), impinge::InputError>(())
//! ```

use nalgebra::{Affine3, Isometry3, Matrix4, Point3, Similarity3};

use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::Positions;

impl TryFrom<Matrix4<f64>> for Pose {
    type Error = InputError;

    /// Builds the pose of a matrix. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`].
    fn try_from(matrix: Matrix4<f64>) -> Result<Self, InputError> {
        Self::from_matrix(matrix.transpose().into())
    }
}

impl TryFrom<Matrix4<f32>> for Pose {
    type Error = InputError;

    /// Builds the pose of a matrix. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`].
    fn try_from(matrix: Matrix4<f32>) -> Result<Self, InputError> {
        Self::try_from(matrix.cast::<f64>())
    }
}

impl TryFrom<Affine3<f64>> for Pose {
    type Error = InputError;

    /// Builds the pose of a matrix. Its entries keep their values.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`].
    fn try_from(affine: Affine3<f64>) -> Result<Self, InputError> {
        Self::try_from(affine.into_inner())
    }
}

impl TryFrom<Similarity3<f64>> for Pose {
    type Error = InputError;

    /// Builds the pose of a similarity. It rounds as `Similarity3::to_homogeneous` does.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`].
    fn try_from(similarity: Similarity3<f64>) -> Result<Self, InputError> {
        Self::try_from(similarity.to_homogeneous())
    }
}

impl TryFrom<Isometry3<f64>> for Pose {
    type Error = InputError;

    /// Builds the pose of a rigid motion. It rounds as [`Pose::from_quaternion_wxyz`] does.
    ///
    /// # Errors
    /// As [`Pose::from_quaternion_wxyz`].
    fn try_from(isometry: Isometry3<f64>) -> Result<Self, InputError> {
        let rotation = isometry.rotation.quaternion();
        let wxyz = [rotation.w, rotation.i, rotation.j, rotation.k];
        Self::from_quaternion_wxyz(isometry.translation.vector.into(), wxyz)
    }
}

impl TryFrom<Isometry3<f32>> for Pose {
    type Error = InputError;

    /// Builds the pose of a rigid motion. It rounds as [`Pose::from_quaternion_wxyz`] does.
    ///
    /// # Errors
    /// As [`Pose::from_quaternion_wxyz`].
    fn try_from(isometry: Isometry3<f32>) -> Result<Self, InputError> {
        Self::try_from(isometry.cast::<f64>())
    }
}

impl From<Pose> for Matrix4<f64> {
    fn from(pose: Pose) -> Self {
        let (linear, translation) = (pose.linear(), pose.translation());
        Self::from_fn(|row, column| match (row, column) {
            (3, 3) => 1.0,
            (3, _) => 0.0,
            (_, 3) => translation[row],
            _ => linear[row][column],
        })
    }
}

impl From<Pose> for Affine3<f64> {
    fn from(pose: Pose) -> Self {
        // A pose has been validated: its linear part is invertible, its last row is 0, 0, 0, 1.
        Self::from_matrix_unchecked(pose.into())
    }
}

impl From<Vec<Point3<f32>>> for Positions {
    fn from(vertices: Vec<Point3<f32>>) -> Self {
        Self::F32(vertices.into_iter().map(Point3::into).collect())
    }
}

impl From<Vec<Point3<f64>>> for Positions {
    fn from(vertices: Vec<Point3<f64>>) -> Self {
        Self::F64(vertices.into_iter().map(Point3::into).collect())
    }
}
