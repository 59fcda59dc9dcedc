//! Signs of determinants of integers of three machine words.
//!
//! A posed coordinate is a translation plus three products of a pose entry (53 bits) and a corner
//! coordinate (24 or 53 bits). Its terms span 100 to 180 bits in all, unless their sizes differ
//! extremely. So along each axis the corners of a pair are integers of 192 bits on a grid of their
//! own, and a determinant has 576 bits.
//! Everything has a fixed size and is on the stack. The proof is docs/notes/proof.md, L6.

use super::exact_points::{Corners, ExactPoints};
use super::placement::Placement;
use crate::math::dyadic::decompose;
use crate::math::{Pose, Sign};

/// Maximum number of bits that the terms of the coordinates may span along an axis. A coordinate is
/// a sum of up to four terms, so it is below 2^188. Differences are then below 2^189, two-by-two
/// minors below 2^379 and determinants below 2^570. All fit the words of their type with room for a
/// sign; a larger span could overflow.
const SPAN: i32 = 186;

/// An integer in two's complement, lowest word first.
#[derive(Clone, Copy)]
struct Words<const N: usize>([u64; N]);

/// The corners of A, then of B. Each axis has its own scale.
pub(super) struct WidePoints([[Words<3>; 3]; 6]);

/// The number `± mantissa · 2^exponent`. The mantissa is odd or zero.
#[derive(Clone, Copy)]
struct Term {
    negative: bool,
    mantissa: u128,
    exponent: i32,
}

impl WidePoints {
    /// Builds the points. Returns `None` if the terms of the coordinates span too many bits.
    pub(super) fn new(placement: &Placement, a: &Corners, b: &Corners) -> Option<Self> {
        // Equal poses do not affect the answer.
        let (world_from_a, world_from_b) = if placement.is_shared() {
            (&Pose::IDENTITY, &Pose::IDENTITY)
        } else {
            (placement.world_from_a(), placement.world_from_b())
        };
        let (terms_a, terms_b) = (a.map(|corner| corner.map(Term::new)), b.map(|corner| corner.map(Term::new)));
        let mut points = [[Words([0; 3]); 3]; 6];
        for axis in 0..3 {
            let [a0, a1, a2] = coordinate_terms(world_from_a, axis, &terms_a);
            let [b0, b1, b2] = coordinate_terms(world_from_b, axis, &terms_b);
            let coordinates = [a0, a1, a2, b0, b1, b2];
            let terms = || coordinates.iter().flatten().filter(|term| term.mantissa != 0);
            let lowest = terms().map(|term| term.exponent).min().unwrap_or(0);
            let highest = terms().map(Term::top).max().unwrap_or(0);
            if highest - lowest > SPAN {
                return None;
            }
            for (point, sum) in points.iter_mut().zip(&coordinates) {
                for term in sum {
                    let shifted = Words::shifted(term.mantissa, (term.exponent - lowest) as u32);
                    point[axis] = if term.negative { point[axis].minus(&shifted) } else { point[axis].plus(&shifted) };
                }
            }
        }
        Some(Self(points))
    }

    fn difference(&self, p: usize, q: usize) -> [Words<3>; 3] {
        std::array::from_fn(|k| self.0[p][k].minus(&self.0[q][k]))
    }
}

impl ExactPoints for WidePoints {
    fn orient3d(&self, [p, q, r, s]: [usize; 4]) -> Sign {
        let (u, v, w) = (self.difference(q, p), self.difference(r, p), self.difference(s, p));
        let mut determinant = Words([0; 9]);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let minor: Words<6> = u[i].times::<3, 6>(&v[j]).minus(&u[j].times(&v[i]));
            determinant = determinant.plus(&minor.times(&w[k]));
        }
        determinant.sign()
    }

    fn orient2d(&self, axis: usize, [p, q, r]: [usize; 3]) -> Sign {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = (self.difference(q, p), self.difference(r, p));
        u[i].times::<3, 6>(&v[j]).minus(&u[j].times(&v[i])).sign()
    }

    fn compare(&self, axis: usize, [p, q]: [usize; 2]) -> Sign {
        self.0[p][axis].minus(&self.0[q][axis]).sign()
    }
}

impl Term {
    fn new(x: f64) -> Self {
        let (negative, mantissa, exponent) = decompose(x);
        if mantissa == 0 {
            return Self { negative: false, mantissa: 0, exponent: 0 };
        }
        let zeros = mantissa.trailing_zeros();
        Self { negative, mantissa: u128::from(mantissa >> zeros), exponent: exponent + zeros as i32 }
    }

    /// Returns the product of the terms of two floats.
    fn times(&self, other: &Self) -> Self {
        let mantissa = self.mantissa * other.mantissa;
        if mantissa == 0 {
            return Self { negative: false, mantissa: 0, exponent: 0 };
        }
        Self { negative: self.negative != other.negative, mantissa, exponent: self.exponent + other.exponent }
    }

    /// Returns an exponent `e` such that the magnitude is below `2^e`.
    fn top(&self) -> i32 {
        self.exponent + 128 - self.mantissa.leading_zeros() as i32
    }
}

/// Returns the terms of one coordinate of the image of each corner.
fn coordinate_terms(pose: &Pose, axis: usize, corners: &[[Term; 3]; 3]) -> [[Term; 4]; 3] {
    let [x, y, z] = pose.linear()[axis].map(Term::new);
    let translation = Term::new(pose.translation()[axis]);
    corners.map(|corner| [x.times(&corner[0]), y.times(&corner[1]), z.times(&corner[2]), translation])
}

impl Words<3> {
    /// Returns `mantissa · 2^shift`, which must fit. If the mantissa is zero, any shift is valid.
    fn shifted(mantissa: u128, shift: u32) -> Self {
        if mantissa == 0 {
            return Self([0; 3]);
        }
        let (words, bits) = ((shift / 64) as usize, shift % 64);
        let low = mantissa << bits;
        let high = if bits == 0 { 0 } else { mantissa >> (128 - bits) };
        let digits = [low as u64, (low >> 64) as u64, high as u64];
        Self(std::array::from_fn(|i| if i < words { 0 } else { digits[i - words] }))
    }
}

impl<const N: usize> Words<N> {
    fn plus(&self, other: &Self) -> Self {
        let mut carry = false;
        Self(std::array::from_fn(|i| {
            let word;
            (word, carry) = self.0[i].carrying_add(other.0[i], carry);
            word
        }))
    }

    fn minus(&self, other: &Self) -> Self {
        let mut borrow = false;
        Self(std::array::from_fn(|i| {
            let word;
            (word, borrow) = self.0[i].borrowing_sub(other.0[i], borrow);
            word
        }))
    }

    /// Returns the product, in `R = N + M` words.
    fn times<const M: usize, const R: usize>(&self, other: &Words<M>) -> Words<R> {
        let mut product = [0; R];
        for i in 0..N {
            let mut carry = 0;
            for j in 0..M {
                let wide =
                    u128::from(self.0[i]) * u128::from(other.0[j]) + u128::from(product[i + j]) + u128::from(carry);
                product[i + j] = wide as u64;
                carry = (wide >> 64) as u64;
            }
            product[i + M] = carry;
        }
        // Reading a negative factor as unsigned adds 2^(64 N) to it. Subtract the other factor,
        // shifted up by N words.
        if self.is_negative() {
            subtract_above(&mut product[N..], &other.0);
        }
        if other.is_negative() {
            subtract_above(&mut product[M..], &self.0);
        }
        Words(product)
    }

    fn is_negative(&self) -> bool {
        self.0[N - 1] >> 63 == 1
    }

    fn sign(&self) -> Sign {
        if self.is_negative() {
            Sign::Negative
        } else if self.0 == [0; N] {
            Sign::Zero
        } else {
            Sign::Positive
        }
    }
}

fn subtract_above(words: &mut [u64], other: &[u64]) {
    let mut borrow = false;
    for (word, &x) in words.iter_mut().zip(other) {
        (*word, borrow) = word.borrowing_sub(x, borrow);
    }
}
