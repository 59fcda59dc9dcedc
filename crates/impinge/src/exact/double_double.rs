//! Real numbers as the sum of two floats, with a bound on the error. They have twice the digits of
//! a float and cost about 20 times as much.
//!
//! To round an exact number to the nearest float nearly always takes only a few more digits than a
//! float has. These numbers provide them. Integers handle the rare number that lies between two
//! floats to within the bound.
//!
//! # Source
//! Dekker, *A floating-point technique for extending the available precision*, Numerische
//! Mathematik 18, 1971. Ours departs in that every step carries its own bound, so that nothing is
//! assumed about the operands.
//!
//! The proof is docs/notes/proof.md, L8a.

use crate::math::Pose;
use crate::math::relative::{INFLATE, UNDERFLOW, UNIT_ROUNDOFF};

/// Smallest magnitude of a product whose rounding error is known to be a float: 2^-900. The error
/// of a much smaller product could underflow.
pub(super) const MIN_SPLIT_PRODUCT: f64 = f64::from_bits((1023 - 900) << 52);

/// Largest magnitude of factors and products that are split without error: 2^900. The splitting of
/// Dekker overflows for much larger numbers.
const MAX_SPLIT: f64 = f64::from_bits((1023 + 900) << 52);

/// A number within `error` of `high + low`, `high` being the float nearest to that sum. An infinite
/// or NaN error means that nothing is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
    error: f64,
}

impl DoubleDouble {
    pub(crate) fn of(x: f64) -> Self {
        Self { high: x, low: 0.0, error: 0.0 }
    }

    /// Returns the image of a point of the local frame in the world frame, with its error bound.
    pub(super) fn world_point(world_from_local: &Pose, point: &[f64; 3]) -> [Self; 3] {
        std::array::from_fn(|axis| {
            let row = &world_from_local.linear()[axis];
            let translation = Self::of(world_from_local.translation()[axis]);
            (0..3).fold(translation, |sum, k| sum.plus(&Self::product(row[k], point[k])))
        })
    }

    /// Returns the float nearest to the number, or `None` if the bound does not determine it.
    pub(super) fn nearest(&self) -> Option<f64> {
        // Rounding is monotonic: if both ends of the interval round to one float, so do all numbers
        // between them.
        let (least, greatest) = ((self.low - self.error).next_down(), (self.low + self.error).next_up());
        let is_exact = self.low == 0.0 && self.error == 0.0;
        let is_settled = self.high + least == self.high && self.high + greatest == self.high;
        (self.high.is_finite() && (is_exact || is_settled)).then_some(self.high + 0.0)
    }

    /// Returns the nearest float and a bound on its error.
    pub(crate) fn rounded(&self) -> [f64; 2] {
        [self.high, (self.low.abs() + self.error) * INFLATE]
    }

    #[inline]
    pub(super) fn plus(&self, other: &Self) -> Self {
        let (sum, rest) = two_sum(self.high, other.high);
        let lows = self.low + other.low;
        let low = lows + rest;
        let rounding = UNIT_ROUNDOFF * (lows.abs() + low.abs());
        Self::new(sum, low, self.error + other.error + rounding)
    }

    #[inline]
    pub(super) fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }

    #[inline]
    pub(super) fn negated(&self) -> Self {
        Self { high: -self.high, low: -self.low, error: self.error }
    }

    /// Reports whether the number is proved to be above zero.
    #[inline]
    pub(super) fn is_positive(&self) -> bool {
        self.high + (self.low - self.error).next_down() > 0.0
    }

    /// Returns a float that does not exceed the square root of the number, or `None` if the bound
    /// does not determine it. All numbers with the same nearest float give the same result.
    pub(super) fn root_below(&self) -> Option<f64> {
        let below = self.high.next_down();
        let is_settled = below > 0.0 && self.low.abs() + self.error <= self.high - below;
        is_settled.then(|| below.sqrt().next_down())
    }

    /// Returns a float that is not below the square root of the number, or `None` if the bound does
    /// not determine it. All numbers with the same nearest float give the same result.
    pub(super) fn root_above(&self) -> Option<f64> {
        let above = self.high.next_up();
        let is_settled = self.high >= 0.0 && self.low.abs() + self.error <= above - self.high;
        is_settled.then(|| above.sqrt().next_up())
    }

    /// Returns the error bound if the computed value is zero, otherwise `None`.
    pub(super) fn off_zero(&self) -> Option<f64> {
        (self.high == 0.0 && self.low == 0.0).then_some(self.error)
    }

    /// Returns this number with its error bound increased by `by`.
    pub(super) fn widened(&self, by: f64) -> Self {
        Self { error: (self.error + by) * INFLATE, ..*self }
    }

    /// Returns a number that, to within its error, is not below either of the two. Its error is NaN
    /// if the error of either is.
    #[inline]
    pub(super) fn greater(&self, other: &Self) -> Self {
        let is_less = self.high < other.high || (self.high == other.high && self.low < other.low);
        let Self { high, low, .. } = if is_less { *other } else { *self };
        let error = if self.error >= other.error || self.error.is_nan() { self.error } else { other.error };
        Self { high, low, error }
    }

    #[inline]
    pub(super) fn times(&self, other: &Self) -> Self {
        let product = Self::product(self.high, other.high);
        let (forward, backward) = (self.high * other.low, self.low * other.high);
        let across = forward + backward;
        let low = product.low + across;
        let rounding = UNIT_ROUNDOFF * (forward.abs() + backward.abs() + across.abs() + low.abs());
        let left_out = (self.low * other.low).abs() + 4.0 * UNDERFLOW;
        // The factors are arranged so that no two errors alone are multiplied, which could give a
        // subnormal number.
        let input = (self.size() + self.error) * other.error + other.size() * self.error;
        Self::new(product.high, low, product.error + rounding + left_out + input)
    }

    /// Returns the quotient. Its error bound is the remainder of the dividend after two quotients
    /// of floats.
    #[inline]
    pub(super) fn over(&self, divisor: &Self) -> Self {
        let less = |rest: &Self, quotient: f64| rest.minus(&divisor.times(&Self::of(quotient)));
        let first = self.high / divisor.high;
        let rest = less(self, first);
        let second = rest.high / divisor.high;
        let rest = less(&rest, second);
        let least = divisor.high.abs() * (1.0 - 8.0 * UNIT_ROUNDOFF) - divisor.low.abs() - divisor.error * INFLATE;
        let error = if least > 0.0 { (rest.size() + rest.error) / least + UNDERFLOW } else { f64::INFINITY };
        Self::new(first, second, error)
    }

    /// Builds a number from two floats, the first not much smaller than the second, and a bound
    /// that is a sum of few floats.
    #[inline]
    fn new(high: f64, low: f64, error: f64) -> Self {
        let (high, low) = two_sum(high, low);
        Self { high, low, error: error * INFLATE }
    }

    /// Returns the product of two floats. The error is infinite if the product cannot be split.
    #[inline]
    fn product(x: f64, y: f64) -> Self {
        let product = x * y;
        let is_split =
            (MIN_SPLIT_PRODUCT..=MAX_SPLIT).contains(&product.abs()) && x.abs() <= MAX_SPLIT && y.abs() <= MAX_SPLIT;
        if is_split {
            Self { high: product, low: product_error(x, y, product), error: 0.0 }
        } else {
            let error = if x == 0.0 || y == 0.0 { 0.0 } else { f64::INFINITY };
            Self { high: product, low: 0.0, error }
        }
    }

    fn size(&self) -> f64 {
        self.high.abs() + self.low.abs()
    }
}

pub(crate) fn difference(p: &[DoubleDouble; 3], q: &[DoubleDouble; 3]) -> [DoubleDouble; 3] {
    std::array::from_fn(|k| p[k].minus(&q[k]))
}

pub(crate) fn cross(u: &[DoubleDouble; 3], v: &[DoubleDouble; 3]) -> [DoubleDouble; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[i].times(&v[j]).minus(&u[j].times(&v[i]))
    })
}

pub(crate) fn dot(u: &[DoubleDouble; 3], v: &[DoubleDouble; 3]) -> DoubleDouble {
    u[0].times(&v[0]).plus(&u[1].times(&v[1])).plus(&u[2].times(&v[2]))
}

/// Returns the sum of two floats and its rounding error, which is a float (Knuth).
#[inline]
pub(super) fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    let y_part = sum - x;
    (sum, (x - (sum - y_part)) + (y - y_part))
}

/// Returns the exact product of two floats minus `product`, their rounded product (Dekker's
/// splitting).
#[inline]
pub(super) fn product_error(x: f64, y: f64, product: f64) -> f64 {
    const SPLITTER: f64 = ((1_u64 << 27) + 1) as f64;
    let split = |x: f64| {
        let wide = SPLITTER * x;
        let high = wide - (wide - x);
        (high, x - high)
    };
    let ((x_high, x_low), (y_high, y_low)) = (split(x), split(y));
    ((x_high * y_high - product) + x_high * y_low + x_low * y_high) + x_low * y_low
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;

    use super::*;

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).expect("finite")
    }

    /// Sums, products and quotients stay within their bounds, which are about 2^-100 of the sizes.
    #[test]
    fn bounds_hold() {
        let mut state = 9_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let sign = if state & 1 << 20 == 0 { 1.0 } else { -1.0 };
            let exponent = (state >> 57) % 64;
            sign * f64::from_bits((1023 - 32 + exponent) << 52 | (state >> 12 & ((1 << 52) - 1)))
        };
        let (mut narrow, mut settled) = (0, 0);
        for case in 0..4000 {
            let floats: [f64; 4] = std::array::from_fn(|_| next());
            let [a, b, c, d] = floats.map(DoubleDouble::of);
            let [x, y, z, w] = floats.map(exact);
            let (product, other) = (a.times(&b), c.times(&d));
            let (value, truth) = match case % 3 {
                0 => (product.plus(&other).times(&a), (&x * &y + &z * &w) * &x),
                1 => (product.minus(&other).over(&d.plus(&a)), (&x * &y - &z * &w) / (&w + &x)),
                // Cancels to the rounding error of the product.
                _ => (product.minus(&DoubleDouble::of(floats[0] * floats[1])), &x * &y - exact(floats[0] * floats[1])),
            };
            let off = exact(value.high) + exact(value.low) - truth.clone();
            let off = if off < RBig::ZERO { -off } else { off };
            assert!(value.error.is_finite() && off <= exact(value.error), "{floats:?} {value:?}");
            narrow += usize::from(value.error < value.size() * 2_f64.powi(-80));
            if let Some(nearest) = value.nearest() {
                let beside = |other: f64| {
                    let (near, far) = (exact(nearest) - truth.clone(), exact(other) - truth.clone());
                    near.clone() * near <= far.clone() * far
                };
                assert!(beside(nearest.next_up()) && beside(nearest.next_down()), "{floats:?} {value:?}");
                settled += 1;
            }
        }
        // All cases except cancellation, which leaves no digits to spare.
        assert!(narrow > 2500 && settled > 2500, "{narrow} {settled}");
        // Nothing is determined after underflow, overflow or division by zero.
        for [x, y] in [[1e-200, 1e-200], [1e300, 1e300], [1e-320, 3.0]] {
            assert_eq!(DoubleDouble::of(x).times(&DoubleDouble::of(y)).nearest(), None);
        }
        assert_eq!(DoubleDouble::of(1.0).over(&DoubleDouble::of(0.0)).nearest(), None);
        // A tie between two floats is undecided.
        let half = DoubleDouble::of(1.0).plus(&DoubleDouble::of(UNIT_ROUNDOFF));
        assert_eq!(DoubleDouble { error: 1e-40, ..half }.nearest(), None);
    }
}
