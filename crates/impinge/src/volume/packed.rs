//! Boxes whose extents are small integers (*Notes*, 2.1: dimensions or radii "as integers, which can be more tightly packed
//! than floats").
//!
//! The corner or centre is in single precision and each extent a number of steps, whose length is a power of two of the
//! box's own: 16 bytes with steps of 8 bits and 20 with 16, where six singles take 24. Decoding is exact in double
//! precision, so a packed box *is* the box that it decodes to; only packing rounds, and it rounds outward.

use super::rounding::{add_up, f32_down};
use super::{BoundingVolume, CentreRadius, MinMax, MinWidths};
use crate::input::{InputError, InputErrorKind};

mod sealed {
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for u16 {}
}

/// An unsigned integer that counts steps: `u8` or `u16`. The exponent of the step takes as many bytes, so that no byte of
/// a packed box is padding with `u8`, and two are with `u16`.
pub trait Steps: sealed::Sealed + Copy + PartialEq + std::fmt::Debug + Send + Sync + Into<u32> + 'static {
    /// The integer that holds the exponent of the step.
    type Exponent: Copy + PartialEq + std::fmt::Debug + Send + Sync + Into<i32> + 'static;

    /// The most steps.
    const MOST: u32;

    /// A count of steps, at most [`MOST`](Self::MOST).
    fn from_count(count: u32) -> Self;

    /// An exponent between -126 and 127.
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

/// The box of the points `min + w` with `0 ≤ w ≤ widths · 2^exponent`.
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

/// The box of the points `centre + e` with `|e| ≤ half_extents · 2^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedCentreRadius<T: Steps> {
    centre: [f32; 3],
    half_extents: [T; 3],
    exponent: T::Exponent,
}

const _: () = assert!(size_of::<PackedMinWidths<u8>>() == 16 && size_of::<PackedCentreRadius<u8>>() == 16);
const _: () = assert!(size_of::<PackedMinWidths<u16>>() == 20 && size_of::<PackedCentreRadius<u16>>() == 20);
const _: () = assert!(size_of::<super::Aabb>() == 24);

/// Never smaller.
///
/// # Errors
/// [`OutOfRange`](InputErrorKind::OutOfRange) where a coordinate is beyond 2^127.
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

/// Never smaller.
///
/// # Errors
/// [`OutOfRange`](InputErrorKind::OutOfRange) where a coordinate is beyond 2^127.
impl<T: Steps> TryFrom<CentreRadius> for PackedCentreRadius<T> {
    type Error = InputError;

    fn try_from(bounds: CentreRadius) -> Result<Self, InputError> {
        let centre = bounds.centre().map(|x| x as f32);
        let reach = |axis: usize| {
            let (rounded, exact) = (f64::from(centre[axis]), bounds.centre()[axis]);
            add_up(add_up(rounded.max(exact), -rounded.min(exact)), bounds.half_extents()[axis])
        };
        let (half_extents, exponent) = pack::<T>(bounds.centre(), [reach(0), reach(1), reach(2)])?;
        Ok(Self { centre, half_extents, exponent })
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
impl<T: Steps> From<PackedCentreRadius<T>> for CentreRadius {
    fn from(packed: PackedCentreRadius<T>) -> Self {
        let step = power_of_two(packed.exponent.into());
        Self::from_valid(packed.centre.map(f64::from), packed.half_extents.map(|steps| f64::from(steps.into()) * step))
    }
}

impl<T: Steps> PackedMinWidths<T> {
    /// Whether the two overlap, exactly; touching counts.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        MinWidths::from(*self).overlaps(&MinWidths::from(*other))
    }

    /// A packed box that holds both.
    ///
    /// # Errors
    /// As packing: beyond 2^127.
    pub fn merged(&self, other: &Self) -> Result<Self, InputError> {
        MinWidths::from(*self).merged(&MinWidths::from(*other)).try_into()
    }

    /// What it encloses, in cubic units, rounded.
    #[must_use]
    pub fn volume(&self) -> f64 {
        MinWidths::from(*self).volume()
    }
}

impl<T: Steps> PackedCentreRadius<T> {
    /// Whether the two are not proved apart, as [`CentreRadius`] decides it; touching counts.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        CentreRadius::from(*self).overlaps(&CentreRadius::from(*other))
    }

    /// A packed box that holds both.
    ///
    /// # Errors
    /// As packing: beyond 2^127.
    pub fn merged(&self, other: &Self) -> Result<Self, InputError> {
        CentreRadius::from(*self).merged(&CentreRadius::from(*other)).try_into()
    }

    /// What it encloses, in cubic units, rounded.
    #[must_use]
    pub fn volume(&self) -> f64 {
        CentreRadius::from(*self).volume()
    }
}

/// The box in double precision, exactly up to one outward rounding of its greatest corner.
impl<T: Steps> From<PackedMinWidths<T>> for MinMax {
    fn from(packed: PackedMinWidths<T>) -> Self {
        MinWidths::from(packed).into()
    }
}

/// The box in double precision, up to one outward rounding of each corner.
impl<T: Steps> From<PackedCentreRadius<T>> for MinMax {
    fn from(packed: PackedCentreRadius<T>) -> Self {
        CentreRadius::from(packed).into()
    }
}

/// Lengths as numbers of steps, rounded up, and the exponent of the least step by which the longest is not too many.
fn pack<T: Steps>(anchor: [f64; 3], lengths: [f64; 3]) -> Result<([T; 3], T::Exponent), InputError> {
    const LARGEST: f64 = (1_u128 << 127) as f64;
    /// Below single precision: what is shorter becomes one step of this.
    const LEAST_EXPONENT: i32 = -126;
    let numbers = anchor.into_iter().chain(lengths);
    if let Some(index) = numbers.map(f64::abs).position(|x| x > LARGEST) {
        let what = "box coordinate";
        return Err(InputError::new(InputErrorKind::OutOfRange { what, index: index % 3, limit: "2^127" }));
    }
    let longest = lengths.into_iter().fold(0.0, f64::max);
    // Within 2 of the exponent that is wanted: as many bits as the integer has, below the leading bit of the longest.
    let leading = (longest.to_bits() >> 52) as i32 - 1023;
    let mut exponent = (leading - T::MOST.count_ones() as i32).max(LEAST_EXPONENT);
    while (longest / power_of_two(exponent)).ceil() > f64::from(T::MOST) {
        exponent += 1;
    }
    // Dividing by a power of two is exact unless it underflows, and what is not zero then still takes one step.
    let steps = lengths.map(|length| {
        let count = (length / power_of_two(exponent)).ceil() as u32;
        T::from_count(if length > 0.0 { count.max(1) } else { 0 })
    });
    Ok((steps, T::exponent(exponent)))
}

/// `2^exponent`, for an exponent of single precision.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
