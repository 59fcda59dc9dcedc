//! Measures how far a pose is from a rigid motion, and maps points and directions with error
//! bounds.

use super::rounding::{HALF_ULP, add_down, add_up, length_up, mul_down, mul_up};
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;

/// Maximum deviation from a rigid motion (Frobenius norm of RᵀR - I) that still counts as rigid. A
/// rotation stored in single precision deviates by about 1e-7, one from a file with five decimals
/// by 1e-5. An intended scale or shear deviates by more.
const MAX_DEVIATION: f64 = 1e-4;

/// Returns a bound on the factor by which the pose stretches any length. The bound is exactly 1 if
/// the linear part is exactly orthogonal.
///
/// For floats that requires exactly one entry of ±1 in each row and column. Proof: scale a row to
/// integers over a power of two; their squares sum to a power of four. Three squares whose sum is a
/// multiple of four are all even, so the integers can be halved until the sum is 1.
///
/// # Accuracy
/// The largest singular value σ of R satisfies σ² ≤ 1 + ‖RᵀR - I‖, so σ ≤ 1 + ‖RᵀR - I‖ / 2; the
/// Frobenius norm is used. An entry of RᵀR - I is three products, two sums and a difference. Its
/// error is at most 3.1 u of the magnitudes of the products and u of the entry itself. If products
/// underflow, the error also includes less than the smallest normal number.
///
/// # Errors
/// Returns [`NotRigid`](InputErrorKind::NotRigid) if the Frobenius norm of RᵀR - I exceeds 1e-4.
pub(crate) fn stretch(pose: &Pose) -> Result<f64, InputError> {
    let linear = pose.linear();
    let is_exact = linear.as_flattened().iter().all(|x| *x == 0.0 || x.abs() == 1.0);
    let mut squares = 0.0;
    for i in 0..3 {
        for j in i..3 {
            // An entry off the diagonal occurs twice.
            let (one, times) = if i == j { (1.0, 1.0) } else { (0.0, 2.0) };
            let products = linear.map(|row| row[i] * row[j]);
            let entry = (products[0] + products[1] + products[2] - one).abs();
            let size = products[0].abs() + products[1].abs() + products[2].abs();
            let rounding = if is_exact { 0.0 } else { 8.0 * HALF_ULP * size + f64::MIN_POSITIVE };
            let entry = entry + rounding;
            squares += times * entry * entry;
        }
    }
    let deviation = squares.sqrt() * (1.0 + 16.0 * HALF_ULP);
    if deviation > MAX_DEVIATION {
        return Err(InputError::new(InputErrorKind::NotRigid { deviation }).with_hint(
            "only meshes, boxes and k-DOPs can be scaled or sheared: remove scale and shear from the pose",
        ));
    }
    Ok(add_up(1.0, 0.5 * deviation))
}

/// Returns the image of a point, rounded, and a bound on its distance from the exact image.
pub(super) fn image(pose: &Pose, point: [f64; 3]) -> ([f64; 3], f64) {
    let image = pose.apply(point);
    let off = std::array::from_fn(|axis| {
        let (mut low, mut high) = (pose.translation()[axis], pose.translation()[axis]);
        for from in 0..3 {
            low = add_down(low, mul_down(pose.linear()[axis][from], point[from]));
            high = add_up(high, mul_up(pose.linear()[axis][from], point[from]));
        }
        add_up(high, -image[axis]).max(add_up(image[axis], -low))
    });
    (image, length_up(off))
}

/// Returns the image of a direction under the linear part, rounded, and a bound on its distance
/// from the exact image.
pub(super) fn direction(pose: &Pose, direction: [f64; 3]) -> ([f64; 3], f64) {
    let linear = pose.linear();
    let (mut nearest, mut off) = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        let (mut low, mut high) = (0.0, 0.0);
        for from in 0..3 {
            low = add_down(low, mul_down(linear[axis][from], direction[from]));
            high = add_up(high, mul_up(linear[axis][from], direction[from]));
        }
        nearest[axis] = 0.5 * low + 0.5 * high;
        off[axis] = add_up(high, -nearest[axis]).max(add_up(nearest[axis], -low));
    }
    (nearest, length_up(off))
}
