//! Points as they are given, judged once.

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

/// A coordinate in single or double precision: the real number that the float is.
pub trait Coordinate:
    sealed::Sealed + Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Send + Sync + Into<f64> + 'static
{
    /// Zero.
    const ZERO: Self;

    /// Positive infinity.
    const INFINITE: Self;

    /// The same number with the other sign.
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
    /// The least box of these points, exactly.
    ///
    /// # Errors
    /// As [`BoundingVolume::of_points`](super::BoundingVolume::of_points).
    ///
    /// # Complexity
    /// One pass over memory.
    pub fn of<T: Coordinate>(points: &[[T; 3]]) -> Result<Self, InputError> {
        judge(points)
    }
}

/// The point in double precision, which holds either kind without rounding.
#[inline(always)]
pub(super) fn widen<T: Coordinate>(point: [T; 3]) -> [f64; 3] {
    point.map(Into::into)
}

/// Coordinates looked at side by side: four points, so that every lane stays on one axis, no lane has to move and the bounds
/// stay in registers.
const LANES: usize = 12;

/// Coordinates are below this.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// The box of the points, exactly, zeros being positive.
///
/// # Errors
/// Without points, or where one is not finite or not below 2^128.
pub(super) fn judge<T: Coordinate>(points: &[[T; 3]]) -> Result<MinMax, InputError> {
    bounds(points).ok_or_else(|| first_bad(points))
}

/// As [`judge`], with nothing said of what is wrong.
pub(super) fn bounds<T: Coordinate>(points: &[[T; 3]]) -> Option<MinMax> {
    dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || bounds_by_lanes(points)))
}

#[inline(always)]
fn bounds_by_lanes<T: Coordinate>(points: &[[T; 3]]) -> Option<MinMax> {
    let (mut min, mut max) = ([T::INFINITE; LANES], [T::INFINITE.negated(); LANES]);
    let flat = points.as_flattened();
    let (groups, rest) = flat.as_chunks::<LANES>();
    // NaN fails every comparison, so that it is kept out of the bounds; what is not zero when taken from itself finds it.
    let mut poison = [T::ZERO; LANES];
    for group in groups {
        for (lane, &x) in group.iter().enumerate() {
            look(&mut min[lane], &mut max[lane], &mut poison[lane], x);
        }
    }
    for (lane, &x) in rest.iter().enumerate() {
        look(&mut min[lane], &mut max[lane], &mut poison[lane], x);
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

/// Takes one coordinate into the bounds of its lane.
#[inline(always)]
#[allow(clippy::eq_op, reason = "zero for what is finite and for nothing else")]
fn look<T: Coordinate>(min: &mut T, max: &mut T, poison: &mut T, x: T) {
    *min = if x < *min { x } else { *min };
    *max = if x > *max { x } else { *max };
    *poison = *poison + (x - x);
}

/// The error for points without bounds: the first that is not finite or out of range.
fn first_bad<T: Coordinate>(points: &[[T; 3]]) -> InputError {
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
