//! Points as they are given, judged once.

use super::super::MinMax;
use crate::input::{InputError, InputErrorKind};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A coordinate in single or double precision: the real number that the float is.
pub trait Coordinate: sealed::Sealed + Copy + PartialOrd + Send + Sync + Into<f64> + 'static {
    /// Positive infinity.
    const INFINITE: Self;

    /// The same number with the other sign.
    #[must_use]
    fn negated(self) -> Self;
}

impl Coordinate for f32 {
    const INFINITE: Self = Self::INFINITY;

    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}

impl Coordinate for f64 {
    const INFINITE: Self = Self::INFINITY;

    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }
}

/// The point in double precision, which holds either kind without rounding.
#[inline(always)]
pub(in super::super) fn widen<T: Coordinate>(point: [T; 3]) -> [f64; 3] {
    point.map(Into::into)
}

/// Coordinates looked at side by side: eight points, so that every lane stays on one axis and no lane has to move.
const LANES: usize = 24;

/// The box of the points, exactly, zeros being positive.
///
/// # Errors
/// Without points, or where one is not finite or not below 2^128.
pub(in super::super) fn judge<T: Coordinate>(points: &[[T; 3]]) -> Result<MinMax, InputError> {
    const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;
    if points.is_empty() {
        return Err(InputError::new(InputErrorKind::Empty { what: "points" }));
    }
    let (mut min, mut max) = ([T::INFINITE; LANES], [T::INFINITE.negated(); LANES]);
    let flat = points.as_flattened();
    let (groups, rest) = flat.as_chunks::<LANES>();
    // NaN fails every comparison, so that it is kept out of the bounds; the sum of what is equal to itself finds it.
    let mut unequal = [0_u32; LANES];
    let mut look = |lane: usize, x: T| {
        min[lane] = if x < min[lane] { x } else { min[lane] };
        max[lane] = if x > max[lane] { x } else { max[lane] };
        #[allow(clippy::eq_op, reason = "false for NaN alone")]
        let equal = x == x;
        unequal[lane] |= u32::from(!equal);
    };
    for group in groups {
        for (lane, &x) in group.iter().enumerate() {
            look(lane, x);
        }
    }
    for (lane, &x) in rest.iter().enumerate() {
        look(lane, x);
    }
    let on_axis = |axis: usize| (axis..LANES).step_by(3);
    let low: [f64; 3] =
        std::array::from_fn(|axis| on_axis(axis).map(|lane| min[lane].into()).fold(f64::INFINITY, f64::min) + 0.0);
    let high: [f64; 3] =
        std::array::from_fn(|axis| on_axis(axis).map(|lane| max[lane].into()).fold(f64::NEG_INFINITY, f64::max) + 0.0);
    let outside = low.iter().chain(&high).any(|x| !(x.abs() < LIMIT));
    if outside || unequal.iter().any(|&bits| bits != 0) {
        return Err(first_bad(points, LIMIT));
    }
    Ok(MinMax::from_ordered(low, high))
}

/// The error for the first point that is not finite or out of range; there is one.
fn first_bad<T: Coordinate>(points: &[[T; 3]], limit: f64) -> InputError {
    for (index, &point) in points.iter().enumerate() {
        for x in widen(point) {
            if !x.is_finite() {
                return InputError::new(InputErrorKind::NonFinite { what: "vertex", index });
            }
            if x.abs() >= limit {
                return InputError::new(InputErrorKind::OutOfRange { what: "vertex", index, limit: "2^128" });
            }
        }
    }
    InputError::new(InputErrorKind::Empty { what: "points" })
}
