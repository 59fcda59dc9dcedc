//! Angles that are the same on every platform. The bits of the platform's arctangent differ, so
//! this module uses only sums, products and quotients.

/// Error bound of [`angle`], in radians.
///
/// The quotient of the two numbers, or of their combination with a table entry, has at most 5
/// rounding errors of a number below 1/8. The polynomial has fewer, of a number below 1/16. The
/// table, two right angles and the three sums each have an error of half a unit in the last place
/// of a number below 4, which is 2^-52. In all this is below 5 · 2^-52. The terms that the series
/// omits are below 2^-63.
pub(crate) const ANGLE_ERROR: f64 = 6.0 * f64::EPSILON;

/// `arctan(j / 8)` for `j` from 0 to 8, rounded to nearest.
const EIGHTHS: [f64; 9] = [
    0.0,
    0.12435499454676144,
    0.24497866312686414,
    0.35877067027057225,
    0.4636476090008061,
    0.5585993153435624,
    0.6435011087932844,
    0.7188299996216245,
    std::f64::consts::FRAC_PI_4,
];

/// Returns the angle between the first axis and the direction `(x, y)`, in radians from 0 to π. `y`
/// must not be negative. Returns zero for the zero vector. Neither number may be NaN or so large
/// that `x + y` overflows.
///
/// # Accuracy
/// Within [`ANGLE_ERROR`] of the angle of the given numbers. The unit test compares it with
/// rationals.
///
/// # Source
/// Range reduction by `arctan t = arctan c + arctan((t - c) / (1 + t c))` with `c` the nearest
/// multiple of 1/8, then the power series.
pub(crate) fn angle(x: f64, y: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    let (small, large) = if y <= x.abs() { (y, x.abs()) } else { (x.abs(), y) };
    if large == 0.0 {
        return 0.0;
    }
    // The quotient is between 0 and 1, so the cast selects the nearest of nine entries.
    let eighth = (8.0 * (small / large) + 0.5) as usize;
    let c = eighth as f64 / 8.0;
    let t = (small - c * large) / (large + c * small);
    let s = t * t;
    let series = [1.0 / 13.0, -1.0 / 11.0, 1.0 / 9.0, -1.0 / 7.0, 1.0 / 5.0, -1.0 / 3.0];
    let tail = series.iter().fold(0.0, |sum, coefficient| sum * s + coefficient);
    let within = EIGHTHS[eighth] + (t + t * s * tail);
    let from_axis = if y <= x.abs() { within } else { FRAC_PI_2 - within };
    if x < 0.0 { PI - from_axis } else { from_axis }
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;

    use super::*;

    /// Returns `arctan(1 / n)` by its power series in rationals, within 2^-100.
    fn arctan_of_reciprocal(n: u32) -> RBig {
        let term = |k: u32| {
            let denominator =
                (0..2 * k + 1).fold(RBig::ONE, |product, _| product * RBig::from(n)) * RBig::from(2 * k + 1);
            let value = RBig::ONE / denominator;
            if k.is_multiple_of(2) { value } else { -value }
        };
        (0..60).map(term).fold(RBig::ZERO, |sum, x| sum + x)
    }

    /// Returns `arctan(t)` for `t` from 0 to 1, within 2^-80. The addition formula reduces `t` by
    /// 1/4 until it is at most 1/4; then the power series is used.
    fn arctan(t: &RBig) -> RBig {
        if *t > RBig::from_parts(1.into(), 4_u8.into()) {
            let quarter = RBig::from_parts(1.into(), 4_u8.into());
            let rest = (t.clone() - quarter.clone()) / (RBig::ONE + t.clone() * quarter);
            return arctan_of_reciprocal(4) + arctan(&rest);
        }
        let square = t.clone() * t.clone();
        let (mut power, mut sum) = (t.clone(), RBig::ZERO);
        for k in 0..22_u32 {
            let term = power.clone() / RBig::from(2 * k + 1);
            sum = if k.is_multiple_of(2) { sum + term } else { sum - term };
            power *= square.clone();
        }
        sum
    }

    #[test]
    fn angles_are_within_their_error() {
        // Machin's formula for π/4.
        let quarter = RBig::from(4) * arctan_of_reciprocal(5) - arctan_of_reciprocal(239);
        let exact = |x: f64| RBig::try_from(x).expect("finite");
        let bound = exact(ANGLE_ERROR);
        let mut state = 1_u64;
        let mut worst = 0.0_f64;
        for case in 0..600 {
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 44) as f64 / 1_048_576.0
            };
            let small = next() * [1.0, 1e-3, 1e-9][case % 3];
            let (large, negative) = (if case % 5 == 0 { small } else { next() + 1.0 }, case % 2 == 1);
            for (x, y) in [(large, small), (small, large)] {
                let x = if negative { -x } else { x };
                let inner = arctan(&(exact(small) / exact(large)));
                let acute = if x.abs() == large && small <= large && y == small {
                    inner
                } else {
                    RBig::from(2) * quarter.clone() - inner
                };
                let truth = if negative { RBig::from(4) * quarter.clone() - acute } else { acute };
                let found = angle(x, y);
                let off = exact(found) - truth;
                let off = if off < RBig::ZERO { -off } else { off };
                worst = worst.max(off.to_f64().value());
                assert!(off <= bound, "{x:e} {y:e}: {found}");
            }
        }
        assert!(worst > 0.02 * ANGLE_ERROR, "the bound is idle: {worst:e}");
        assert_eq!((angle(0.0, 0.0), angle(1.0, 0.0)), (0.0, 0.0));
        assert_eq!(angle(-1.0, 0.0), std::f64::consts::PI);
    }
}
