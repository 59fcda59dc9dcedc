//! Exact sums, differences and products of floats: integers times powers of two, of any size.
//!
//! A number is a sign, a magnitude in 64-bit limbs and an exponent that counts whole limbs, so
//! addition aligns limbs and never shifts bits. The algorithms are those of Knuth, *The Art of
//! Computer Programming*, volume 2, section 4.3.1. The numbers of one decision have a few limbs,
//! 120 at most.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use super::Sign;

/// Number of limbs stored without allocating. A determinant of posed single-precision corners takes
/// about 12: it multiplies 3 coordinates, each of 3 or 4 limbs (sums of products of 53 by 24 bits).
const INLINE: usize = 16;

/// A real number `m · 2^e` with integers `m` and `e`. Every finite float is such a number.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    sign: Sign,
    /// The magnitude is the sum of `limbs[i] · 2^(64 (i + exponent))`. The limbs are `low..high` of
    /// the digits. Neither the lowest nor the highest limb is zero.
    exponent: i32,
    low: usize,
    high: usize,
    /// Holds the digits if they fit. Otherwise `heap` holds them; it is empty if they fit.
    inline: [u64; INLINE],
    heap: Vec<u64>,
}

impl Dyadic {
    /// Zero.
    pub(crate) const ZERO: Self =
        Self { sign: Sign::Zero, exponent: 0, low: 0, high: 0, inline: [0; INLINE], heap: Vec::new() };

    /// Converts a finite float exactly.
    pub(crate) fn from_f64(x: f64) -> Self {
        let (negative, mantissa, exponent) = decompose(x);
        Self::from_parts(negative, u128::from(mantissa), exponent)
    }

    /// Returns the exact product of two finite floats.
    pub(crate) fn product(x: f64, y: f64) -> Self {
        let (x_negative, x_mantissa, x_exponent) = decompose(x);
        let (y_negative, y_mantissa, y_exponent) = decompose(y);
        let mantissa = u128::from(x_mantissa) * u128::from(y_mantissa);
        Self::from_parts(x_negative != y_negative, mantissa, x_exponent + y_exponent)
    }

    pub(crate) fn sign(&self) -> Sign {
        self.sign
    }

    /// Returns the float nearest to `numerator / denominator`, ties to even, or an infinity if the
    /// quotient is 2^1022 or more. The denominator must not be zero.
    pub(crate) fn nearest_quotient(numerator: &Self, denominator: &Self) -> f64 {
        if numerator.sign == Sign::Zero {
            return 0.0;
        }
        let negative = numerator.sign != denominator.sign;
        let (n, n_exponent) = numerator.leading();
        let (d, d_exponent) = denominator.leading();
        let mut quotient = scaled(n / d, n_exponent - d_exponent);
        if quotient >= power_of_two(1022) {
            return if negative { f64::NEG_INFINITY } else { f64::INFINITY };
        }
        // The estimate is wrong by at most a few units in the last place. Exact comparisons with
        // the midpoints to its neighbors move it to the nearest float.
        let twice = numerator + numerator;
        let against_midpoint = |x: f64, y: f64| {
            let product = denominator * &(&Self::from_f64(x) + &Self::from_f64(y));
            compare_magnitudes(&twice, &product)
        };
        loop {
            match against_midpoint(quotient, quotient.next_up()) {
                Ordering::Greater => quotient = quotient.next_up(),
                Ordering::Equal => {
                    quotient = even_of(quotient, quotient.next_up());
                    break;
                }
                Ordering::Less if quotient == 0.0 => break,
                Ordering::Less => match against_midpoint(quotient.next_down(), quotient) {
                    Ordering::Less => quotient = quotient.next_down(),
                    Ordering::Equal => {
                        quotient = even_of(quotient.next_down(), quotient);
                        break;
                    }
                    Ordering::Greater => break,
                },
            }
        }
        if negative { -quotient } else { quotient }
    }

    fn from_parts(negative: bool, mantissa: u128, exponent: i32) -> Self {
        if mantissa == 0 {
            return Self::ZERO;
        }
        let shift = exponent.rem_euclid(64);
        let low = mantissa << shift;
        let high = if shift == 0 { 0 } else { (mantissa >> (128 - shift)) as u64 };
        let sign = if negative { Sign::Negative } else { Sign::Positive };
        let mut number = Self::zeros(sign, exponent.div_euclid(64), 3);
        let digits = number.digits_mut();
        (digits[0], digits[1], digits[2]) = (low as u64, (low >> 64) as u64, high);
        number.trim();
        number
    }

    /// Returns a number whose limbs are still zero. It is inlined, because a move would cost more
    /// than most of the arithmetic.
    #[inline]
    fn zeros(sign: Sign, exponent: i32, len: usize) -> Self {
        let heap = if len <= INLINE { Vec::new() } else { vec![0; len] };
        Self { sign, exponent, low: 0, high: len, inline: [0; INLINE], heap }
    }

    #[inline]
    fn digits(&self) -> &[u64] {
        if self.heap.is_empty() { &self.inline } else { &self.heap }
    }

    #[inline]
    fn digits_mut(&mut self) -> &mut [u64] {
        if self.heap.is_empty() { &mut self.inline } else { &mut self.heap }
    }

    /// Drops the zero limbs at both ends.
    #[inline]
    fn trim(&mut self) {
        let (mut low, mut high) = (self.low, self.high);
        let digits = self.digits();
        while low < high && digits[high - 1] == 0 {
            high -= 1;
        }
        while low < high && digits[low] == 0 {
            low += 1;
        }
        self.exponent += (low - self.low) as i32;
        (self.low, self.high) = (low, high);
        if self.low == self.high {
            (self.sign, self.exponent) = (Sign::Zero, 0);
        }
    }

    fn limbs(&self) -> &[u64] {
        &self.digits()[self.low..self.high]
    }

    /// Returns the limb at `position` above the exponent `from`, or zero if there is none.
    fn limb(&self, from: i32, position: usize) -> u64 {
        let index = from + position as i32 - self.exponent;
        // A negative index wraps around to one beyond the end.
        self.limbs().get(index as usize).copied().unwrap_or(0)
    }

    /// Returns one past the position of the highest limb.
    fn top(&self) -> i32 {
        self.exponent + (self.high - self.low) as i32
    }

    /// Returns the magnitude of a nonzero number as `x · 2^e`, within a relative error of 2^-52.
    fn leading(&self) -> (f64, i32) {
        match self.limbs() {
            [.., second, first] => ((u128::from(*first) << 64 | u128::from(*second)) as f64, 64 * (self.top() - 2)),
            [only] => (*only as f64, 64 * self.exponent),
            [] => (0.0, 0),
        }
    }

    /// Returns `self + other`, or `self - other` if `other_sign` is the opposite of `other.sign`.
    fn sum(&self, other: &Self, other_sign: Sign) -> Self {
        if other_sign == Sign::Zero {
            return self.clone();
        }
        if self.sign == Sign::Zero {
            return Self { sign: other_sign, ..other.clone() };
        }
        if self.sign == other_sign {
            self.sum_of_magnitudes(other)
        } else if compare_magnitudes(self, other) == Ordering::Less {
            other.difference_of_magnitudes(self, other_sign)
        } else {
            self.difference_of_magnitudes(other, self.sign)
        }
    }

    fn sum_of_magnitudes(&self, other: &Self) -> Self {
        let exponent = self.exponent.min(other.exponent);
        let len = (self.top().max(other.top()) - exponent) as usize;
        let mut result = Self::zeros(self.sign, exponent, len + 1);
        let mut carry = false;
        let limbs = result.digits_mut();
        for (position, limb) in limbs[..len].iter_mut().enumerate() {
            (*limb, carry) = self.limb(exponent, position).carrying_add(other.limb(exponent, position), carry);
        }
        limbs[len] = u64::from(carry);
        result.trim();
        result
    }

    /// Returns `|self| - |other|` with this sign. `|self|` must not be the smaller one.
    fn difference_of_magnitudes(&self, other: &Self, sign: Sign) -> Self {
        let exponent = self.exponent.min(other.exponent);
        let len = (self.top() - exponent) as usize;
        let mut result = Self::zeros(sign, exponent, len);
        let mut borrow = false;
        for (position, limb) in result.digits_mut()[..len].iter_mut().enumerate() {
            (*limb, borrow) = self.limb(exponent, position).borrowing_sub(other.limb(exponent, position), borrow);
        }
        result.trim();
        result
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        self.sum(other, other.sign)
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        self.sum(other, -other.sign)
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        let (x, y) = (self.limbs(), other.limbs());
        let sign = if self.sign == other.sign { Sign::Positive } else { Sign::Negative };
        let mut result = Dyadic::zeros(sign, self.exponent + other.exponent, x.len() + y.len());
        let digits = result.digits_mut();
        for (i, &a) in x.iter().enumerate() {
            let mut carry = 0;
            for (digit, &b) in digits[i..].iter_mut().zip(y) {
                // (2^64 - 1)^2 + 2 (2^64 - 1) = 2^128 - 1: the sum cannot overflow.
                let wide = u128::from(a) * u128::from(b) + u128::from(*digit) + u128::from(carry);
                *digit = wide as u64;
                carry = (wide >> 64) as u64;
            }
            digits[i + y.len()] = carry;
        }
        // If a factor is zero it has no limbs; `trim` then finds only zeros.
        result.trim();
        result
    }
}

/// Returns the exact cross product of two vectors.
pub(crate) fn cross(u: &[Dyadic; 3], v: &[Dyadic; 3]) -> [Dyadic; 3] {
    let minor = |i: usize, j: usize| &(&u[i] * &v[j]) - &(&u[j] * &v[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// Returns the exact inner product of two vectors.
pub(crate) fn dot(u: &[Dyadic; 3], v: &[Dyadic; 3]) -> Dyadic {
    &(&(&u[0] * &v[0]) + &(&u[1] * &v[1])) + &(&u[2] * &v[2])
}

/// Splits a finite float: whether it is negative, and its magnitude `mantissa · 2^exponent`.
pub(crate) fn decompose(x: f64) -> (bool, u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let biased = (bits >> 52 & 0x7ff) as i32;
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (x.is_sign_negative(), mantissa, exponent)
}

fn compare_magnitudes(x: &Dyadic, y: &Dyadic) -> Ordering {
    // Compare the highest limbs first. If one number runs out of limbs, the other is larger.
    x.top().cmp(&y.top()).then_with(|| x.limbs().iter().rev().cmp(y.limbs().iter().rev()))
}

fn even_of(x: f64, y: f64) -> f64 {
    if x.to_bits() & 1 == 0 { x } else { y }
}

/// Returns `x · 2^exponent` within a few units in the last place, for `x` between 2^-129 and 2^129.
fn scaled(x: f64, exponent: i32) -> f64 {
    let exponent = exponent.clamp(-1400, 1400);
    let half = exponent / 2;
    x * power_of_two(half) * power_of_two(exponent - half)
}

/// Returns `2^exponent`, for an exponent from -1022 to 1022.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use dashu_int::{IBig, UBig};
    use dashu_ratio::RBig;

    use super::*;

    /// Floats of all kinds: zeros, subnormals, powers of two, few bits, many bits, the largest.
    fn float(state: &mut u64) -> f64 {
        let mut next = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *state >> 20
        };
        let kind = next() % 8;
        let exponent = match kind {
            0 => 0,
            1 => next() % 2046,
            _ => 1023 - 40 + next() % 80,
        };
        let fraction = match next() % 3 {
            0 => 0,
            1 => (next() & 7) << 49,
            _ => next() << 8 & ((1 << 52) - 1),
        };
        f64::from_bits((next() & 1) << 63 | exponent << 52 | fraction)
    }

    fn rational(x: &Dyadic) -> RBig {
        let magnitude = x.limbs().iter().rev().fold(UBig::ZERO, |sum, &limb| (sum << 64) + UBig::from(limb));
        let magnitude = IBig::from(magnitude);
        let signed = if x.sign() == Sign::Negative { -magnitude } else { magnitude };
        let shift = UBig::ONE << (64 * x.exponent.unsigned_abs() as usize);
        if x.exponent < 0 { RBig::from_parts(signed, shift) } else { RBig::from(signed * IBig::from(shift)) }
    }

    fn float_rational(x: f64) -> RBig {
        RBig::try_from(x).expect("finite")
    }

    #[test]
    fn arithmetic_is_that_of_rationals() {
        let mut state = 1;
        let (mut heap, mut zero) = (0, 0);
        for _ in 0..20_000 {
            let floats: [f64; 6] = std::array::from_fn(|_| float(&mut state));
            let [a, b, c, d, e, f] = floats.map(float_rational);
            // A sum of two products, and one number times another sum.
            let x = &Dyadic::product(floats[0], floats[1]) + &Dyadic::product(floats[2], floats[3]);
            let y = &Dyadic::from_f64(floats[4]) - &Dyadic::from_f64(floats[5]);
            let (true_x, true_y) = (a * b + c * d, e - f);
            assert_eq!(rational(&x), true_x);
            assert_eq!(rational(&y), true_y);
            let product = &x * &y;
            assert_eq!(rational(&product), true_x.clone() * true_y.clone());
            let difference = &(&product - &x) * &y;
            let true_difference = (true_x.clone() * true_y.clone() - true_x) * true_y;
            assert_eq!(rational(&difference), true_difference);
            assert_eq!(difference.sign(), true_difference.cmp(&RBig::ZERO).into());
            assert_eq!((&product - &product).sign(), Sign::Zero);
            heap += usize::from(!difference.heap.is_empty());
            zero += usize::from(difference.sign() == Sign::Zero);
        }
        assert!(heap > 1000 && zero > 100, "{heap} {zero}");
    }

    #[test]
    fn quotients_are_nearest() {
        let mut state = 2;
        let (mut ties, mut infinite, mut subnormal) = (0, 0, 0);
        for case in 0..20_000 {
            let [mut x, mut y, z] = std::array::from_fn(|_| float(&mut state));
            if case % 4 == 0 {
                // Halfway between two floats.
                (x, y) = (x.clamp(-1e300, 1e300), y.clamp(-1e-3, 1e-3));
                y = if case % 8 == 0 { x * f64::EPSILON * 0.5 } else { y };
            }
            let numerator = &Dyadic::product(x, z) + &Dyadic::product(y, z);
            let denominator = if case % 3 == 0 { Dyadic::from_f64(z) } else { Dyadic::from_f64(y) };
            if denominator.sign() == Sign::Zero {
                continue;
            }
            let quotient = Dyadic::nearest_quotient(&numerator, &denominator);
            let truth = rational(&numerator) / rational(&denominator);
            if quotient.is_infinite() {
                let bound = float_rational(power_of_two(1022)) * if quotient > 0.0 { RBig::ONE } else { -RBig::ONE };
                let quarter = RBig::from_parts(1.into(), 4_u8.into());
                assert!(truth * quarter.clone() / (bound * quarter) > RBig::from_parts(99.into(), 100_u8.into()));
                infinite += 1;
                continue;
            }
            let distance = |q: f64| {
                let difference = float_rational(q) - truth.clone();
                if difference < RBig::ZERO { -difference } else { difference }
            };
            for neighbor in [quotient.next_up(), quotient.next_down()] {
                let (own, other) = (distance(quotient), distance(neighbor));
                assert!(own < other || own == other && quotient.to_bits() & 1 == 0, "{x:e} {y:e} {z:e}");
                ties += usize::from(own == other);
            }
            subnormal += usize::from(quotient.is_subnormal());
        }
        assert!(ties > 100 && infinite > 100 && subnormal > 20, "{ties} {infinite} {subnormal}");
    }
}
