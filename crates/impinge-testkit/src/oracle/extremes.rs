//! Smallest box of the exact images of points, with each bound rounded outward to the next double.
//!
//! It checks the tight methods of `volume::Realign`, bit for bit.

use std::cmp::Ordering;

use dashu_int::IBig;

use super::boxes::{WorldBox, image_and_reach};
use super::integers::{compare, images};
use crate::Affine;

/// Returns the box of the images of all points.
///
/// Points whose interval in floats stays below that of another point are skipped. The rest are
/// compared as integers.
///
/// # Panics
/// Panics if there are no points, a number is not finite, or a bound is neither a normal number nor
/// zero.
pub fn tight_box(points: &[[f64; 3]], world_from_local: &Affine) -> WorldBox {
    // For each axis, low and high: a value that some point provably reaches.
    let mut certain = [[f64::NEG_INFINITY; 2]; 3];
    for &point in points {
        let (image, reach) = image_and_reach(world_from_local, point);
        for axis in 0..3 {
            certain[axis][0] = certain[axis][0].max(-image[axis] - reach[axis]);
            certain[axis][1] = certain[axis][1].max(image[axis] - reach[axis]);
        }
    }
    // One float covers the rounding of that sum, and one that of the sum it is compared with.
    let certain = certain.map(|sides| sides.map(|side| side.next_down().next_down()));
    let mut candidates: [[Vec<[f64; 3]>; 2]; 3] = Default::default();
    for &point in points {
        let (image, reach) = image_and_reach(world_from_local, point);
        for axis in 0..3 {
            for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                if sign * image[axis] + reach[axis] >= certain[axis][side] {
                    candidates[axis][side].push(point);
                }
            }
        }
    }
    let mut bounds = WorldBox { low: [0.0; 3], high: [0.0; 3] };
    for axis in 0..3 {
        for (side, candidates) in candidates[axis].iter().enumerate() {
            let (exact, scale) = images(candidates, world_from_local);
            let values = exact.into_iter().map(|[x, y, z]| [x, y, z].into_iter().nth(axis).expect("three axes"));
            if side == 1 {
                bounds.high[axis] = round(&values.max().expect("some point"), scale, true);
            } else {
                bounds.low[axis] = round(&values.min().expect("some point"), scale, false);
            }
        }
    }
    bounds
}

/// Returns the float next to an integer times a power of two, rounded up or down.
fn round(value: &IBig, exponent: i32, up: bool) -> f64 {
    // Two halves of the power, because it may be out of range although the result is not.
    let half = exponent / 2;
    let mut x = value.to_f64().value() * 2f64.powi(half) * 2f64.powi(exponent - half);
    assert!(x == 0.0 || x.is_normal(), "{x} is out of the oracle's range");
    while compare(x, value, exponent) == Ordering::Greater {
        x = x.next_down();
    }
    while compare(x, value, exponent) == Ordering::Less {
        x = x.next_up();
    }
    // `x` is now the smallest float that is not below the value.
    if up || compare(x, value, exponent) == Ordering::Equal { x } else { x.next_down() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_the_next_floats() {
        let third = Affine::new([[1.0 / 3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0]], [0.0, 0.0, 1.0]);
        let bounds = tight_box(&[[3.0, 0.5, f64::EPSILON / 4.0], [1.5, -0.5, 0.5]], &third);
        // Three times the float next to a third is just below 1, by less than half a step.
        assert_eq!((bounds.high[0], bounds.low[0]), (1.0, 0.5f64.next_down()));
        assert_eq!((bounds.low[1], bounds.high[1]), (-0.5, 0.5));
        assert_eq!((bounds.low[2], bounds.high[2]), (1.0, 1.5f64.next_up()));
    }
}
