//! The nearest points of two sets, and the scaling under which closed forms find them.

use crate::math::vec3::Vector;
use crate::math::vec3::length;

/// The nearest points of two sets A and B, in the frame and unit of the arguments.
///
/// # Accuracy
/// The true distance of the sets differs from [`distance`](Self::distance) by at most
/// [`error`](Self::error). The distance of two triangles is zero exactly if they intersect; other
/// distances are zero or positive.
///
/// The error bound is 2^-47 of the diagonal of the box that holds both sets. In units of 2^-53: 15
/// of distances between points and 8 of each edge for the parameters, 5 of each for rounding the
/// edges and the differences of points, twice. This is 46 in all, taken as 64. The coordinates of
/// the points are rounded once more, in their last place. `tests/it/distance` compares with
/// rationals: the largest error seen is 10 % of the bound.
///
/// All coordinates must be finite and at most 2^500 in magnitude; a power of two is factored out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoints {
    /// Distance of the two points, in the unit of the arguments.
    pub distance: f64,
    /// Error bound: the true distance of the sets differs from `distance` by at most this.
    pub error: f64,
    /// A point of A that is nearest to B, in the frame of the arguments, rounded.
    pub point_a: Vector,
    /// A point of B that is nearest to A, in the frame of the arguments, rounded.
    pub point_b: Vector,
}

/// Error bound of a closed form, relative to the diagonal of the box that holds its arguments.
/// [`ClosestPoints`] derives it.
pub(crate) const CLOSED_FORM_ERROR: f64 = 1.0 / (1_u64 << 47) as f64;

/// Points scaled by a power of two, so that the largest coordinate is about 1. This is exact,
/// except for coordinates that underflow because they are far below the largest.
pub(super) struct Scaled<const N: usize> {
    pub(super) points: [Vector; N],
    back: f64,
    pub(super) diagonal: f64,
}

impl<const N: usize> Scaled<N> {
    pub(super) fn new(points: [Vector; N]) -> Self {
        let largest = points.iter().flatten().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        // The exponent of the largest coordinate. The clamp keeps both powers of two normal; zero
        // and subnormal coordinates are scaled up by 2^1000.
        let exponent = ((largest.to_bits() >> 52) as i64 - 1023).clamp(-1000, 1000);
        let power = |exponent: i64| f64::from_bits(((1023 + exponent) as u64) << 52);
        let points = points.map(|point| point.map(|x| x * power(-exponent)));
        let side = |k: usize| {
            let (low, high) = points
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| (low.min(point[k]), high.max(point[k])));
            high - low
        };
        Self { points, back: power(exponent), diagonal: length(&[side(0), side(1), side(2)]) }
    }

    /// Returns the error bound in the scaled unit.
    pub(super) fn error(&self) -> f64 {
        CLOSED_FORM_ERROR * self.diagonal
    }

    /// Converts a result from the scaled unit to the unit of the arguments.
    pub(super) fn back(&self, squared: f64, on_a: Vector, on_b: Vector) -> ClosestPoints {
        let back = |point: Vector| point.map(|x| x * self.back);
        ClosestPoints {
            distance: squared.sqrt() * self.back,
            error: self.error() * self.back,
            point_a: back(on_a),
            point_b: back(on_b),
        }
    }
}
