//! Points as they are given, validated once.
//!
//! Tests: `tests/it/volumes/refusals.rs`.

use std::ops::{Add, Sub};

use fearless_simd::Simd;

use super::MinMax;
use crate::input::{InputError, InputErrorKind};
use crate::simd::{best_level, dispatch};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A coordinate in single or double precision. Its value is exactly the real number that the float
/// represents.
pub trait Coordinate:
    sealed::Sealed + Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Send + Sync + Into<f64> + 'static
{
    /// Zero.
    const ZERO: Self;

    /// Positive infinity.
    const INFINITE: Self;

    /// Returns the same number with the opposite sign.
    #[must_use]
    fn negated(self) -> Self;
}

impl Coordinate for f32 {
    const ZERO: Self = 0.0;
    const INFINITE: Self = Self::INFINITY;

    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}

impl Coordinate for f64 {
    const ZERO: Self = 0.0;
    const INFINITE: Self = Self::INFINITY;

    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}

impl MinMax {
    /// Returns the smallest box that holds the points, exactly.
    ///
    /// # Errors
    /// Same as [`BoundingVolume::of_points`](super::BoundingVolume::of_points).
    ///
    /// # Complexity
    /// One pass over memory.
    pub fn of<T: Coordinate>(points: &[[T; 3]]) -> Result<Self, InputError> {
        validated_bounds(points)
    }
}

/// Converts the point to double precision, without rounding.
#[inline(always)]
pub(super) fn widen<T: Coordinate>(point: [T; 3]) -> [f64; 3] {
    point.map(Into::into)
}

/// Number of coordinates processed side by side: those of four points. Since 12 is a multiple of 3,
/// every lane stays on one axis, no lane has to move, and the bounds stay in registers.
const LANES: usize = 12;

/// Exclusive upper bound of the magnitude of a coordinate: 2^128.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// Validates the points and returns their bounding box, exactly. Zeros in the box are positive.
///
/// # Errors
/// Returns an error if there are no points, or if a coordinate is not finite or has a magnitude of
/// 2^128 or more.
pub(super) fn validated_bounds<T: Coordinate>(points: &[[T; 3]]) -> Result<MinMax, InputError> {
    bounds(points).ok_or_else(|| first_invalid(points))
}

/// Does the same as [`validated_bounds`] but returns `None` for invalid points, without the reason.
pub(super) fn bounds<T: Coordinate>(points: &[[T; 3]]) -> Option<MinMax> {
    dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || bounds_by_lanes(points)))
}

#[inline(always)]
fn bounds_by_lanes<T: Coordinate>(points: &[[T; 3]]) -> Option<MinMax> {
    let (mut min, mut max) = ([T::INFINITE; LANES], [T::INFINITE.negated(); LANES]);
    let flat = points.as_flattened();
    let (groups, rest) = flat.as_chunks::<LANES>();
    // NaN fails every comparison, so it never enters the bounds. `x - x` is zero only for finite
    // numbers, so the sum detects NaN and infinity.
    let mut poison = [T::ZERO; LANES];
    for group in groups {
        for (lane, &x) in group.iter().enumerate() {
            include_coordinate(&mut min[lane], &mut max[lane], &mut poison[lane], x);
        }
    }
    for (lane, &x) in rest.iter().enumerate() {
        include_coordinate(&mut min[lane], &mut max[lane], &mut poison[lane], x);
    }
    let on_axis = |axis: usize| (axis..LANES).step_by(3);
    let low: [f64; 3] =
        std::array::from_fn(|axis| on_axis(axis).map(|lane| min[lane].into()).fold(f64::INFINITY, f64::min) + 0.0);
    let high: [f64; 3] =
        std::array::from_fn(|axis| on_axis(axis).map(|lane| max[lane].into()).fold(f64::NEG_INFINITY, f64::max) + 0.0);
    // Without points the bounds are infinite.
    let in_range = low.iter().chain(&high).all(|x| x.abs() < LIMIT);
    (in_range && poison.iter().all(|&sum| sum == T::ZERO)).then(|| MinMax::from_ordered(low, high))
}

/// Includes one coordinate in the bounds of its lane.
#[inline(always)]
#[allow(clippy::eq_op, reason = "zero for what is finite and for nothing else")]
fn include_coordinate<T: Coordinate>(min: &mut T, max: &mut T, poison: &mut T, x: T) {
    *min = if x < *min { x } else { *min };
    *max = if x > *max { x } else { *max };
    *poison = *poison + (x - x);
}

/// Returns the error for invalid points: the first one that is not finite or out of range. Without
/// such a point the error is that the set is empty.
fn first_invalid<T: Coordinate>(points: &[[T; 3]]) -> InputError {
    for (index, &point) in points.iter().enumerate() {
        for x in widen(point) {
            if !x.is_finite() {
                return InputError::new(InputErrorKind::NonFinite { what: "vertex", index });
            }
            if x.abs() >= LIMIT {
                return InputError::new(InputErrorKind::OutOfRange { what: "vertex", index, limit: "2^128" });
            }
        }
    }
    InputError::new(InputErrorKind::Empty { what: "points" })
}
