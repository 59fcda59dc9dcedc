//! Polynomials with rational coefficients, and their number of roots between two numbers.

use dashu_ratio::RBig;

/// Coefficients from the constant on. The last one is not zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polynomial(Vec<RBig>);

/// Sturm sequence: a squarefree polynomial, its derivative, and the negated remainders of each by
/// the next (Sturm 1829).
pub(super) struct Sturm(Vec<Polynomial>);

impl Polynomial {
    fn new(mut coefficients: Vec<RBig>) -> Self {
        while coefficients.last().is_some_and(|last| *last == RBig::ZERO) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// Returns the linear polynomial with one value at 0 and another at 1.
    pub(super) fn linear(start: RBig, end: RBig) -> Self {
        let slope = &end - &start;
        Self::new(vec![start, slope])
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Reports whether the polynomial is zero or of degree zero.
    pub(super) fn is_constant(&self) -> bool {
        self.0.len() <= 1
    }

    pub(super) fn at(&self, t: &RBig) -> RBig {
        self.0.iter().rev().fold(RBig::ZERO, |sum, coefficient| sum * t + coefficient)
    }

    fn coefficient(&self, power: usize) -> RBig {
        self.0.get(power).cloned().unwrap_or(RBig::ZERO)
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let len = self.0.len().max(other.0.len());
        Self::new((0..len).map(|power| self.coefficient(power) + other.coefficient(power)).collect())
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        let len = self.0.len().max(other.0.len());
        Self::new((0..len).map(|power| self.coefficient(power) - other.coefficient(power)).collect())
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut product = vec![RBig::ZERO; self.0.len() + other.0.len()];
        for (i, x) in self.0.iter().enumerate() {
            for (j, y) in other.0.iter().enumerate() {
                product[i + j] += x * y;
            }
        }
        Self::new(product)
    }

    /// Returns the multiple whose highest coefficient is one. The polynomial must not be zero.
    pub(super) fn monic(&self) -> Self {
        let highest = &self.0[self.0.len() - 1];
        Self(self.0.iter().map(|coefficient| coefficient / highest).collect())
    }

    /// Returns the quotient and the remainder. The divisor must not be zero.
    fn divided(&self, divisor: &Self) -> (Self, Self) {
        let mut remainder = self.0.clone();
        let degree = divisor.0.len() - 1;
        let mut quotient = vec![RBig::ZERO; remainder.len().saturating_sub(degree)];
        for power in (0..quotient.len()).rev() {
            let factor = &remainder[power + degree] / &divisor.0[degree];
            for (i, coefficient) in divisor.0.iter().enumerate() {
                remainder[power + i] -= &factor * coefficient;
            }
            quotient[power] = factor;
        }
        (Self::new(quotient), Self::new(remainder))
    }

    fn derivative(&self) -> Self {
        Self::new(self.0.iter().enumerate().skip(1).map(|(power, x)| x * RBig::from(power)).collect())
    }

    /// Returns the monic polynomial of highest degree that divides both (Euclid). Neither may be
    /// zero.
    pub(super) fn common_divisor(&self, other: &Self) -> Self {
        let (mut x, mut y) = (self.monic(), other.monic());
        while !y.is_zero() {
            let remainder = x.divided(&y).1;
            x = y;
            y = if remainder.is_zero() { remainder } else { remainder.monic() };
        }
        x
    }

    /// Returns the polynomial with the same roots, each of them simple. The polynomial must not be
    /// zero.
    pub(super) fn squarefree(&self) -> Self {
        if self.is_constant() {
            return self.monic();
        }
        self.divided(&self.common_divisor(&self.derivative())).0.monic()
    }

    /// Returns the sequence that counts roots. The polynomial must be squarefree.
    pub(super) fn sturm(&self) -> Sturm {
        let mut sequence = vec![self.clone(), self.derivative()];
        while let [.., x, y] = sequence.as_slice()
            && !y.is_constant()
        {
            let remainder = x.divided(y).1;
            sequence.push(Self(remainder.0.into_iter().map(|x| -x).collect()));
        }
        Sturm(sequence)
    }
}

impl Sturm {
    /// Returns the number of roots above `low` and up to `high`.
    pub(super) fn roots_between(&self, low: &RBig, high: &RBig) -> usize {
        self.variations(low) - self.variations(high)
    }

    fn variations(&self, t: &RBig) -> usize {
        let signs: Vec<bool> =
            self.0.iter().map(|p| p.at(t)).filter(|x| *x != RBig::ZERO).map(|x| x > RBig::ZERO).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_roots(roots: &[i64]) -> Polynomial {
        let factor = |&root: &i64| Polynomial::linear(RBig::from(-root), RBig::from(1 - root));
        roots.iter().map(factor).fold(Polynomial::new(vec![RBig::ONE]), |product, x| product.times(&x))
    }

    #[test]
    fn roots_are_counted_once_and_above_the_lower_end() {
        let polynomial = with_roots(&[-3, 1, 1, 2, 5, 5, 5]);
        let squarefree = polynomial.squarefree();
        assert_eq!(squarefree, with_roots(&[-3, 1, 2, 5]));
        let sturm = squarefree.sturm();
        let count = |low: i64, high: i64| sturm.roots_between(&RBig::from(low), &RBig::from(high));
        assert_eq!(
            [count(-9, 9), count(-3, 5), count(0, 1), count(1, 2), count(2, 4), count(-9, -4)],
            [4, 3, 1, 1, 0, 0]
        );
        // x² + 1 has no root, and x² - 2 has one between 1 and 2.
        let square = with_roots(&[0, 0]);
        let constant = |x: i64| Polynomial::new(vec![RBig::from(x)]);
        assert_eq!(square.plus(&constant(1)).sturm().roots_between(&RBig::from(-9), &RBig::from(9)), 0);
        assert_eq!(square.minus(&constant(2)).sturm().roots_between(&RBig::from(1), &RBig::from(2)), 1);
        assert_eq!(polynomial.common_divisor(&with_roots(&[1, 5, 7])), with_roots(&[1, 5]));
    }
}
