//! The least radius about a given centre, rounded up; and the power of two that makes a set of points about one large, so
//! that no square overflows or vanishes.

use super::super::rounding::HALF_ULP;
use super::super::{BoundingSphere, MinMax};
use super::points::{Coordinate, widen};
use crate::math::Sign;
use crate::math::dyadic::Dyadic;

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
pub(super) fn squared([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z
}

/// A bound on the relative error of a squared distance, its comparison included.
pub(super) const SQUARE_ERROR: f64 = 8.0 * HALF_ULP;

/// The sphere about a centre with the least radius that holds all the points, rounded up.
///
/// # Accuracy
/// The radius is the least double for up to [`FEW`] most distant points, else within six half units of it.
pub(super) fn about<T: Coordinate>(centre: [f64; 3], points: &[[T; 3]], scale: f64) -> BoundingSphere {
    let furthest = points
        .iter()
        .map(|&point| squared(scaled_offset(widen(point), centre, scale)))
        .fold(0.0, |furthest, d| if d > furthest { d } else { furthest });
    let near = furthest * (1.0 - 2.0 * SQUARE_ERROR);
    let mut rim = Vec::new();
    for &point in points {
        if squared(scaled_offset(widen(point), centre, scale)) >= near {
            if rim.len() == FEW {
                break;
            }
            rim.push(widen(point));
        }
    }
    let root = (furthest.sqrt() / scale).max(0.0);
    let radius = if rim.len() < FEW {
        rim.iter()
            .fold(root.next_down().next_down().next_down().max(0.0), |radius, &point| cover(centre, point, radius))
    } else {
        // The square is within 8 half units, so the root within 4; its own and the division's rounding make 6.
        (0..6).fold(root, |radius, _| radius.next_up())
    };
    BoundingSphere::from_valid(centre, radius)
}

/// How many most distant points are measured exactly.
const FEW: usize = 64;

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
