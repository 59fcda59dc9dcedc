//! Signs of determinants in floats, if a bound of all errors allows.
//!
//! The determinant is `u × v · w` of three differences of points, each point with an error. A
//! computed difference `u` stands for the true one, `U = u (1 + ρ) + η`. Here `|ρ| <= 2^-53`, and
//! `|η|` is at most the sum of the errors of both points, component by component. So each of the
//! six products of `U`, `V`, `W` differs from the product of `u`, `v`, `w` by two parts:
//!
//! - rounding: three differences, and five operations on the way of a product to the result, each a
//!   factor within `1 ± 2^-53`; together slightly more than 8 units of the product of magnitudes;
//! - input: `(|u| + η_u)(|v| + η_v)(|w| + η_w) - |u| |v| |w|`, expanded into positive terms because
//!   the difference would cancel (Shewchuk, *Adaptive Precision Floating-Point Arithmetic*, 1997,
//!   treats exact input; Burnikel, Funke and Seel, *Exact Geometric Computation Using Cascading*,
//!   2001, propagate input errors in this way).
//!
//! Differences of floats do not underflow. Each product may lose 2^-1075, and a dozen of them are
//! multiplied by `w`. Any overflow makes the error infinite or NaN, and then no sign is certain.
//!
//! Two more steps follow if a sign is still uncertain. If every term has a factor that is exactly
//! zero, so is the determinant: all faces of an axis-aligned plane are coplanar in this way. If
//! underflow is what makes it uncertain, each axis is scaled by a power of two, which keeps the
//! sign, and the filter runs once more.
//!
//! The proof is docs/notes/proof.md, L5, and the tests are below.

use crate::math::Sign;
use crate::math::relative::{INFLATE, UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::dot;

/// Bound on the relative rounding error: 9 units of 2^-53. Slightly more than 8 are needed; the
/// rest covers the rounding of the bound itself.
pub(super) const ROUNDING: f64 = 9.0 * UNIT_ROUNDOFF;

/// Error bounds of three difference vectors, by components.
pub(super) struct Errors<'e> {
    pub(super) u: &'e [f64; 3],
    pub(super) v: &'e [f64; 3],
    pub(super) w: &'e [f64; 3],
}

/// Returns the sign of `u × v · w` for each `w`, or `None` if it is not certain.
pub(super) fn signs<const N: usize>(
    u: &[f64; 3],
    v: &[f64; 3],
    ws: &[[f64; 3]; N],
    errors: &Errors,
) -> [Option<Sign>; N] {
    let (signs, is_lost_to_underflow) = unscaled_signs(u, v, ws, errors);
    if signs.iter().all(Option::is_some) {
        return signs;
    }
    let signs = with_zeros(signs, u, v, ws, errors);
    if is_lost_to_underflow && signs.iter().any(Option::is_none) {
        scaled_signs(signs, u, v, ws, errors)
    } else {
        signs
    }
}

/// Returns the signs that floats of this scale prove, and whether the bound on underflow is the
/// largest part of the error.
#[inline(always)]
fn unscaled_signs<const N: usize>(
    u: &[f64; 3],
    v: &[f64; 3],
    ws: &[[f64; 3]; N],
    errors: &Errors,
) -> ([Option<Sign>; N], bool) {
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
    let (relative, underflow) = (input * INFLATE + rounding * ROUNDING, extent_sum * UNDERFLOW);
    let error = relative + underflow;
    let signs = ws.map(|w| {
        let determinant = dot(&normal, &w);
        // Both comparisons are false if either side is NaN. No sign is returned for a determinant
        // that overflows either: each of its steps is at most the same step of `rounding`, which
        // then overflows too.
        if determinant > error {
            Some(Sign::Positive)
        } else if determinant < -error {
            Some(Sign::Negative)
        } else {
            None
        }
    });
    (signs, relative < underflow)
}

/// Adds to the known signs those that are certain once the largest component along each axis is
/// about 1.
///
/// # Accuracy
/// A product with a power of two is exact, or it underflows and loses 2^-1075 at most. Components
/// are below 2 then, so all that is lost in 18 factors is far below the bound on underflow. Errors
/// are scaled with their vectors. If a number overflows or is NaN, no sign is certain.
#[cold]
fn scaled_signs<const N: usize>(
    known: [Option<Sign>; N],
    u: &[f64; 3],
    v: &[f64; 3],
    ws: &[[f64; 3]; N],
    errors: &Errors,
) -> [Option<Sign>; N] {
    let scales: [f64; 3] = std::array::from_fn(|k| {
        reciprocal_power_of_two(ws.iter().fold(u[k].abs().max(v[k].abs()), |largest, w| largest.max(w[k].abs())))
    });
    let scaled = |vector: &[f64; 3]| std::array::from_fn(|k| vector[k] * scales[k]);
    let errors = Errors { u: &scaled(errors.u), v: &scaled(errors.v), w: &scaled(errors.w) };
    let (signs, _) = unscaled_signs(&scaled(u), &scaled(v), &ws.each_ref().map(scaled), &errors);
    std::array::from_fn(|n| known[n].or(signs[n]))
}

/// Returns a power of two whose product with `x` is below 2, and at least 1/2 unless that would
/// take more than 2^1000. Returns 1 for zero and for numbers that are not finite.
fn reciprocal_power_of_two(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return 1.0;
    }
    let exponent = (x.to_bits() >> 52) as i32 - 1023;
    f64::from_bits(((1023 - exponent.clamp(-1000, 1000)) as u64) << 52)
}

/// Replaces `None` by zero if the vectors are exact and each term has a factor that is zero.
#[cold]
fn with_zeros<const N: usize>(
    signs: [Option<Sign>; N],
    u: &[f64; 3],
    v: &[f64; 3],
    ws: &[[f64; 3]; N],
    errors: &Errors,
) -> [Option<Sign>; N] {
    if [errors.u, errors.v, errors.w].iter().any(|error| **error != [0.0; 3]) {
        return signs;
    }
    let no_area: [bool; 3] = std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        (u[i] == 0.0 || v[j] == 0.0) && (u[j] == 0.0 || v[i] == 0.0)
    });
    let is_zero = |w: &[f64; 3]| (0..3).all(|k| no_area[k] || w[k] == 0.0);
    std::array::from_fn(|n| signs[n].or_else(|| is_zero(&ws[n]).then_some(Sign::Zero)))
}

/// Returns the sign of `det(q - p, r - p)` in the projection along an axis, or `None` if it is not
/// certain. The points are exact. The other two axes follow `axis` in cyclic order.
///
/// # Accuracy
/// Two differences, the product and the last difference are rounded. They add up to slightly more
/// than 4 units of the magnitudes. Zero is certain if both products have a factor that is zero.
#[inline]
pub(super) fn sign2d(axis: usize, p: &[f64; 3], q: &[f64; 3], r: &[f64; 3]) -> Option<Sign> {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = ([q[i] - p[i], q[j] - p[j]], [r[i] - p[i], r[j] - p[j]]);
    unscaled_sign2d(u, v).or_else(|| {
        let scales = [0, 1].map(|k| reciprocal_power_of_two(u[k].abs().max(v[k].abs())));
        let scaled = |vector: [f64; 2]| [0, 1].map(|k| vector[k] * scales[k]);
        let is_zero = (u[0] == 0.0 || v[1] == 0.0) && (u[1] == 0.0 || v[0] == 0.0);
        if is_zero { Some(Sign::Zero) } else { unscaled_sign2d(scaled(u), scaled(v)) }
    })
}

#[inline]
fn unscaled_sign2d(u: [f64; 2], v: [f64; 2]) -> Option<Sign> {
    let (forward, backward) = (u[0] * v[1], u[1] * v[0]);
    let determinant = forward - backward;
    let error = 5.0 * UNIT_ROUNDOFF * (forward.abs() + backward.abs()) + UNDERFLOW;
    if determinant > error {
        Some(Sign::Positive)
    } else if determinant < -error {
        Some(Sign::Negative)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    //! These tests fail if a constant or a term of the bound is weakened: `ROUNDING` to 1 unit, the
    //! input part to one half, `UNDERFLOW` or any first-order term of the errors to zero. Removing
    //! the terms of higher order gave no wrong sign in these tests. They remain because the proof
    //! needs them.

    use super::*;
    use crate::math::dyadic::{self, Dyadic};
    use crate::math::vec3::{cross, sub};

    struct Random(u64);

    impl Random {
        /// Returns a number uniform in [-1, 1).
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> [f64; 3] {
            std::array::from_fn(|_| self.unit())
        }
    }

    fn exact_sign(points: &[[f64; 3]; 4]) -> Sign {
        let [p, q, r, s] = points.each_ref().map(|point| point.map(Dyadic::from_f64));
        let from_p = |x: &[Dyadic; 3]| [&x[0] - &p[0], &x[1] - &p[1], &x[2] - &p[2]];
        dyadic::dot(&dyadic::cross(&from_p(&q), &from_p(&r)), &from_p(&s)).sign()
    }

    fn filtered(points: &[[f64; 3]; 4], errors: &Errors) -> Option<Sign> {
        let [p, q, r, s] = points;
        signs(&sub(q, p), &sub(r, p), &[sub(s, p)], errors)[0]
    }

    fn combination(p: &[f64; 3], q: &[f64; 3], r: &[f64; 3], s: f64, t: f64) -> [f64; 3] {
        std::array::from_fn(|k| p[k] + s * (q[k] - p[k]) + t * (r[k] - p[k]))
    }

    const NONE: [f64; 3] = [0.0; 3];

    #[test]
    fn rounding_is_bounded() {
        let mut random = Random(1);
        let (mut certain, mut nonzero) = (0, 0);
        for case in 0..200_000 {
            let [p, mut q, r] = std::array::from_fn(|_| random.vector());
            if case % 2 == 0 {
                // Far from the origin, so that differences round and cancel.
                q = q.map(|x| 1e3 * x);
            }
            // Coplanar except for the rounding of the coordinates.
            let mut s = combination(&p, &q, &r, random.unit(), random.unit());
            s[0] += random.unit() * [0.0, 2e-15, 2e-14][case % 3];
            let points = [p, q, r, s];
            let truth = exact_sign(&points);
            if let Some(sign) = filtered(&points, &Errors { u: &NONE, v: &NONE, w: &NONE }) {
                assert_eq!(sign, truth, "{points:?}");
                certain += 1;
            }
            nonzero += usize::from(truth != Sign::Zero);
        }
        assert!(nonzero > 150_000 && certain > 10_000, "{nonzero} {certain}");
    }

    /// Each point is moved by exactly its error, each coordinate in the direction that changes the
    /// determinant most.
    #[test]
    fn input_errors_are_bounded() {
        let mut random = Random(2);
        let mut certain = 0;
        let mut flipped = 0;
        for case in 0..200_000 {
            let size = [1e-3, 0.3, 3.0][case / 3 % 3];
            let error: [f64; 3] = std::array::from_fn(|_| size * random.unit().abs());
            // Points that are moved.
            let off = [[false, false, false, true], [false, true, true, true], [true; 4]][case % 3];
            let [p, q, r] = std::array::from_fn(|_| random.vector());
            let mut s = combination(&p, &q, &r, random.unit(), random.unit());
            s[2] += 3.0 * size * random.unit();
            let points = [p, q, r, s];
            let (u, v, w) = (sub(&q, &p), sub(&r, &p), sub(&s, &p));
            let (to_q, to_r, to_s) = (cross(&v, &w), cross(&w, &u), cross(&u, &v));
            let to_p: [f64; 3] = std::array::from_fn(|k| -to_q[k] - to_r[k] - to_s[k]);
            let towards = if random.unit() < 0.0 { -1.0 } else { 1.0 };
            let gradients = [to_p, to_q, to_r, to_s];
            let moved: [[f64; 3]; 4] = std::array::from_fn(|i| {
                std::array::from_fn(|k| {
                    let step = if off[i] { error[k] * towards * gradients[i][k].signum() } else { 0.0 };
                    points[i][k] + step
                })
            });
            // Error of a moved point. The 1e-15 covers the rounding of the sum above.
            let error_of =
                |i: usize| -> [f64; 3] { std::array::from_fn(|k| if off[i] { error[k] + 1e-15 } else { 0.0 }) };
            let of_difference = |i: usize| -> [f64; 3] { std::array::from_fn(|k| error_of(i)[k] + error_of(0)[k]) };
            let errors = Errors { u: &of_difference(1), v: &of_difference(2), w: &of_difference(3) };
            let truth = exact_sign(&points);
            if let Some(sign) = filtered(&moved, &errors) {
                assert_eq!(sign, truth, "{points:?} {moved:?}");
                certain += 1;
            }
            flipped += usize::from(exact_sign(&moved) != truth);
        }
        assert!(flipped > 20_000 && certain > 2000, "{flipped} {certain}");
    }

    #[test]
    fn underflow_is_bounded() {
        let mut random = Random(3);
        let (mut certain, mut nonzero) = (0, 0);
        for case in 0..100_000 {
            let scale = f64::from_bits((1023 - 318 - case % 25) << 52);
            let [p, q, r] = std::array::from_fn(|_| random.vector());
            let mut s = combination(&p, &q, &r, random.unit(), random.unit());
            s[1] += random.unit() * [1.0, 1e-3, 1e-6][case as usize % 3];
            let points = [p, q, r, s].map(|point| point.map(|x| x * scale));
            let truth = exact_sign(&points);
            if let Some(sign) = filtered(&points, &Errors { u: &NONE, v: &NONE, w: &NONE }) {
                assert_eq!(sign, truth, "{points:?}");
                certain += 1;
            }
            nonzero += usize::from(truth != Sign::Zero);
        }
        assert!(nonzero > 90_000 && certain > 10_000, "{nonzero} {certain}");
    }

    #[test]
    fn what_is_not_finite_is_not_certain() {
        let huge = 1e200;
        let points = [[0.0; 3], [huge, 0.0, 0.0], [0.0, huge, 0.0], [0.0, 0.0, huge]];
        assert_eq!(filtered(&points, &Errors { u: &NONE, v: &NONE, w: &NONE }), None);
        let unit = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let exact = Errors { u: &NONE, v: &NONE, w: &NONE };
        assert_eq!(filtered(&unit, &exact), Some(Sign::Positive));
        for unknown in [f64::NAN, f64::INFINITY] {
            for k in 0..3 {
                let mut error = NONE;
                error[k] = unknown;
                assert_eq!(filtered(&unit, &Errors { u: &error, ..exact }), None);
                assert_eq!(filtered(&unit, &Errors { v: &error, ..exact }), None);
                assert_eq!(filtered(&unit, &Errors { w: &error, ..exact }), None);
                let mut point = unit;
                point[3][k] = unknown;
                assert_eq!(filtered(&point, &exact), None);
            }
        }
    }

    /// Points with a power of two for each axis, or for each coordinate, many of them in a plane of
    /// two axes: zeros are exact, and most signs survive the scaling.
    #[test]
    fn extreme_exponents_are_decided() {
        let mut random = Random(4);
        let power = |random: &mut Random| f64::from_bits(((1023.0 + 300.0 * (random.unit() - 0.4)) as u64) << 52);
        let exact = Errors { u: &NONE, v: &NONE, w: &NONE };
        let mut certain = [[0; 3]; 3];
        for case in 0..60_000 {
            let kind = case % 3;
            let axes: [f64; 3] = std::array::from_fn(|_| power(&mut random) * 2.0_f64.powi(-320));
            let points: [[f64; 3]; 4] = std::array::from_fn(|_| {
                let mut point: [f64; 3] = random.vector();
                match kind {
                    0 => point = std::array::from_fn(|k| point[k] * axes[k]),
                    1 => point = point.map(|x| x * power(&mut random)),
                    _ => point[case / 3 % 3] = 0.25,
                }
                point
            });
            let truth = exact_sign(&points);
            if let Some(sign) = filtered(&points, &exact) {
                assert_eq!(sign, truth, "{points:?}");
                certain[kind][sign as usize] += 1;
            }
            for axis in 0..3 {
                let [p, q, r, _] = &points;
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let from_p = |x: &[f64; 3], k: usize| &Dyadic::from_f64(x[k]) - &Dyadic::from_f64(p[k]);
                let truth = (&(&from_p(q, i) * &from_p(r, j)) - &(&from_p(q, j) * &from_p(r, i))).sign();
                assert!(sign2d(axis, p, q, r).is_none_or(|sign| sign == truth), "{points:?}");
            }
        }
        assert!(certain[0][0] > 8000 && certain[0][2] > 8000, "{certain:?}");
        assert!(certain[1][0] > 8000 && certain[1][2] > 8000 && certain[2][1] == 20_000, "{certain:?}");
    }
}
