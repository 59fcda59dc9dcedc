//! World coordinates as exact integers.
//!
//! Every coordinate `r0*x + r1*y + r2*z + t` of f64 numbers is an integer times a power of two. The
//! corners of a pair of triangles, multiplied by a common power of two, are therefore integer
//! points. Scaling by a positive number does not change whether the triangles intersect.

use std::cmp::Ordering;

use crate::Affine;
use dashu_int::IBig;

/// Integer point or vector.
pub(super) type Vector = [IBig; 3];

/// Factor or term `mantissa * 2^exponent`. The mantissa is odd or zero.
#[derive(Clone, Copy)]
struct Dyadic {
    mantissa: i128,
    exponent: i32,
}

/// Returns the world images of the corners of a and of b, in a common integer scale, with the first
/// corner of a as origin.
///
/// # Panics
/// Panics if a number is not finite.
pub(super) fn corners(
    a: &[[f64; 3]; 3],
    world_from_a: &Affine,
    b: &[[f64; 3]; 3],
    world_from_b: &Affine,
) -> ([Vector; 3], [Vector; 3]) {
    let terms = [a.map(|v| terms(world_from_a, v)), b.map(|v| terms(world_from_b, v))];
    let lowest = terms.iter().flatten().flatten().flatten().filter(|x| x.mantissa != 0).map(|x| x.exponent).min();
    let scale = lowest.unwrap_or(0);
    let origin = image(&terms[0][0], scale);
    let [a, b] = terms.map(|corners| corners.map(|corner| subtract(&image(&corner, scale), &origin)));
    (a, b)
}

/// Returns the world images of points as integers, and the exponent of the power of two by which to
/// multiply them.
///
/// # Panics
/// Panics if a number is not finite.
pub(super) fn images(points: &[[f64; 3]], world_from_local: &Affine) -> (Vec<Vector>, i32) {
    let terms: Vec<_> = points.iter().map(|&point| terms(world_from_local, point)).collect();
    let lowest = terms.as_flattened().as_flattened().iter().filter(|x| x.mantissa != 0).map(|x| x.exponent).min();
    let scale = lowest.unwrap_or(0);
    (terms.iter().map(|terms| image(terms, scale)).collect(), scale)
}

/// Compares a float with an integer times a power of two.
pub(super) fn compare(x: f64, integer: &IBig, exponent: i32) -> Ordering {
    let x = Dyadic::new(x);
    let scale = if x.mantissa == 0 { exponent } else { exponent.min(x.exponent) };
    let x = if x.mantissa == 0 { IBig::ZERO } else { IBig::from(x.mantissa) << (x.exponent - scale) as usize };
    x.cmp(&(integer << (exponent - scale) as usize))
}

/// Returns `a - b`.
pub(super) fn subtract(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| &a[k] - &b[k])
}

/// Returns `a · b`.
pub(super) fn dot(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Returns `a x b`.
pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

/// Reports whether every component is zero.
pub(super) fn is_zero(a: &Vector) -> bool {
    a.iter().all(|x| x == &IBig::ZERO)
}

/// Returns the four terms of each world coordinate of a point.
fn terms(world_from_local: &Affine, point: [f64; 3]) -> [[Dyadic; 4]; 3] {
    let point = point.map(Dyadic::new);
    std::array::from_fn(|k| {
        let row = world_from_local.linear[k].map(Dyadic::new);
        [
            row[0].times(point[0]),
            row[1].times(point[1]),
            row[2].times(point[2]),
            Dyadic::new(world_from_local.translation[k]),
        ]
    })
}

fn image(terms: &[[Dyadic; 4]; 3], scale: i32) -> Vector {
    std::array::from_fn(|k| {
        terms[k].iter().filter(|x| x.mantissa != 0).fold(IBig::ZERO, |sum, x| {
            let shift = (x.exponent - scale) as usize;
            sum + (IBig::from(x.mantissa) << shift)
        })
    })
}

impl Dyadic {
    fn new(x: f64) -> Self {
        assert!(x.is_finite(), "the oracle needs finite numbers, not {x}");
        let bits = x.to_bits();
        let fraction = (bits & ((1 << 52) - 1)) as i128;
        let biased = (bits >> 52 & 0x7ff) as i32;
        let (magnitude, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        if magnitude == 0 {
            return Self { mantissa: 0, exponent: 0 };
        }
        let zeros = magnitude.trailing_zeros();
        let odd = magnitude >> zeros;
        Self { mantissa: if x < 0.0 { -odd } else { odd }, exponent: exponent + zeros as i32 }
    }

    /// Returns the exact product. Two mantissas of 53 bits make one of 106 bits.
    fn times(self, other: Self) -> Self {
        Self { mantissa: self.mantissa * other.mantissa, exponent: self.exponent + other.exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_exact_if_floats_round() {
        // In floats the first term of 0.1 * 3 + 1e300 would vanish.
        let pose = Affine::new([[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1e300, 0.0, 0.0]);
        let a = [[0.1, 0.0, 0.0], [0.1f64.next_up(), 0.0, 0.0], [0.1, 5e-324, 0.0]];
        let (image, _) = corners(&a, &pose, &a, &pose);
        assert_eq!(image[0], [IBig::ZERO, IBig::ZERO, IBig::ZERO]);
        // One step of 0.1 is 2^-56, and three times that in the world. The common scale is that of
        // the smallest subnormal, 2^-1074.
        assert_eq!(image[1], [IBig::from(3) << (1074 - 56), IBig::ZERO, IBig::ZERO]);
        assert_eq!(image[2], [IBig::ZERO, IBig::ONE, IBig::ZERO]);
    }

    #[test]
    fn the_whole_range_of_exponents_fits() {
        let at = |x: f64| [[x, 5e-324, 0.0]; 3];
        let (a, b) = corners(&at(2f64.powi(1000)), &Affine::IDENTITY, &at(2f64.powi(999)), &Affine::IDENTITY);
        assert_eq!(a[0], [IBig::ZERO, IBig::ZERO, IBig::ZERO]);
        assert_eq!(b[0], [-(IBig::ONE << (1074 + 999)), IBig::ZERO, IBig::ZERO]);
    }
}
