//! The axis-aligned box as center and half-extents, or radii (*Notes*, 2.1, listing 2.3).
//!
//! Tests: `tests/it/volumes/boxes.rs`. Benchmark: `box_forms`.

use super::min_max::{in_range, lengths_in_range};
use super::rounding::{add_down, add_up, mul_down, mul_up};
use super::{BoundingVolume, MinMax};
use crate::input::InputError;
use crate::math::Pose;

/// The closed box of the points `center + e` with `|e| ≤ half_extents` on each axis, as a sum of
/// real numbers.
///
/// This form needs the fewest products to move: nine for the center and nine for the half-extents,
/// or nine in all if the center is the pivot.
///
/// ```
/// use impinge::volume::{CenterRadius, MinMax};
/// let bounds = CenterRadius::from(MinMax::new([1.0; 3], [4.0; 3])?);
/// assert_eq!((bounds.center(), bounds.half_extents()), ([2.5; 3], [1.5; 3]));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CenterRadius {
    center: [f64; 3],
    half_extents: [f64; 3],
}

const _: () = assert!(size_of::<CenterRadius>() == 48);

impl CenterRadius {
    /// Builds the box around a center.
    ///
    /// # Errors
    /// Returns [`NonFinite`](crate::input::InputErrorKind::NonFinite),
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) (beyond 2^320) or, for
    /// half-extents, [`Negative`](crate::input::InputErrorKind::Negative), with the index of the
    /// axis.
    pub fn new(center: [f64; 3], half_extents: [f64; 3]) -> Result<Self, InputError> {
        in_range("box coordinate", center)?;
        lengths_in_range("half-extent", half_extents)?;
        Ok(Self { center, half_extents })
    }

    /// Builds the box from numbers that are known to be valid.
    pub(super) fn from_valid(center: [f64; 3], half_extents: [f64; 3]) -> Self {
        Self { center, half_extents }
    }

    /// Returns the center.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        self.center
    }

    /// Returns half the lengths of the box along the axes.
    #[must_use]
    pub fn half_extents(&self) -> [f64; 3] {
        self.half_extents
    }

    /// Reports whether every point of the other box is proved to be in this one.
    #[must_use]
    pub fn encloses(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            let apart = distance_on_axis(self.center[axis], other.center[axis]);
            add_up(apart, other.half_extents[axis]) <= self.half_extents[axis]
        })
    }
}

/// Converts without shrinking: the center is rounded to nearest, and the half-extents, rounded up,
/// reach both corners from there.
impl From<MinMax> for CenterRadius {
    fn from(bounds: MinMax) -> Self {
        about_middle(bounds.min(), bounds.max())
    }
}

/// Converts without shrinking: both corners are rounded outward.
impl From<CenterRadius> for MinMax {
    fn from(bounds: CenterRadius) -> Self {
        let CenterRadius { center, half_extents } = bounds;
        Self::from_ordered(
            std::array::from_fn(|axis| add_down(center[axis], -half_extents[axis])),
            std::array::from_fn(|axis| add_up(center[axis], half_extents[axis])),
        )
    }
}

impl BoundingVolume for CenterRadius {
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        MinMax::of(points).map(Self::from)
    }

    /// Returns `false` if the distance of the centers exceeds the sum of the half-extents by more
    /// than one unit in the last place of that sum. Boxes with a smaller gap count as overlapping.
    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            // Rounding is monotonic: if the rounded difference exceeds a double, so does the exact
            // one.
            let sum = (self.half_extents[axis] + other.half_extents[axis]).next_up();
            (self.center[axis] - other.center[axis]).abs() <= sum
        })
    }

    /// Reports whether the point is inside. Exact, unlike [`overlaps`](BoundingVolume::overlaps).
    fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|axis| distance_on_axis(point[axis], self.center[axis]) <= self.half_extents[axis])
    }

    fn merged(&self, other: &Self) -> Self {
        // If one box encloses the other, it is the union. It need not grow by the rounding of its
        // corners.
        if self.encloses(other) {
            *self
        } else if other.encloses(self) {
            *other
        } else {
            let bounds = MinMax::from(*self).merged(&MinMax::from(*other));
            about_middle(bounds.min(), bounds.max())
        }
    }

    /// Accepts any affine map.
    ///
    /// # Source
    /// Arvo 1990; Ericson 4.2.6.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let (linear, translation) = (world_from_local.linear(), world_from_local.translation());
        let center = world_from_local.apply(self.center);
        let half_extents = std::array::from_fn(|axis| {
            let (mut low, mut high, mut half) = (translation[axis], translation[axis], 0.0);
            for from in 0..3 {
                low = add_down(low, mul_down(linear[axis][from], self.center[from]));
                high = add_up(high, mul_up(linear[axis][from], self.center[from]));
                half = add_up(half, mul_up(linear[axis][from].abs(), self.half_extents[from]));
            }
            let off = add_up(high, -center[axis]).max(add_up(center[axis], -low)).max(0.0);
            add_up(half, off)
        });
        Self::new(center, half_extents)
    }

    fn volume(&self) -> f64 {
        let [x, y, z] = self.half_extents;
        8.0 * x * y * z
    }

    fn surface_area(&self) -> f64 {
        let [x, y, z] = self.half_extents;
        8.0 * (x * y + y * z + z * x)
    }
}

/// Returns the box around the rounded midpoint of two corners that reaches both.
fn about_middle(min: [f64; 3], max: [f64; 3]) -> CenterRadius {
    let center: [f64; 3] = std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
    let half_extents =
        std::array::from_fn(|axis| add_up(max[axis], -center[axis]).max(add_up(center[axis], -min[axis])));
    CenterRadius { center, half_extents }
}

/// Returns a double not below `|a - b|`.
fn distance_on_axis(a: f64, b: f64) -> f64 {
    add_up(a.max(b), -a.min(b))
}
