//! Products of vectors in floats, some with twice the digits.

use crate::math::vec3::Vector;

/// Returns the cross product as if computed with twice the digits and then rounded. The error of
/// each component is within 2^-53 of itself plus 2^-103 of the sum of the magnitudes of its two
/// products.
///
/// # Source
/// Dekker, *A floating-point technique for extending the available precision*, Numerische
/// Mathematik 18, 1971, for the error of a product; Knuth, TAOCP 2, 4.2.2, for that of a sum. It
/// uses no fused multiply-add: the result would be the same, but the speed would depend on the
/// processor.
#[inline]
pub(crate) fn accurate_cross(a: &Vector, b: &Vector) -> Vector {
    let minor = |i: usize, j: usize| difference_of_products(a[i], b[j], a[j], b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// Returns `a b - c d`. The two products and their difference are exact sums of two floats each,
/// underflow aside. The errors are added up in one float, which rounds terms of 2^-53 of the
/// products three times.
#[inline(always)]
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, p_rest) = two_product(a, b);
    let (q, q_rest) = two_product(-c, d);
    let sum = p + q;
    let q_part = sum - p;
    let sum_rest = (p - (sum - q_part)) + (q - q_part);
    sum + (sum_rest + (p_rest + q_rest))
}

/// Returns the sum of products as if computed with twice the digits and then rounded. For at most
/// eight products the error is within 2^-53 of the sum plus 2^-98 of the sum of magnitudes.
///
/// # Source
/// Ogita, Rump, Oishi, *Accurate sum and dot product*, SIAM Journal on Scientific Computing 26,
/// 2005, algorithm 5.3.
pub(crate) fn accurate_sum_of_products(factors: &[(f64, f64)]) -> f64 {
    let (mut sum, mut rest) = (0.0, 0.0);
    for &(a, b) in factors {
        let (product, product_rest) = two_product(a, b);
        let next = sum + product;
        let part = next - sum;
        rest += ((sum - (next - part)) + (product - part)) + product_rest;
        sum = next;
    }
    sum + rest
}

#[inline(always)]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let product = a * b;
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// Splits a float into two halves of 26 bits each.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    const HALF_OF_THE_BITS: f64 = ((1_u64 << 27) + 1) as f64;
    let scaled = HALF_OF_THE_BITS * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;

    use super::*;

    #[test]
    fn cancelling_products_keep_their_digits() {
        let mut state = 7_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut cancelled = 0;
        for case in 0..2000 {
            let a: Vector = [unit(), unit(), unit()];
            let tilt = 2.0_f64.powi(-(case % 60));
            let b: Vector = std::array::from_fn(|k| a[k] * 1.25 + tilt * unit());
            let found = accurate_cross(&a, &b);
            let exact = |x: f64| RBig::try_from(x).expect("finite");
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let (p, q) = (exact(a[i]) * exact(b[j]), exact(a[j]) * exact(b[i]));
                let truth = p.clone() - q;
                let error = (exact(found[k]) - truth.clone()).to_f64().value().abs();
                let size = p.to_f64().value().abs() * 2.0;
                let bound = truth.to_f64().value().abs() * 2.0_f64.powi(-53) + size * 2.0_f64.powi(-103);
                assert!(error <= bound * (1.0 + 1e-9), "{a:?} {b:?}: off by {error:e} of {bound:e}");
                cancelled += usize::from(truth.to_f64().value().abs() < 1e-12 * size);
            }
        }
        assert!(cancelled > 500, "{cancelled}");
    }
}
