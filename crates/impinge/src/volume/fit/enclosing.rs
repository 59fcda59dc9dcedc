//! Computes the smallest radius around a given center, rounded up. Also computes the power of two
//! that scales a set of points to a size of about 1, so that no square overflows or underflows.
//!
//! Tests: `tests/it/volumes/spheres.rs`.

use super::super::rounding::{HALF_ULP, two_product, two_sum};
use super::super::{BoundingSphere, MinMax};
use crate::math::Sign;
use crate::math::dyadic::Dyadic;
use crate::math::vec3::dot;
use crate::volume::points::{Coordinate, widen};

/// Returns the power of two that scales the largest extent of a box into [1, 2). For a point it
/// returns 1.
///
/// Multiplying a difference of coordinates by it is exact.
pub(super) fn unit_scale(bounds: &MinMax) -> f64 {
    let extent = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
    if extent == 0.0 {
        return 1.0;
    }
    // The leading bit of a subnormal extent is below the smallest normal exponent. The clamp then
    // gives the largest possible scale, and the extent stays below 1.
    let exponent = (extent.to_bits() >> 52) as i64 - 1023;
    f64::from_bits(((1023 - exponent).clamp(1, 2046) as u64) << 52)
}

/// Returns the offset of a point from a center, in scaled units.
#[inline(always)]
pub(super) fn scaled_offset(point: [f64; 3], center: [f64; 3], scale: f64) -> [f64; 3] {
    std::array::from_fn(|axis| (point[axis] - center[axis]) * scale)
}

/// Returns the squared length of an offset.
///
/// # Accuracy
/// Each difference of double-precision coordinates is rounded once, which counts twice in its
/// square. The square is rounded once, and the sums twice. The error is within 5.1 half units;
/// [`SQUARE_ERROR`] is larger.
#[inline(always)]
pub(super) fn squared(offset: [f64; 3]) -> f64 {
    dot(&offset, &offset)
}

/// Bound on the relative error of a squared distance, including its comparison.
pub(super) const SQUARE_ERROR: f64 = 8.0 * HALF_ULP;

/// Returns the sphere around a given center that encloses all points with the smallest double as
/// radius.
pub(super) fn about<T: Coordinate>(center: [f64; 3], points: &[[T; 3]], scale: f64) -> BoundingSphere {
    let square_of = |point: [T; 3]| squared(scaled_offset(widen(point), center, scale));
    let furthest = points.iter().map(|&point| square_of(point)).fold(0.0, |far, d| if d > far { d } else { far });
    // Double-double arithmetic leaves a few of the points whose distance doubles cannot distinguish
    // from the largest. Exact arithmetic decides those.
    let near = furthest * (1.0 - 2.0 * SQUARE_ERROR);
    let mut rim = Rim { greatest: [0.0; 2], points: Vec::new() };
    points
        .iter()
        .filter(|&&point| square_of(point) >= near)
        .for_each(|&point| rim.include(widen(point), center, scale));
    rim.points.sort_by(|p, q| p.partial_cmp(q).unwrap_or(std::cmp::Ordering::Equal));
    rim.points.dedup();
    let root = furthest.sqrt() / scale;
    let below = (0..5).fold(root, |radius, _| radius.next_down()).max(0.0);
    let radius = rim.points.iter().fold(below, |radius, &point| cover(center, point, radius));
    BoundingSphere::from_valid(center, radius)
}

/// The points whose squared distance, in double-double arithmetic, is the largest or cannot be
/// distinguished from it.
struct Rim {
    greatest: [f64; 2],
    points: Vec<[f64; 3]>,
}

impl Rim {
    fn include(&mut self, point: [f64; 3], center: [f64; 3], scale: f64) {
        /// Relative error bound, 2^-96. It exceeds the loss of double-double arithmetic in three
        /// squares and their sum, for both compared distances.
        const ERROR: f64 = 1.0 / (1_u128 << 96) as f64;
        let square = pair_squared(point, center, scale);
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

/// Returns the squared distance of two points, in scaled units, as a pair of doubles.
fn pair_squared(point: [f64; 3], center: [f64; 3], scale: f64) -> [f64; 2] {
    let (mut high, mut low) = (0.0, 0.0);
    for axis in 0..3 {
        let (difference, rest) = two_sum(point[axis], -center[axis]);
        let (difference, rest) = (difference * scale, rest * scale);
        let (square, lost) = two_product(difference, difference);
        let (sum, carried) = two_sum(high, square);
        low += carried + (lost + (2.0 * difference + rest) * rest);
        high = sum;
    }
    let (high, low) = two_sum(high, low);
    [high, low]
}

/// Returns the smallest double that is not below `radius` nor the distance of the point. The
/// distance must exceed `radius` by at most a few units in the last place.
fn cover(center: [f64; 3], point: [f64; 3], mut radius: f64) -> f64 {
    let square = |x: &Dyadic| x * x;
    let squares = [0, 1, 2].map(|axis| square(&(&Dyadic::from_f64(point[axis]) - &Dyadic::from_f64(center[axis]))));
    let squared = &(&squares[0] + &squares[1]) + &squares[2];
    while (&squared - &Dyadic::product(radius, radius)).sign() == Sign::Positive {
        radius = radius.next_up();
    }
    radius
}
