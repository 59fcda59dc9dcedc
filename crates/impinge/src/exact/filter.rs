//! Signs of determinants in floats, where a bound of all errors allows.
//!
//! The determinant is `u × v · w` of three differences of points. A computed difference `u` of points that are each off
//! by some error stands for the true one, `U = u (1 + ρ) + η` with `|ρ| <= 2^-53` and `|η|` at most the sum of the
//! errors of both points, component by component. So each of the six products of `U`, `V`, `W` differs from that of
//! `u`, `v`, `w` by two parts:
//!
//! - rounding: three differences, and five operations on the way of a product to the result, each a factor within
//!   `1 ± 2^-53`; together 8 units and a little, of the product of magnitudes;
//! - input: `(|u| + η_u)(|v| + η_v)(|w| + η_w) - |u| |v| |w|`, which is expanded into positive terms since the difference
//!   would cancel (Shewchuk, *Adaptive Precision Floating-Point Arithmetic*, 1997, treats exact input; Burnikel, Funke
//!   and Seel, *Exact Geometric Computation Using Cascading*, 2001, propagate input errors in this manner).
//!
//! Differences of floats do not underflow. Each product may lose 2^-1075, and a dozen of them are multiplied by `w`.
//! Whatever overflows ends as NaN or infinity, and neither is taken for certain.

use crate::math::Sign;
use crate::math::relative::{INFLATE, UNDERFLOW, UNIT_ROUNDOFF};

/// Units of relative rounding: 8 are needed, the rest is for the rounding of the bound itself.
const ROUNDING: f64 = 9.0 * UNIT_ROUNDOFF;

/// Bounds of the errors of three difference vectors, by components.
pub(super) struct Errors<'e> {
    pub(super) u: &'e [f64; 3],
    pub(super) v: &'e [f64; 3],
    pub(super) w: &'e [f64; 3],
}

pub(super) fn difference(p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

/// The signs of `u × v · w` for each `w`.
pub(super) fn signs<const N: usize>(
    u: &[f64; 3],
    v: &[f64; 3],
    ws: &[[f64; 3]; N],
    errors: &Errors,
) -> [Option<Sign>; N] {
    let mut normal = [0.0; 3];
    let mut size = [0.0; 3];
    let mut input = 0.0;
    let mut rounding = 0.0;
    let mut extent_sum = 1.0;
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (forward, backward) = (u[i] * v[j], u[j] * v[i]);
        normal[k] = forward - backward;
        size[k] = forward.abs() + backward.abs();
        let size_error = errors.u[i] * (v[j].abs() + errors.v[j])
            + errors.u[j] * (v[i].abs() + errors.v[i])
            + u[i].abs() * errors.v[j]
            + u[j].abs() * errors.v[i];
        let extent = ws.iter().fold(0.0_f64, |extent, w| extent.max(w[k].abs()));
        input += size_error * (extent + errors.w[k]) + size[k] * errors.w[k];
        rounding += size[k] * extent;
        extent_sum += extent + errors.w[k];
    }
    let error = input * INFLATE + rounding * ROUNDING + extent_sum * UNDERFLOW;
    ws.map(|w| {
        let determinant = normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
        // Written so that NaN on either side is not certain.
        if determinant.is_finite() && determinant > error {
            Some(Sign::Positive)
        } else if determinant.is_finite() && determinant < -error {
            Some(Sign::Negative)
        } else {
            None
        }
    })
}
