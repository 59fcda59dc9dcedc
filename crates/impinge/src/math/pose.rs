//! An affine map from a mesh's own frame to the world.

use std::ops::Mul;

use super::Sign;
use super::dyadic::{self, Dyadic};
use crate::input::{InputError, InputErrorKind};

/// The largest magnitude of an entry of the linear part, 2^64. With vertices below 2^128 and translations within
/// 2^300 it keeps every posed coordinate, and products of three of them, within the range of a double.
const LINEAR_LIMIT: f64 = (1_u128 << 64) as f64;

/// The largest magnitude of a translation entry, 2^300.
const TRANSLATION_LIMIT: f64 = f64::from_bits((1023 + 300) << 52);

/// How far the length of a quaternion may be from 1. Three decimal digits an entry pass; a quaternion that was never
/// normalised, or an angle in its place, does not.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// The affine map `x = linear · v + translation`, whose entries are the real numbers that the floats are.
///
/// Any invertible map within the stated range is a pose, shears and mirrors included; nothing is made orthonormal
/// after the fact. Two poses are equal where all their entries are, zeros of either sign being the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
    mirrors: bool,
}

impl Pose {
    /// The map that moves nothing.
    pub const IDENTITY: Self =
        Self { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3], mirrors: false };

    /// The map with this linear part, rows first, and this translation.
    ///
    /// # Errors
    /// [`NonFinite`](InputErrorKind::NonFinite) and [`OutOfRange`](InputErrorKind::OutOfRange) where an entry is not
    /// finite or beyond 2^64 (linear part) or 2^300 (translation), naming it by its place in the row-major 4x4
    /// matrix; [`Singular`](InputErrorKind::Singular) where the determinant is zero, decided exactly.
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

    /// The map of a 4x4 matrix, rows first, that column vectors are multiplied to.
    ///
    /// # Errors
    /// As [`new`](Self::new); and [`NotAffine`](InputErrorKind::NotAffine) where the last row is not 0, 0, 0, 1.
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

    /// The map that only translates.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_translation(translation: [f64; 3]) -> Result<Self, InputError> {
        Self::new(Self::IDENTITY.linear, translation)
    }

    /// A rotation by a unit quaternion `[w, x, y, z]`, then a translation.
    ///
    /// # Accuracy
    /// The quaternion is normalised by dividing every entry of the matrix by its squared length, so half and quarter
    /// turns about the axes come out exact; other entries are within 1e-15 of those of an exact rotation.
    ///
    /// # Errors
    /// As [`new`](Self::new); and [`NotUnitQuaternion`](InputErrorKind::NotUnitQuaternion) where the length is off 1
    /// by more than 1e-3.
    pub fn from_quaternion_wxyz(translation: [f64; 3], quaternion: [f64; 4]) -> Result<Self, InputError> {
        if let Some(index) = quaternion.iter().position(|entry| !entry.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "quaternion entry", index }));
        }
        let length = quaternion.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        let deviation = (length - 1.0).abs();
        if deviation > QUATERNION_TOLERANCE {
            return Err(InputError::new(InputErrorKind::NotUnitQuaternion { length }).with_hint("normalise it"));
        }
        Self::new(rotation(quaternion), translation)
    }

    /// A rotation about an axis through the origin by an angle, right-handed, then a translation.
    ///
    /// # Accuracy
    /// Uses the sine and cosine of the platform, so the last bits of the matrix may differ between platforms; whatever
    /// matrix results is then meant exactly. For the same pose everywhere, pass a quaternion or a matrix.
    ///
    /// # Errors
    /// As [`new`](Self::new); and [`ZeroAxis`](InputErrorKind::ZeroAxis) where the axis has no direction.
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
        // Divided by the largest entry first, so that no square overflows or vanishes.
        let [x, y, z] = axis.map(|entry| entry / largest);
        let (sine, cosine) = (0.5 * angle_rad).sin_cos();
        let scale = sine / (x * x + y * y + z * z).sqrt();
        Self::new(rotation([cosine, x * scale, y * scale, z * scale]), translation)
    }

    /// The linear part, rows first: column vectors are multiplied from the left.
    #[must_use]
    pub fn linear(&self) -> &[[f64; 3]; 3] {
        &self.linear
    }

    /// The translation, in world units.
    #[must_use]
    pub fn translation(&self) -> &[f64; 3] {
        &self.translation
    }

    /// Whether the map turns left hands into right hands: its determinant is negative.
    #[must_use]
    pub fn mirrors(&self) -> bool {
        self.mirrors
    }

    /// The map that applies `inner` first and then `self`: `world_from_b = world_from_a.compose(a_from_b)`.
    ///
    /// # Accuracy
    /// Every entry is rounded, with an error within 4.1 units of 2^-53 of the sum of the magnitudes of its terms.
    ///
    /// # Errors
    /// As [`new`](Self::new), where the product is out of range, or singular after rounding.
    pub fn compose(&self, inner: &Self) -> Result<Self, InputError> {
        let mut linear = [[0.0; 3]; 3];
        for (row, entries) in linear.iter_mut().enumerate() {
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry = (0..3).map(|k| self.linear[row][k] * inner.linear[k][column]).sum();
            }
        }
        Self::new(linear, self.apply(inner.translation))
    }

    /// The map back: `a_from_world = world_from_a.inverse()`.
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
    /// Every entry is the float nearest to that of the exact inverse.
    ///
    /// # Errors
    /// As [`new`](Self::new), where the inverse is out of range, or singular after rounding.
    pub fn inverse(&self) -> Result<Self, InputError> {
        let [a, b, c] = self.linear.map(|row| row.map(Dyadic::from_f64));
        // By Cramer's rule. These are the columns of the inverse, times the determinant.
        let columns = [dyadic::cross(&b, &c), dyadic::cross(&c, &a), dyadic::cross(&a, &b)];
        let determinant = dyadic::dot(&a, &columns[0]);
        let back = self.translation.map(|x| Dyadic::from_f64(-x));
        let row = |i: usize| columns.each_ref().map(|column| column[i].clone());
        let linear = [0, 1, 2].map(|i| row(i).each_ref().map(|entry| Dyadic::nearest_quotient(entry, &determinant)));
        let translation = [0, 1, 2].map(|i| Dyadic::nearest_quotient(&dyadic::dot(&row(i), &back), &determinant));
        Self::new(linear, translation)
    }

    /// Where a point of the local frame lies in the world, rounded.
    ///
    /// # Accuracy
    /// Each coordinate is within 4.1 units of 2^-53 of `Σ |linear_ij v_j| + |translation_i|`, underflow aside. The
    /// exact predicates do not use this.
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

/// The rotation matrix of a quaternion of any length but zero.
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

/// The sign of the determinant of a matrix whose entries are within 2^64.
fn determinant_sign(m: &[[f64; 3]; 3]) -> Sign {
    let mut determinant = 0.0;
    let mut magnitude = 0.0;
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (positive, negative) = (m[1][i] * m[2][j], m[1][j] * m[2][i]);
        determinant += m[0][k] * (positive - negative);
        magnitude += m[0][k].abs() * (positive.abs() + negative.abs());
    }
    // Five roundings on the way of each term: 5.1 units of 2^-53 of the sum of magnitudes, taken as 8 for the rounding
    // of that sum itself. Products that underflow lose 2^-1075 each, times 2^64.
    if determinant.abs() > 4.0 * f64::EPSILON * magnitude + f64::MIN_POSITIVE {
        return if determinant > 0.0 { Sign::Positive } else { Sign::Negative };
    }
    let [u, v, w] = m.map(|row| row.map(Dyadic::from_f64));
    dyadic::dot(&dyadic::cross(&u, &v), &w).sign()
}
