//! The nearest points of two sets, and the scale at which closed forms find them.

use crate::math::vec3::Vector;
use crate::math::vec3::length;

/// The nearest points of two sets A and B, in the frame and unit of the arguments.
///
/// # Accuracy
/// The true distance of the sets is within [`error`](Self::error) of [`distance`](Self::distance), which is zero exactly
/// where triangles have a common point and zero or positive for the others. The error is 2^-47 of the diagonal of the
/// box that holds both sets: 15 units of 2^-53 of distances between points and 8 of each edge for the parameters,
/// 5 of each for rounding the edges and what is between the points, twice, 46 in all, taken as 64. Coordinates of the
/// points are rounded once more, in their last place. Tested against rationals in `tests/it/distance`: the largest error
/// seen is a tenth of the bound.
///
/// Any finite coordinates up to 2^500 will do; scales are taken out by a power of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoints {
    /// The distance of the two points.
    pub distance: f64,
    /// More than what the distance may be off by.
    pub error: f64,
    /// A point of A.
    pub point_a: Vector,
    /// A point of B.
    pub point_b: Vector,
}

/// More than the error of a closed form, in units of the diagonal of the box that holds its arguments; [`ClosestPoints`]
/// says why.
pub(crate) const CLOSED_FORM_ERROR: f64 = 1.0 / (1_u64 << 47) as f64;

/// Points brought to about one unit by a power of two, which rounds nothing but what is far below the rest.
pub(super) struct Scaled<const N: usize> {
    pub(super) points: [Vector; N],
    back: f64,
    pub(super) diagonal: f64,
}

impl<const N: usize> Scaled<N> {
    pub(super) fn new(points: [Vector; N]) -> Self {
        let largest = points.iter().flatten().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        // Exponents of normal numbers; zeros and the subnormal are brought up by as much as there is room for.
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

    /// The bound of the error in the scaled unit.
    pub(super) fn error(&self) -> f64 {
        CLOSED_FORM_ERROR * self.diagonal
    }

    /// In the unit of the arguments.
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
