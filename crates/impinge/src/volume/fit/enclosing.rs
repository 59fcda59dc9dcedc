//! The least radius about a given centre, rounded up; and the power of two that makes a set of points about one large, so
//! that no square overflows or vanishes.

use super::super::rounding::{HALF_ULP, two_product, two_sum};
use super::super::{BoundingSphere, MinMax};
use crate::math::Sign;
use crate::math::dyadic::Dyadic;
use crate::math::vec3::dot;
use crate::volume::points::{Coordinate, widen};

/// The power of two by which the greatest extent of a box becomes at least 1 and less than 2, and 1 for a point.
///
/// Multiplying a difference of coordinates by it is exact.
pub(super) fn unit_scale(bounds: &MinMax) -> f64 {
    let extent = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
    if extent == 0.0 {
        return 1.0;
    }
    // Subnormal extents have a leading bit below the least normal exponent, which the clamp gives up on: they become
    // as large as a scale can make them.
    let exponent = (extent.to_bits() >> 52) as i64 - 1023;
    f64::from_bits(((1023 - exponent).clamp(1, 2046) as u64) << 52)
}

/// The offset of a point from a centre, in the scale.
#[inline(always)]
pub(super) fn scaled_offset(point: [f64; 3], centre: [f64; 3], scale: f64) -> [f64; 3] {
    std::array::from_fn(|axis| (point[axis] - centre[axis]) * scale)
}

/// The squared length of an offset.
///
/// # Accuracy
/// For an offset of points that are doubles: two roundings of each difference in its square, one of the square, two of the
/// sums: within 5.1 half units, taken as [`SQUARE_ERROR`].
#[inline(always)]
pub(super) fn squared(offset: [f64; 3]) -> f64 {
    dot(&offset, &offset)
}

/// A bound on the relative error of a squared distance, its comparison included.
pub(super) const SQUARE_ERROR: f64 = 8.0 * HALF_ULP;

/// The sphere about a centre with the least radius that holds all the points: the least double.
pub(super) fn about<T: Coordinate>(centre: [f64; 3], points: &[[T; 3]], scale: f64) -> BoundingSphere {
    let square_of = |point: [T; 3]| squared(scaled_offset(widen(point), centre, scale));
    let furthest = points.iter().map(|&point| square_of(point)).fold(0.0, |far, d| if d > far { d } else { far });
    // Among those that doubles cannot tell from the most distant, pairs of doubles leave a few, and exact numbers decide.
    let near = furthest * (1.0 - 2.0 * SQUARE_ERROR);
    let mut rim = Rim { greatest: [0.0; 2], points: Vec::new() };
    points.iter().filter(|&&point| square_of(point) >= near).for_each(|&point| rim.take(widen(point), centre, scale));
    rim.points.sort_by(|p, q| p.partial_cmp(q).unwrap_or(std::cmp::Ordering::Equal));
    rim.points.dedup();
    let root = furthest.sqrt() / scale;
    let below = (0..5).fold(root, |radius, _| radius.next_down()).max(0.0);
    let radius = rim.points.iter().fold(below, |radius, &point| cover(centre, point, radius));
    BoundingSphere::from_valid(centre, radius)
}

/// The points whose squared distance, as a pair of doubles, is the greatest, or cannot be told from it.
struct Rim {
    greatest: [f64; 2],
    points: Vec<[f64; 3]>,
}

impl Rim {
    fn take(&mut self, point: [f64; 3], centre: [f64; 3], scale: f64) {
        /// Beyond what pairs of doubles lose in three squares and their sum, with either of two: 2^-96.
        const ERROR: f64 = 1.0 / (1_u128 << 96) as f64;
        let square = pair_squared(point, centre, scale);
        let above = (square[0] - self.greatest[0]) + (square[1] - self.greatest[1]);
        let error = ERROR * square[0];
        if above > error {
            self.points.clear();
            self.greatest = square;
        }
        if above >= -error {
            self.points.push(point);
        }
    }
}

/// The squared distance of two points in the scale, as a pair of doubles.
fn pair_squared(point: [f64; 3], centre: [f64; 3], scale: f64) -> [f64; 2] {
    let (mut high, mut low) = (0.0, 0.0);
    for axis in 0..3 {
        let (difference, rest) = two_sum(point[axis], -centre[axis]);
        let (difference, rest) = (difference * scale, rest * scale);
        let (square, lost) = two_product(difference, difference);
        let (sum, carried) = two_sum(high, square);
        low += carried + (lost + (2.0 * difference + rest) * rest);
        high = sum;
    }
    let (high, low) = two_sum(high, low);
    [high, low]
}

/// The least double not below `radius` nor the distance of the point, which exceeds it by a few units in the last place at
/// most.
fn cover(centre: [f64; 3], point: [f64; 3], mut radius: f64) -> f64 {
    let square = |x: &Dyadic| x * x;
    let squares = [0, 1, 2].map(|axis| square(&(&Dyadic::from_f64(point[axis]) - &Dyadic::from_f64(centre[axis]))));
    let squared = &(&squares[0] + &squares[1]) + &squares[2];
    while (&squared - &Dyadic::product(radius, radius)).sign() == Sign::Positive {
        radius = radius.next_up();
    }
    radius
}
