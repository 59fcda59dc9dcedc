//! Affine maps from a mesh's frame to the world frame.

use std::ops::Mul;

use super::Sign;
use super::dyadic::{self, Dyadic};
use super::sine::{MAX_ANGLE, sine_and_cosine};
use crate::input::{InputError, InputErrorKind};

/// Maximum magnitude of an entry of the linear part, 2^64. With vertices below 2^128 and
/// translations within 2^300, every posed coordinate and every product of three of them is in the
/// range of a double.
const LINEAR_LIMIT: f64 = (1_u128 << 64) as f64;

/// Maximum magnitude of a translation entry, 2^300.
const TRANSLATION_LIMIT: f64 = f64::from_bits((1023 + 300) << 52);

/// Maximum deviation of a quaternion's length from 1. A quaternion written with three decimal
/// digits per entry passes. One that was never normalized, or an angle in its place, does not.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// The affine map `x = linear · v + translation` from one frame to another, such as from a mesh
/// frame to the world frame. Its entries are the exact values of the floats.
///
/// Every invertible map whose entries are within the limits of [`new`](Self::new) is a valid pose,
/// shears and mirrors included. The matrix is never made orthonormal. Two poses are equal if all
/// their entries are; zeros of either sign are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
    mirrors: bool,
}

impl Pose {
    /// The pose that moves nothing: both frames are the same.
    pub const IDENTITY: Self =
        Self { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3], mirrors: false };

    /// Builds a pose from its linear part, in rows, and its translation, in units of the frame that
    /// the pose maps to.
    ///
    /// # Errors
    /// An entry is named by its index in the row-major 4x4 matrix.
    /// - [`NonFinite`](InputErrorKind::NonFinite) if an entry is NaN or infinite.
    /// - [`OutOfRange`](InputErrorKind::OutOfRange) if the magnitude of an entry is above 2^64
    ///   (linear part) or 2^300 (translation).
    /// - [`Singular`](InputErrorKind::Singular) if the determinant is zero. This is decided
    ///   exactly.
    pub fn new(linear: [[f64; 3]; 3], translation: [f64; 3]) -> Result<Self, InputError> {
        let entries = |row: usize| [linear[row][0], linear[row][1], linear[row][2], translation[row]];
        for row in 0..3 {
            for (column, entry) in entries(row).into_iter().enumerate() {
                let index = 4 * row + column;
                let (bound, limit) = if column < 3 { (LINEAR_LIMIT, "2^64") } else { (TRANSLATION_LIMIT, "2^300") };
                if !entry.is_finite() {
                    return Err(InputError::new(InputErrorKind::NonFinite { what: "pose entry", index }));
                }
                if entry.abs() > bound {
                    return Err(InputError::new(InputErrorKind::OutOfRange { what: "pose entry", index, limit }));
                }
            }
        }
        match determinant_sign(&linear) {
            Sign::Zero => Err(InputError::new(InputErrorKind::Singular)),
            sign => Ok(Self { linear, translation, mirrors: sign == Sign::Negative }),
        }
    }

    /// Builds a pose from a 4x4 matrix, in rows, that multiplies column vectors from the left.
    ///
    /// # Errors
    /// As [`new`](Self::new). Also [`NotAffine`](InputErrorKind::NotAffine) if the last row is not
    /// 0, 0, 0, 1.
    pub fn from_matrix(matrix: [[f64; 4]; 4]) -> Result<Self, InputError> {
        let last_row = matrix[3];
        if let Some(column) = last_row.iter().position(|entry| !entry.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "pose entry", index: 12 + column }));
        }
        if last_row != [0.0, 0.0, 0.0, 1.0] {
            let error = InputError::new(InputErrorKind::NotAffine { last_row });
            let last_column = matrix.map(|row| row[3]);
            return Err(if last_column == [0.0, 0.0, 0.0, 1.0] { error.with_hint("looks transposed") } else { error });
        }
        let rows = [matrix[0], matrix[1], matrix[2]];
        Self::new(rows.map(|[x, y, z, _]| [x, y, z]), rows.map(|row| row[3]))
    }

    /// Builds a pose that only translates, by a vector in units of the frame that the pose maps to.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_translation(translation: [f64; 3]) -> Result<Self, InputError> {
        Self::new(Self::IDENTITY.linear, translation)
    }

    /// Builds a pose that rotates by a unit quaternion `[w, x, y, z]` and then translates.
    ///
    /// # Accuracy
    /// The quaternion is normalized: every entry of the matrix is divided by its squared length. So
    /// half and quarter turns about the axes are exact. Other entries are within 1e-15 of those of
    /// an exact rotation.
    ///
    /// # Errors
    /// As [`new`](Self::new). Also [`NotUnitQuaternion`](InputErrorKind::NotUnitQuaternion) if the
    /// length differs from 1 by more than 1e-3.
    pub fn from_quaternion_wxyz(translation: [f64; 3], quaternion: [f64; 4]) -> Result<Self, InputError> {
        if let Some(index) = quaternion.iter().position(|entry| !entry.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "quaternion entry", index }));
        }
        let length = quaternion.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        let deviation = (length - 1.0).abs();
        if deviation > QUATERNION_TOLERANCE {
            return Err(InputError::new(InputErrorKind::NotUnitQuaternion { length }).with_hint("normalize it"));
        }
        Self::new(rotation(quaternion), translation)
    }

    /// Builds a pose that rotates about an axis through the origin by an angle in radians,
    /// right-handed, and then translates.
    ///
    /// # Accuracy
    /// The sine and cosine are those of the platform, so the last bits of the matrix may differ
    /// between platforms. The resulting matrix is then used exactly. For the same pose everywhere,
    /// pass a quaternion or a matrix.
    ///
    /// # Errors
    /// As [`new`](Self::new). Also [`ZeroAxis`](InputErrorKind::ZeroAxis) if the axis has length
    /// zero.
    pub fn from_axis_angle(axis: [f64; 3], angle_rad: f64, translation: [f64; 3]) -> Result<Self, InputError> {
        if let Some(index) = axis.iter().position(|entry| !entry.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "axis entry", index }));
        }
        if !angle_rad.is_finite() {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "angle", index: 0 }));
        }
        let largest = axis.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        if largest == 0.0 {
            return Err(InputError::new(InputErrorKind::ZeroAxis));
        }
        // Divide by the largest entry first, so that no square overflows or underflows.
        let [x, y, z] = axis.map(|entry| entry / largest);
        let (sine, cosine) = (0.5 * angle_rad).sin_cos();
        let scale = sine / (x * x + y * y + z * z).sqrt();
        Self::new(rotation([cosine, x * scale, y * scale, z * scale]), translation)
    }

    /// Builds a pose that rotates about the fixed axes x, y and z, in this order, by the angles
    /// `[roll, pitch, yaw]` in radians, and then translates. URDF states origins this way.
    ///
    /// ```
    /// use impinge::Pose;
    ///
    /// let turned = Pose::from_roll_pitch_yaw([0.0, 0.0, 1.0], [0.0, 0.0, std::f64::consts::FRAC_PI_2])?;
    /// let [x, y, z] = turned.apply([1.0, 0.0, 0.0]);
    /// assert!(x.abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z == 1.0);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// Every entry of the matrix is within 2e-15 of that of the exact rotation, and has the same
    /// bits on every platform.
    ///
    /// # Errors
    /// As [`new`](Self::new). Also [`OutOfRange`](InputErrorKind::OutOfRange) if the magnitude of
    /// an angle is above 2^20.
    pub fn from_roll_pitch_yaw(translation: [f64; 3], angles_rad: [f64; 3]) -> Result<Self, InputError> {
        for (index, angle) in angles_rad.iter().enumerate() {
            if !angle.is_finite() {
                return Err(InputError::new(InputErrorKind::NonFinite { what: "angle", index }));
            }
            if angle.abs() > MAX_ANGLE {
                return Err(InputError::new(InputErrorKind::OutOfRange { what: "angle", index, limit: "2^20" }));
            }
        }
        let [[sr, cr], [sp, cp], [sy, cy]] = angles_rad.map(sine_and_cosine);
        let linear = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Self::new(linear, translation)
    }

    /// Returns the linear part: the rows of a 3x3 matrix that multiplies column vectors from the
    /// left.
    #[must_use]
    pub fn linear(&self) -> &[[f64; 3]; 3] {
        &self.linear
    }

    /// Returns the translation, in world units: the image of the origin of the local frame.
    #[must_use]
    pub fn translation(&self) -> &[f64; 3] {
        &self.translation
    }

    /// Reports whether the map mirrors: its determinant is negative.
    #[must_use]
    pub fn mirrors(&self) -> bool {
        self.mirrors
    }

    /// Returns the map that applies `inner` first and then `self`:
    /// `world_from_b = world_from_a.compose(a_from_b)`.
    ///
    /// # Accuracy
    /// Every entry is rounded. Its error is at most 4.1 * 2^-53 times the sum of the magnitudes of
    /// its terms, underflow aside.
    ///
    /// # Errors
    /// As [`new`](Self::new), if the product is out of range, or singular after rounding.
    pub fn compose(&self, inner: &Self) -> Result<Self, InputError> {
        let mut linear = [[0.0; 3]; 3];
        for (row, entries) in linear.iter_mut().enumerate() {
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry = (0..3).map(|k| self.linear[row][k] * inner.linear[k][column]).sum();
            }
        }
        Self::new(linear, self.apply(inner.translation))
    }

    /// Returns the inverse map: `a_from_world = world_from_a.inverse()`.
    ///
    /// ```
    /// use impinge::Pose;
    ///
    /// let world_from_tool = Pose::from_axis_angle([0.0, 0.0, 1.0], 0.5, [3.0, 0.0, 1.0])?;
    /// let world_from_part = Pose::from_translation([4.0, 2.0, 1.0])?;
    /// let tool_from_part = world_from_tool.inverse()?.compose(&world_from_part)?;
    /// assert!((tool_from_part.translation()[2]).abs() < 1e-15);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// Every entry is the float nearest to the entry of the exact inverse.
    ///
    /// # Errors
    /// As [`new`](Self::new), if the inverse is out of range, or singular after rounding.
    pub fn inverse(&self) -> Result<Self, InputError> {
        let [a, b, c] = self.linear.map(|row| row.map(Dyadic::from_f64));
        // Cramer's rule. These are the columns of the inverse, times the determinant.
        let columns = [dyadic::cross(&b, &c), dyadic::cross(&c, &a), dyadic::cross(&a, &b)];
        let determinant = dyadic::dot(&a, &columns[0]);
        let back = self.translation.map(|x| Dyadic::from_f64(-x));
        let row = |i: usize| columns.each_ref().map(|column| column[i].clone());
        let linear = [0, 1, 2].map(|i| row(i).each_ref().map(|entry| Dyadic::nearest_quotient(entry, &determinant)));
        let translation = [0, 1, 2].map(|i| Dyadic::nearest_quotient(&dyadic::dot(&row(i), &back), &determinant));
        Self::new(linear, translation)
    }

    /// Maps a point of the local frame to the world frame. The result is rounded.
    ///
    /// # Accuracy
    /// The error of coordinate i is at most 4.1 * 2^-53 times `Σ |linear_ij v_j| +
    /// |translation_i|`, underflow aside. The exact predicates do not use this function.
    #[inline]
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = point;
        std::array::from_fn(|i| {
            let row = self.linear[i];
            row[0] * x + row[1] * y + row[2] * z + self.translation[i]
        })
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Mul for Pose {
    type Output = Result<Self, InputError>;

    /// [`compose`](Pose::compose): applies the right pose first and then the left one.
    ///
    /// ```
    /// use impinge::Pose;
    ///
    /// let world_from_arm = Pose::from_translation([1.0, 0.0, 0.0])?;
    /// let arm_from_hand = Pose::from_translation([0.0, 2.0, 0.0])?;
    /// let world_from_hand = (world_from_arm * arm_from_hand)?;
    /// assert_eq!(world_from_hand.translation(), &[1.0, 2.0, 0.0]);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    fn mul(self, inner: Self) -> Self::Output {
        self.compose(&inner)
    }
}

/// Returns the rotation matrix of a nonzero quaternion of any length.
fn rotation([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    let (ww, xx, yy, zz) = (w * w, x * x, y * y, z * z);
    let squared_length = ww + xx + yy + zz;
    [
        [ww + xx - yy - zz, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), ww - xx + yy - zz, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), ww - xx - yy + zz],
    ]
    .map(|row| row.map(|entry| entry / squared_length))
}

/// Returns the exact sign of the determinant of a matrix whose entries are within 2^64.
fn determinant_sign(m: &[[f64; 3]; 3]) -> Sign {
    let mut determinant = 0.0;
    let mut magnitude = 0.0;
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (positive, negative) = (m[1][i] * m[2][j], m[1][j] * m[2][i]);
        determinant += m[0][k] * (positive - negative);
        magnitude += m[0][k].abs() * (positive.abs() + negative.abs());
    }
    // Each term has five roundings: 5.1 units of 2^-53 of the sum of magnitudes, taken as 8 to
    // cover the rounding of that sum. Each product that underflows loses 2^-1075, times 2^64.
    if determinant.abs() > 4.0 * f64::EPSILON * magnitude + f64::MIN_POSITIVE {
        return if determinant > 0.0 { Sign::Positive } else { Sign::Negative };
    }
    let [u, v, w] = m.map(|row| row.map(Dyadic::from_f64));
    dyadic::dot(&dyadic::cross(&u, &v), &w).sign()
}
