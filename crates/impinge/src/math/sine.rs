//! Sines and cosines that are the same on every platform. The last bits of the platform's functions
//! differ, so this module uses only sums and products, and no fused operations.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

/// Maximum magnitude of an angle, in radians: about 167,000 turns. The multiples of [`HALF_PI`]
/// that the reduction subtracts have at most 20 bits below it, so their products with its parts are
/// exact. With a larger limit they would be rounded.
pub(crate) const MAX_ANGLE: f64 = (1 << 20) as f64;

/// π/2 as a sum of three parts. The first two have 33 significant bits each, so that a product with
/// a whole number of 20 bits is exact. The sum is within 2^-122 of π/2.
const HALF_PI: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5440_0000),
    f64::from_bits(0x3DD0_B461_1A60_0000),
    f64::from_bits(0x3BA3_198A_2E03_7073),
];

/// A sum with this number rounds to a whole number, 1.5 · 2^52.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Coefficients of s^8 to s^1 in `sin r / r - 1` as a series in s = r².
const SINE: [f64; 8] = [
    1.0 / 355_687_428_096_000.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    -1.0 / 5_040.0,
    1.0 / 120.0,
    -1.0 / 6.0,
];

/// Coefficients of s^9 to s^2 in `cos r` as a series in s = r².
const COSINE: [f64; 8] = [
    -1.0 / 6_402_373_705_728_000.0,
    1.0 / 20_922_789_888_000.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 479_001_600.0,
    -1.0 / 3_628_800.0,
    1.0 / 40_320.0,
    -1.0 / 720.0,
    1.0 / 24.0,
];

/// Returns the sine and the cosine of an angle in radians, whose magnitude must be at most
/// [`MAX_ANGLE`]. Those of zero are exactly 0 and 1, and `-x` has the negated sine and the same
/// cosine.
///
/// # Accuracy
/// Both are within 3 · 2^-53 of the true values (lemma L41 of the proofs), and at most 1 in
/// magnitude. The unit test compares them with series in whole numbers.
///
/// # Source
/// Reduction by W. J. Cody and W. Waite, *Software Manual for the Elementary Functions*, 1980,
/// chapter 8, then Taylor's series.
pub(crate) fn sine_and_cosine(angle_rad: f64) -> [f64; 2] {
    debug_assert!(angle_rad.abs() <= MAX_ANGLE);
    let turns = angle_rad * std::f64::consts::FRAC_2_PI + ROUNDING;
    let quarter_turns = turns - ROUNDING;
    let r = ((angle_rad - quarter_turns * HALF_PI[0]) - quarter_turns * HALF_PI[1]) - quarter_turns * HALF_PI[2];
    let s = r * r;
    let series = |coefficients: [f64; 8]| coefficients.into_iter().fold(0.0, |sum, coefficient| sum * s + coefficient);
    let sine = r + r * s * series(SINE);
    let cosine = 1.0 - (0.5 * s - s * s * series(COSINE));
    // The lowest bits of the sum are those of the whole number.
    match turns.to_bits() & 3 {
        0 => [sine, cosine],
        1 => [cosine, -sine],
        2 => [-sine, -cosine],
        _ => [-cosine, sine],
    }
}

/// Returns the sines and the cosines of four angles: the bits of [`sine_and_cosine`] in each lane.
#[inline(always)]
pub(crate) fn sines_and_cosines<S: Simd>(simd: S, angles_rad: f64x4<S>) -> [f64x4<S>; 2] {
    let quarter_turns = (angles_rad * std::f64::consts::FRAC_2_PI + ROUNDING) - ROUNDING;
    let r = ((angles_rad - quarter_turns * HALF_PI[0]) - quarter_turns * HALF_PI[1]) - quarter_turns * HALF_PI[2];
    let s = r * r;
    let [mut of_sine, mut of_cosine] = [f64x4::splat(simd, 0.0); 2];
    for (a, b) in SINE.into_iter().zip(COSINE) {
        (of_sine, of_cosine) = (of_sine * s + a, of_cosine * s + b);
    }
    let sine = r + r * s * of_sine;
    let cosine = 1.0 - (0.5 * s - s * s * of_cosine);
    // The number of quarter turns, from 0 to 3. All steps are exact.
    let quadrant = quarter_turns - 4.0 * (quarter_turns * 0.25).floor();
    let half = (quadrant * 0.5).floor();
    let is_odd = (quadrant - 2.0 * half).simd_gt(0.5);
    let is_past_half = half.simd_gt(0.5);
    // The cosine is negative in the two quadrants in the middle.
    let is_in_middle = (quadrant - 1.5).abs().simd_lt(1.0);
    let (sine, cosine) = (is_odd.select(cosine, sine), is_odd.select(sine, cosine));
    [is_past_half.select(-sine, sine), is_in_middle.select(-cosine, cosine)]
}

#[cfg(test)]
mod tests {
    use dashu_int::IBig;
    use dashu_ratio::RBig;

    use super::*;
    use crate::simd::{dispatch_every, kernel_levels};

    /// Error bound of lemma L41.
    const SINE_ERROR: f64 = 1.5 * f64::EPSILON;

    /// Number of binary digits after the point of the oracle's fixed-point numbers.
    const DIGITS: usize = 220;

    fn fixed(x: f64) -> IBig {
        let exact = RBig::try_from(x).expect("finite");
        (exact.numerator() << DIGITS) / IBig::from(exact.denominator().clone())
    }

    fn times(a: &IBig, b: &IBig) -> IBig {
        (a * b) >> DIGITS
    }

    /// Returns π/2 by Machin's formula, within 2^-200.
    fn half_pi() -> IBig {
        let arctan_of_reciprocal = |n: i64| {
            let (mut power, mut sum) = ((IBig::ONE << DIGITS) / n, IBig::ZERO);
            for k in 0..100_i64 {
                let term = &power / (2 * k + 1);
                sum = if k % 2 == 0 { sum + term } else { sum - term };
                power /= n * n;
            }
            sum
        };
        (arctan_of_reciprocal(5) * 8) - (arctan_of_reciprocal(239) * 2)
    }

    /// Returns the sine and the cosine within 2^-170, by their series after a reduction to one
    /// turn.
    fn oracle(x: f64, half_pi: &IBig) -> [IBig; 2] {
        let turn = half_pi * 4;
        let x = fixed(x);
        let r = &x - (&x / &turn) * &turn;
        let [mut sine, mut cosine] = [IBig::ZERO, IBig::ZERO];
        let mut term = IBig::ONE << DIGITS;
        for k in 0..120_i64 {
            match k % 4 {
                0 => cosine += &term,
                1 => sine += &term,
                2 => cosine -= &term,
                _ => sine -= &term,
            }
            term = times(&term, &r) / (k + 1);
        }
        [sine, cosine]
    }

    #[test]
    fn the_parts_of_half_pi_are_short_and_add_up() {
        let sum = HALF_PI.iter().fold(IBig::ZERO, |sum, &part| sum + fixed(part));
        let off = sum - half_pi();
        assert!(off < (IBig::ONE << (DIGITS - 122)) && off > -(IBig::ONE << (DIGITS - 122)));
        assert!(HALF_PI[..2].iter().all(|part| part.to_bits().trailing_zeros() >= 20));
    }

    #[test]
    fn sines_and_cosines_are_within_their_error() {
        let half_pi = half_pi();
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut angles = vec![0.0, -0.0, f64::MIN_POSITIVE, MAX_ANGLE, -MAX_ANGLE, std::f64::consts::PI];
        for k in 0..400 {
            // Multiples of a quarter and of an eighth of a turn, and their neighbors.
            let multiple = f64::from(k) * std::f64::consts::FRAC_PI_4;
            angles.extend([multiple, multiple.next_up(), multiple.next_down()]);
            angles.extend([1e-9, 1e-3, 1.0, 4.0, 1e3, MAX_ANGLE].map(|reach| (2.0 * next() - 1.0) * reach));
        }
        let bound = fixed(SINE_ERROR);
        let mut worst = IBig::ZERO;
        for x in angles {
            let found = sine_and_cosine(x);
            for (found, truth) in found.into_iter().zip(oracle(x, &half_pi)) {
                let off = fixed(found) - truth;
                let off = if off < IBig::ZERO { -off } else { off };
                assert!(off <= bound, "{x:e}");
                assert!(found.abs() <= 1.0);
                worst = worst.max(off);
            }
            let [sine, cosine] = sine_and_cosine(-x);
            assert_eq!([-sine, cosine], found);
            for (name, level) in kernel_levels() {
                let angles = [x, -x, 0.5 * x, 0.25 * x];
                let lanes = dispatch_every!(level, simd => {
                    sines_and_cosines(simd, f64x4::from_slice(simd, &angles)).map(<[f64; 4]>::from)
                });
                for (lane, angle) in angles.into_iter().enumerate() {
                    let expected = sine_and_cosine(angle).map(f64::to_bits);
                    assert_eq!(lanes.map(|of_lane| of_lane[lane].to_bits()), expected, "{name} {angle:e}");
                }
            }
        }
        assert!(worst * 4 > bound, "the bound is idle");
        assert_eq!(sine_and_cosine(0.0), [0.0, 1.0]);
    }
}
