//! The axis-aligned box as its smallest corner and its widths (*Notes on Real Time Collision
//! Detection*, 2.1, listing 2.2).
//!
//! Tests: `tests/it/volumes/boxes.rs`. Benchmark: `box_forms`.

use super::min_max::{in_range, lengths_in_range};
use super::rounding::{add_down, add_up, mul_down, mul_up, two_sum};
use super::{BoundingVolume, MinMax};
use crate::input::InputError;
use crate::math::Pose;

/// The closed box of the points `min + w` with `0 ≤ w ≤ widths` on each axis, as a sum of real
/// numbers.
///
/// Widths are small even if the corners are far from the origin, which lets
/// [`PackedMinWidths`](super::PackedMinWidths) store them as small integers.
///
/// ```
/// use impinge::volume::{MinMax, MinWidths};
/// let bounds = MinMax::new([0.1; 3], [0.7; 3])?;
/// let by_widths = MinWidths::from(bounds);
/// // 0.7 - 0.1 is not a double, so the widths are rounded up.
/// assert!(MinMax::from(by_widths).encloses(&bounds));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinWidths {
    min: [f64; 3],
    widths: [f64; 3],
}

const _: () = assert!(size_of::<MinWidths>() == 48);

impl MinWidths {
    /// Builds the box from its smallest corner and its widths.
    ///
    /// # Errors
    /// Returns [`NonFinite`](crate::input::InputErrorKind::NonFinite),
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) (beyond 2^320) or, for widths,
    /// [`Negative`](crate::input::InputErrorKind::Negative), with the index of the axis.
    pub fn new(min: [f64; 3], widths: [f64; 3]) -> Result<Self, InputError> {
        in_range("box coordinate", min)?;
        lengths_in_range("box width", widths)?;
        Ok(Self { min, widths })
    }

    /// Builds the box from numbers that are known to be valid.
    pub(super) fn from_valid(min: [f64; 3], widths: [f64; 3]) -> Self {
        Self { min, widths }
    }

    /// Returns the smallest coordinate on each axis.
    #[must_use]
    pub fn min(&self) -> [f64; 3] {
        self.min
    }

    /// Returns the lengths of the box along the axes.
    #[must_use]
    pub fn widths(&self) -> [f64; 3] {
        self.widths
    }

    /// Reports whether every point of the other box is proved to be in this one.
    #[must_use]
    pub fn encloses(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            self.min[axis] <= other.min[axis]
                && add_up(add_up(other.min[axis], -self.min[axis]), other.widths[axis]) <= self.widths[axis]
        })
    }
}

/// Converts without shrinking: the widths are rounded up.
impl From<MinMax> for MinWidths {
    fn from(bounds: MinMax) -> Self {
        let (min, max) = (bounds.min(), bounds.max());
        Self { min, widths: std::array::from_fn(|axis| add_up(max[axis], -min[axis])) }
    }
}

/// Converts without shrinking: the largest corner is rounded up.
impl From<MinWidths> for MinMax {
    fn from(bounds: MinWidths) -> Self {
        let MinWidths { min, widths } = bounds;
        Self::from_ordered(min, std::array::from_fn(|axis| add_up(min[axis], widths[axis])))
    }
}

impl BoundingVolume for MinWidths {
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        MinMax::of(points).map(Self::from)
    }

    /// Reports whether the boxes overlap, exactly and without computing the largest corner. The
    /// boxes are apart on an axis if the difference of their smallest corners exceeds the width of
    /// the lower box.
    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            !exceeds(other.min[axis], self.min[axis], self.widths[axis])
                && !exceeds(self.min[axis], other.min[axis], other.widths[axis])
        })
    }

    /// Reports whether the point is inside, exactly.
    fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|axis| self.min[axis] <= point[axis] && !exceeds(point[axis], self.min[axis], self.widths[axis]))
    }

    /// Returns a box that holds both. The smallest corner is exact; the widths are rounded up.
    fn merged(&self, other: &Self) -> Self {
        let min: [f64; 3] = std::array::from_fn(|axis| self.min[axis].min(other.min[axis]));
        let reach = |part: &Self, axis: usize| add_up(add_up(part.min[axis], -min[axis]), part.widths[axis]);
        Self { min, widths: std::array::from_fn(|axis| reach(self, axis).max(reach(other, axis))) }
    }

    /// Accepts any affine map. The widths are transformed separately, like half-extents, and then
    /// enlarged by the rounding error of the corner.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let (linear, translation) = (world_from_local.linear(), world_from_local.translation());
        let (mut low, mut high, mut widths) = (*translation, *translation, [0.0; 3]);
        for axis in 0..3 {
            for from in 0..3 {
                let (entry, width) = (linear[axis][from], self.widths[from]);
                low[axis] = add_down(low[axis], mul_down(entry, self.min[from]));
                high[axis] = add_up(high[axis], mul_up(entry, self.min[from]));
                if entry < 0.0 {
                    low[axis] = add_down(low[axis], mul_down(entry, width));
                    high[axis] = add_up(high[axis], mul_up(entry, width));
                }
                widths[axis] = add_up(widths[axis], mul_up(entry.abs(), width));
            }
            widths[axis] = add_up(widths[axis], add_up(high[axis], -low[axis]));
        }
        Self::new(low, widths)
    }

    fn volume(&self) -> f64 {
        let [x, y, z] = self.widths;
        x * y * z
    }

    fn surface_area(&self) -> f64 {
        let [x, y, z] = self.widths;
        2.0 * (x * y + y * z + z * x)
    }
}

/// Reports whether `to - from > width` for real numbers. Rounding is monotonic, so the rounding
/// error decides only if the rounded difference equals the width.
#[inline(always)]
fn exceeds(to: f64, from: f64, width: f64) -> bool {
    let (difference, lost) = two_sum(to, -from);
    difference > width || difference == width && lost > 0.0
}
