//! Exact sums, differences and products of floats: integers times powers of two, of any size.
//!
//! A number is a sign, a magnitude in 64-bit limbs and an exponent that counts whole limbs, so that addition aligns
//! by limbs and never shifts bits. The arithmetic is the schoolbook one (Knuth, *The Art of Computer Programming*,
//! volume 2, section 4.3.1): the numbers of one decision have a few limbs, and 120 at the very worst.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use super::Sign;

/// Limbs that a number holds without allocating. A determinant of posed single-precision corners takes 12 or so: a
/// coordinate is a sum of products of 53 by 24 bits and takes 3 or 4, and three of them are multiplied.
const INLINE: usize = 16;

#[derive(Clone, Debug)]
enum Limbs {
    Inline { len: usize, limbs: [u64; INLINE] },
    Heap(Vec<u64>),
}

/// A real number of the form `m · 2^e` with integers `m` and `e`; every finite float is one.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    sign: Sign,
    /// The magnitude is the sum of `limbs[i] · 2^(64 (i + exponent))`; neither end of `limbs` is zero.
    exponent: i32,
    limbs: Limbs,
}

impl Limbs {
    fn zeros(len: usize) -> Self {
        if len <= INLINE { Self::Inline { len, limbs: [0; INLINE] } } else { Self::Heap(vec![0; len]) }
    }

    fn as_slice(&self) -> &[u64] {
        match self {
            Self::Inline { len, limbs } => &limbs[..*len],
            Self::Heap(limbs) => limbs,
        }
    }

    fn as_mut_slice(&mut self) -> &mut [u64] {
        match self {
            Self::Inline { len, limbs } => &mut limbs[..*len],
            Self::Heap(limbs) => limbs,
        }
    }

    fn truncate(&mut self, new_len: usize) {
        match self {
            Self::Inline { len, .. } => *len = new_len,
            Self::Heap(limbs) => limbs.truncate(new_len),
        }
    }
}

impl Dyadic {
    /// Zero.
    pub(crate) const ZERO: Self =
        Self { sign: Sign::Zero, exponent: 0, limbs: Limbs::Inline { len: 0, limbs: [0; INLINE] } };

    /// The number that this finite float is.
    pub(crate) fn from_f64(x: f64) -> Self {
        let (negative, mantissa, exponent) = decompose(x);
        Self::from_parts(negative, u128::from(mantissa), exponent)
    }

    /// The product of two finite floats, without rounding.
    pub(crate) fn product(x: f64, y: f64) -> Self {
        let (x_negative, x_mantissa, x_exponent) = decompose(x);
        let (y_negative, y_mantissa, y_exponent) = decompose(y);
        let mantissa = u128::from(x_mantissa) * u128::from(y_mantissa);
        Self::from_parts(x_negative != y_negative, mantissa, x_exponent + y_exponent)
    }

    pub(crate) fn sign(&self) -> Sign {
        self.sign
    }

    /// The float nearest to `numerator / denominator`, ties to even; infinite where that is not below 2^1022.
    /// The denominator is not zero.
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
        // The estimate is a few units in the last place off at most; exact comparisons with the midpoints to its
        // neighbours walk it to the nearest.
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
        let mut limbs = [0; INLINE];
        limbs[..3].copy_from_slice(&[low as u64, (low >> 64) as u64, high]);
        let sign = if negative { Sign::Negative } else { Sign::Positive };
        Self::trimmed(sign, exponent.div_euclid(64), Limbs::Inline { len: 3, limbs })
    }

    /// The number of this sign with these limbs, without the zeros at both their ends.
    fn trimmed(sign: Sign, exponent: i32, mut limbs: Limbs) -> Self {
        let digits = limbs.as_mut_slice();
        let Some(low) = digits.iter().position(|&digit| digit != 0) else {
            return Self::ZERO;
        };
        let mut top = digits.len();
        while digits[top - 1] == 0 {
            top -= 1;
        }
        if low > 0 {
            digits.copy_within(low..top, 0);
        }
        limbs.truncate(top - low);
        Self { sign, exponent: exponent + low as i32, limbs }
    }

    /// One past the position of the highest limb.
    fn top(&self) -> i32 {
        self.exponent + self.limbs.as_slice().len() as i32
    }

    /// The magnitude of a number other than zero as `x · 2^e`, within 2^-52 of it.
    fn leading(&self) -> (f64, i32) {
        match self.limbs.as_slice() {
            [.., second, first] => ((u128::from(*first) << 64 | u128::from(*second)) as f64, 64 * (self.top() - 2)),
            [only] => (*only as f64, 64 * self.exponent),
            [] => (0.0, 0),
        }
    }

    /// `self + other`, or `self - other` where `other_sign` is the opposite of that of `other`.
    fn sum(&self, other: &Self, other_sign: Sign) -> Self {
        if other_sign == Sign::Zero {
            return self.clone();
        }
        if self.sign == Sign::Zero {
            return Self { sign: other_sign, ..other.clone() };
        }
        let exponent = self.exponent.min(other.exponent);
        let len = (self.top().max(other.top()) - exponent) as usize;
        let offset = |x: &Self| (x.exponent - exponent) as usize;
        if self.sign == other_sign {
            let mut limbs = Limbs::zeros(len + 1);
            copy(limbs.as_mut_slice(), self.limbs.as_slice(), offset(self));
            add(limbs.as_mut_slice(), other.limbs.as_slice(), offset(other));
            return Self::trimmed(self.sign, exponent, limbs);
        }
        let (large, small, sign) = match compare_magnitudes(self, other) {
            Ordering::Equal => return Self::ZERO,
            Ordering::Greater => (self, other, self.sign),
            Ordering::Less => (other, self, other_sign),
        };
        let mut limbs = Limbs::zeros(len);
        copy(limbs.as_mut_slice(), large.limbs.as_slice(), offset(large));
        subtract(limbs.as_mut_slice(), small.limbs.as_slice(), offset(small));
        Self::trimmed(sign, exponent, limbs)
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
        if self.sign == Sign::Zero || other.sign == Sign::Zero {
            return Dyadic::ZERO;
        }
        let (x, y) = (self.limbs.as_slice(), other.limbs.as_slice());
        let mut limbs = Limbs::zeros(x.len() + y.len());
        let digits = limbs.as_mut_slice();
        for (i, &a) in x.iter().enumerate() {
            let row = &mut digits[i..=i + y.len()];
            let mut carry = 0;
            for (digit, &b) in row.iter_mut().zip(y) {
                // (2^64 - 1)^2 + 2 (2^64 - 1) = 2^128 - 1: the sum cannot overflow.
                let wide = u128::from(a) * u128::from(b) + u128::from(*digit) + u128::from(carry);
                *digit = wide as u64;
                carry = (wide >> 64) as u64;
            }
            row[y.len()] = carry;
        }
        let sign = if self.sign == other.sign { Sign::Positive } else { Sign::Negative };
        Dyadic::trimmed(sign, self.exponent + other.exponent, limbs)
    }
}

/// The cross product of two vectors.
pub(crate) fn cross(u: &[Dyadic; 3], v: &[Dyadic; 3]) -> [Dyadic; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &(&u[i] * &v[j]) - &(&u[j] * &v[i])
    })
}

/// The inner product of two vectors.
pub(crate) fn dot(u: &[Dyadic; 3], v: &[Dyadic; 3]) -> Dyadic {
    &(&(&u[0] * &v[0]) + &(&u[1] * &v[1])) + &(&u[2] * &v[2])
}

/// Whether a finite float is negative, and integers such that its magnitude is `mantissa · 2^exponent`.
pub(crate) fn decompose(x: f64) -> (bool, u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let biased = (bits >> 52 & 0x7ff) as i32;
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (x.is_sign_negative(), mantissa, exponent)
}

fn compare_magnitudes(x: &Dyadic, y: &Dyadic) -> Ordering {
    let (x_limbs, y_limbs) = (x.limbs.as_slice(), y.limbs.as_slice());
    // Highest limbs first; where one runs out, the other has more that is not zero.
    x.top().cmp(&y.top()).then_with(|| x_limbs.iter().rev().cmp(y_limbs.iter().rev()))
}

fn copy(digits: &mut [u64], from: &[u64], offset: usize) {
    digits[offset..offset + from.len()].copy_from_slice(from);
}

fn add(digits: &mut [u64], other: &[u64], offset: usize) {
    let mut carry = false;
    let (aligned, above) = digits[offset..].split_at_mut(other.len());
    for (digit, &b) in aligned.iter_mut().zip(other) {
        (*digit, carry) = digit.carrying_add(b, carry);
    }
    for digit in above {
        if !carry {
            return;
        }
        (*digit, carry) = digit.overflowing_add(1);
    }
}

fn subtract(digits: &mut [u64], other: &[u64], offset: usize) {
    let mut borrow = false;
    let (aligned, above) = digits[offset..].split_at_mut(other.len());
    for (digit, &b) in aligned.iter_mut().zip(other) {
        (*digit, borrow) = digit.borrowing_sub(b, borrow);
    }
    for digit in above {
        if !borrow {
            return;
        }
        (*digit, borrow) = digit.overflowing_sub(1);
    }
}

fn even_of(x: f64, y: f64) -> f64 {
    if x.to_bits() & 1 == 0 { x } else { y }
}

/// `x · 2^exponent` within a few units in the last place, for `x` within 2^±129.
fn scaled(x: f64, exponent: i32) -> f64 {
    let exponent = exponent.clamp(-1400, 1400);
    let half = exponent / 2;
    x * power_of_two(half) * power_of_two(exponent - half)
}

/// `2^exponent`, for an exponent within ±1022.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}
