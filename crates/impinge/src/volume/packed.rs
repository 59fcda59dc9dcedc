//! Boxes whose extents are small integers (*Notes*, 2.1: dimensions or radii "as integers, which
//! can be more tightly packed than floats").
//!
//! The corner or center is in single precision. Each extent is a number of steps; the step length
//! is a power of two that each box stores. A box takes 16 bytes with 8-bit steps and 20 bytes with
//! 16-bit steps, where six singles take 24. Decoding is exact in double precision, so a packed box
//! *is* the box it decodes to. Only packing rounds, and it rounds outward.
//!
//! Tests: `tests/it/volumes/boxes.rs`. Benchmark: `box_forms`.

use super::rounding::{add_up, f32_down};
use super::{BoundingVolume, CenterRadius, MinMax, MinWidths};
use crate::input::{InputError, InputErrorKind};

mod sealed {
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for u16 {}
}

/// The unsigned integer that holds an extent of a packed box, in steps: `u8` or `u16`. The exponent
/// of the step length has the same size, so a packed box has no padding bytes.
pub trait Steps: sealed::Sealed + Copy + PartialEq + std::fmt::Debug + Send + Sync + Into<u32> + 'static {
    /// The integer type that holds the exponent of the step length.
    type Exponent: Copy + PartialEq + std::fmt::Debug + Send + Sync + Into<i32> + 'static;

    /// Maximum number of steps.
    const MOST: u32;

    /// Converts a number of steps, at most [`MOST`](Self::MOST).
    fn from_count(count: u32) -> Self;

    /// Converts an exponent between -126 and 127.
    fn exponent(exponent: i32) -> Self::Exponent;
}

impl Steps for u8 {
    type Exponent = i8;

    const MOST: u32 = Self::MAX as u32;

    fn from_count(count: u32) -> Self {
        count as Self
    }

    fn exponent(exponent: i32) -> i8 {
        exponent as i8
    }
}

impl Steps for u16 {
    type Exponent = i16;

    const MOST: u32 = Self::MAX as u32;

    fn from_count(count: u32) -> Self {
        count as Self
    }

    fn exponent(exponent: i32) -> i16 {
        exponent as i16
    }
}

/// The box of the points `min + w` with `0 ≤ w ≤ widths · 2^exponent` on each axis. `min` is in
/// single precision, and `widths` are small integers. A box packed from a [`MinWidths`] encloses
/// it.
///
/// ```
/// use impinge::volume::{MinMax, MinWidths, PackedMinWidths};
/// let bounds = MinWidths::from(MinMax::new([0.0; 3], [1.0, 0.7, 0.0])?);
/// let packed = PackedMinWidths::<u8>::try_from(bounds)?;
/// assert_eq!(size_of_val(&packed), 16);
/// assert_eq!(MinWidths::from(packed).widths(), [1.0, 90.0 / 128.0, 0.0]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedMinWidths<T: Steps> {
    min: [f32; 3],
    widths: [T; 3],
    exponent: T::Exponent,
}

/// The box of the points `center + e` with `|e| ≤ half_extents · 2^exponent` on each axis. `center`
/// is in single precision, and `half_extents` are small integers. A box packed from a
/// [`CenterRadius`] encloses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedCenterRadius<T: Steps> {
    center: [f32; 3],
    half_extents: [T; 3],
    exponent: T::Exponent,
}

const _: () = assert!(size_of::<PackedMinWidths<u8>>() == 16 && size_of::<PackedCenterRadius<u8>>() == 16);
const _: () = assert!(size_of::<PackedMinWidths<u16>>() == 20 && size_of::<PackedCenterRadius<u16>>() == 20);
const _: () = assert!(size_of::<super::Aabb>() == 24);

/// Packs without shrinking.
///
/// # Errors
/// Returns [`OutOfRange`](InputErrorKind::OutOfRange) if a coordinate exceeds 2^127.
impl<T: Steps> TryFrom<MinWidths> for PackedMinWidths<T> {
    type Error = InputError;

    fn try_from(bounds: MinWidths) -> Result<Self, InputError> {
        let min = bounds.min().map(f32_down);
        let reach = |axis: usize| {
            let below = add_up(bounds.min()[axis], -f64::from(min[axis]));
            add_up(below, bounds.widths()[axis])
        };
        let (widths, exponent) = pack::<T>(bounds.min(), [reach(0), reach(1), reach(2)])?;
        Ok(Self { min, widths, exponent })
    }
}

/// Packs without shrinking.
///
/// # Errors
/// Returns [`OutOfRange`](InputErrorKind::OutOfRange) if a coordinate exceeds 2^127.
impl<T: Steps> TryFrom<CenterRadius> for PackedCenterRadius<T> {
    type Error = InputError;

    fn try_from(bounds: CenterRadius) -> Result<Self, InputError> {
        let center = bounds.center().map(|x| x as f32);
        let reach = |axis: usize| {
            let (rounded, exact) = (f64::from(center[axis]), bounds.center()[axis]);
            add_up(add_up(rounded.max(exact), -rounded.min(exact)), bounds.half_extents()[axis])
        };
        let (half_extents, exponent) = pack::<T>(bounds.center(), [reach(0), reach(1), reach(2)])?;
        Ok(Self { center, half_extents, exponent })
    }
}

/// Exact.
impl<T: Steps> From<PackedMinWidths<T>> for MinWidths {
    fn from(packed: PackedMinWidths<T>) -> Self {
        let step = power_of_two(packed.exponent.into());
        Self::from_valid(packed.min.map(f64::from), packed.widths.map(|steps| f64::from(steps.into()) * step))
    }
}

/// Exact.
impl<T: Steps> From<PackedCenterRadius<T>> for CenterRadius {
    fn from(packed: PackedCenterRadius<T>) -> Self {
        let step = power_of_two(packed.exponent.into());
        Self::from_valid(packed.center.map(f64::from), packed.half_extents.map(|steps| f64::from(steps.into()) * step))
    }
}

impl<T: Steps> PackedMinWidths<T> {
    /// Reports whether the two boxes overlap, exactly. Touching boxes overlap.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        MinWidths::from(*self).overlaps(&MinWidths::from(*other))
    }

    /// Returns a packed box that encloses both.
    ///
    /// # Errors
    /// Returns [`OutOfRange`](InputErrorKind::OutOfRange) if a coordinate of the union exceeds
    /// 2^127.
    pub fn merged(&self, other: &Self) -> Result<Self, InputError> {
        MinWidths::from(*self).merged(&MinWidths::from(*other)).try_into()
    }

    /// Returns the enclosed volume in cubic units, rounded.
    #[must_use]
    pub fn volume(&self) -> f64 {
        MinWidths::from(*self).volume()
    }
}

impl<T: Steps> PackedCenterRadius<T> {
    /// Reports whether the two boxes may overlap, by the test of [`CenterRadius`]: `false` is
    /// returned only if they are proved apart. Touching boxes overlap.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        CenterRadius::from(*self).overlaps(&CenterRadius::from(*other))
    }

    /// Returns a packed box that encloses both.
    ///
    /// # Errors
    /// Returns [`OutOfRange`](InputErrorKind::OutOfRange) if a coordinate of the union exceeds
    /// 2^127.
    pub fn merged(&self, other: &Self) -> Result<Self, InputError> {
        CenterRadius::from(*self).merged(&CenterRadius::from(*other)).try_into()
    }

    /// Returns the enclosed volume in cubic units, rounded.
    #[must_use]
    pub fn volume(&self) -> f64 {
        CenterRadius::from(*self).volume()
    }
}

/// Converts to double precision: the largest corner is rounded outward once, the rest is exact.
impl<T: Steps> From<PackedMinWidths<T>> for MinMax {
    fn from(packed: PackedMinWidths<T>) -> Self {
        MinWidths::from(packed).into()
    }
}

/// Converts to double precision: each corner is rounded outward once.
impl<T: Steps> From<PackedCenterRadius<T>> for MinMax {
    fn from(packed: PackedCenterRadius<T>) -> Self {
        CenterRadius::from(packed).into()
    }
}

/// Returns the lengths as numbers of steps, rounded up, and the exponent of the step length. The
/// exponent is the smallest for which the longest length fits.
fn pack<T: Steps>(position: [f64; 3], lengths: [f64; 3]) -> Result<([T; 3], T::Exponent), InputError> {
    const MAX_COORDINATE: f64 = (1_u128 << 127) as f64;
    /// Smallest exponent of single precision. A positive length below this step takes one step.
    const MIN_EXPONENT: i32 = -126;
    let numbers = position.into_iter().chain(lengths);
    if let Some(index) = numbers.map(f64::abs).position(|x| x > MAX_COORDINATE) {
        let what = "box coordinate";
        return Err(InputError::new(InputErrorKind::OutOfRange { what, index: index % 3, limit: "2^127" }));
    }
    let longest = lengths.into_iter().fold(0.0, f64::max);
    // This is within 2 of the result: the leading bit of the longest length, less the number of
    // bits of the integer.
    let leading = (longest.to_bits() >> 52) as i32 - 1023;
    let mut exponent = (leading - T::MOST.count_ones() as i32).max(MIN_EXPONENT);
    while (longest / power_of_two(exponent)).ceil() > f64::from(T::MOST) {
        exponent += 1;
    }
    // Dividing by a power of two is exact unless it underflows. A positive length that underflows
    // still takes one step.
    let steps = lengths.map(|length| {
        let count = (length / power_of_two(exponent)).ceil() as u32;
        T::from_count(if length > 0.0 { count.max(1) } else { 0 })
    });
    Ok((steps, T::exponent(exponent)))
}

/// Returns `2^exponent` for an exponent in the range of single precision.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
