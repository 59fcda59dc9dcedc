//! Translation, rotation and scale of bones, and interpolation of rotations.

use super::error::{RigError, RigErrorKind, RigPlace, check_numbers};
use crate::math::vec3::{Vector, dot};

/// A 3 by 3 matrix by rows.
pub(super) type Matrix = [[f64; 3]; 3];

/// The transform of a bone relative to its parent: scaled, then rotated, then translated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Translation in the frame and unit of the parent.
    pub translation: [f64; 3],
    /// Quaternion (w, x, y, z). It need not have length 1; it is normalized.
    pub rotation_wxyz: [f64; 4],
    /// Scale along the bone's own axes. Negative values mirror; zero is invalid.
    pub scale: [f64; 3],
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Self =
        Self { translation: [0.0; 3], rotation_wxyz: [1.0, 0.0, 0.0, 0.0], scale: [1.0, 1.0, 1.0] };

    /// Validates the transform and returns it with a quaternion of length 1.
    ///
    /// # Errors
    /// Returns an error if a number is not finite or out of range, or if a scale or the quaternion
    /// is zero.
    pub(super) fn validated(self, place: RigPlace) -> Result<Self, RigError> {
        check_numbers(&self.translation, "translation", place)?;
        check_numbers(&self.rotation_wxyz, "rotation", place)?;
        check_numbers(&self.scale, "scale", place)?;
        if self.scale.contains(&0.0) {
            return Err(RigError::new(RigErrorKind::ZeroScale, place));
        }
        let rotation_wxyz =
            normalized(self.rotation_wxyz).ok_or_else(|| RigError::new(RigErrorKind::ZeroRotation, place))?;
        Ok(Self { rotation_wxyz, ..self })
    }
}

/// Returns the quaternion scaled to length 1, or `None` if it has no direction or is not finite.
pub(super) fn normalized(q: [f64; 4]) -> Option<[f64; 4]> {
    let largest = q.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if !(largest > 1e-150 && largest.is_finite()) {
        return None;
    }
    let scaled = q.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    // A maximum ignores NaN, so NaN is caught here.
    length.is_finite().then(|| scaled.map(|x| x / length))
}

/// Returns the product of two quaternions: the rotation `b` first, then `a`.
#[inline(always)]
pub(super) fn product([aw, ax, ay, az]: [f64; 4], [bw, bx, by, bz]: [f64; 4]) -> [f64; 4] {
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}

/// Returns the matrix of a quaternion of length 1, up to rounding.
#[inline(always)]
pub(super) fn matrix([w, x, y, z]: [f64; 4]) -> Matrix {
    let [x2, y2, z2] = [x + x, y + y, z + z];
    let (xx, yy, zz, xy, xz, yz) = (x * x2, y * y2, z * z2, x * y2, x * z2, y * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    [[1.0 - (yy + zz), xy - wz, xz + wy], [xy + wz, 1.0 - (xx + zz), yz - wx], [xz - wy, yz + wx, 1.0 - (xx + yy)]]
}

/// Returns the matrix times a vector.
#[inline(always)]
pub(super) fn apply(m: &Matrix, v: Vector) -> Vector {
    m.each_ref().map(|row| dot(row, &v))
}

/// Returns the transposed matrix times a vector.
#[inline(always)]
pub(super) fn apply_transposed(m: &Matrix, v: Vector) -> Vector {
    [
        m[0][0] * v[0] + m[1][0] * v[1] + m[2][0] * v[2],
        m[0][1] * v[0] + m[1][1] * v[1] + m[2][1] * v[2],
        m[0][2] * v[0] + m[1][2] * v[1] + m[2][2] * v[2],
    ]
}

/// Returns the product of two matrices.
pub(super) fn times(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

/// Returns the rotation at share `t` of the way from `a` to `b` along the shorter arc, at constant
/// speed. The result has length 1.
///
/// # Accuracy
/// About 2^-50. The weights are series whose terms shrink at least by half; at most 64 terms are
/// used.
///
/// # Source
/// Eberly, *A Fast and Accurate Algorithm for Computing SLERP*, 2011: sin tθ / sin θ as a series in
/// cos θ - 1. The i-th term is the previous one times (t² - i²) / (i (2i + 1)) (cos θ - 1). No
/// function of the platform's library is used, so all machines agree. The author fits the last
/// term; here the series is summed until it no longer changes.
pub(super) fn slerp(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    let cosine: f64 = (0..4).map(|k| a[k] * b[k]).sum();
    let (b, cosine) = if cosine < 0.0 { (b.map(|x| -x), -cosine) } else { (b, cosine) };
    let y = cosine.min(1.0) - 1.0;
    let [of_a, of_b] = sine_ratios([1.0 - t, t], y);
    nearly_unit([0, 1, 2, 3].map(|k| of_a * a[k] + of_b * b[k]))
}

/// Normalizes a quaternion whose length is 1 up to rounding. One Newton step for the reciprocal
/// square root leaves the square of the error.
#[inline(always)]
pub(super) fn nearly_unit(q: [f64; 4]) -> [f64; 4] {
    let by = 1.5 - 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    q.map(|x| x * by)
}

/// For each term of [`sine_ratios`]: the factor of t² and the constant that is subtracted, 1 / (i
/// (2i + 1)) and i / (2i + 1).
pub(super) const FACTORS: [[f64; 2]; 63] = {
    let (mut factors, mut at) = ([[0.0; 2]; 63], 0);
    while at < 63 {
        let i = at as f64 + 1.0;
        factors[at] = [1.0 / (i * (2.0 * i + 1.0)), i / (2.0 * i + 1.0)];
        at += 1;
    }
    factors
};

/// Returns sin tθ / sin θ for two values of t from 0 to 1, with y = cos θ - 1 from -1 to 0.
fn sine_ratios(t: [f64; 2], y: f64) -> [f64; 2] {
    let (mut terms, mut sums, squares) = (t, t, t.map(|t| t * t));
    for [of_square, constant] in FACTORS {
        let before = sums;
        for k in 0..2 {
            terms[k] *= (of_square * squares[k] - constant) * y;
            sums[k] += terms[k];
        }
        if sums == before {
            break;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slerp_turns_at_even_speed() {
        for degrees in [0.0_f64, 1e-6, 1.0, 30.0, 89.0, 90.0] {
            let half = degrees.to_radians();
            let end = [half.cos(), 0.0, half.sin(), 0.0];
            for t in [0.0, 0.125, 0.5, 0.9, 1.0] {
                let q = slerp([1.0, 0.0, 0.0, 0.0], end, t);
                let (sine, cosine) = (half * t).sin_cos();
                assert!((q[0] - cosine).abs() < 1e-14 && (q[2] - sine).abs() < 1e-14, "{degrees} {t} {q:?}");
                // The same rotation with the opposite sign gives the same result.
                assert_eq!(slerp([1.0, 0.0, 0.0, 0.0], end.map(|x| -x), t)[0].abs(), q[0].abs());
            }
        }
    }

    #[test]
    fn matrices_and_quaternions_agree() {
        let a = normalized([0.3, -0.2, 0.8, 0.1]).unwrap();
        let b = normalized([-0.5, 0.6, 0.1, 0.7]).unwrap();
        let (whole, parts) = (matrix(product(a, b)), times(&matrix(a), &matrix(b)));
        for i in 0..3 {
            for j in 0..3 {
                assert!((whole[i][j] - parts[i][j]).abs() < 1e-15);
            }
        }
        let v = [1.0, 2.0, 3.0];
        let back = apply_transposed(&whole, apply(&whole, v));
        assert!((0..3).all(|k| (back[k] - v[k]).abs() < 1e-14));
        assert!(normalized([0.0; 4]).is_none() && normalized([f64::NAN, 0.0, 0.0, 1.0]).is_none());
    }
}
