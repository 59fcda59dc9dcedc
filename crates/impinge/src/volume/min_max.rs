//! The axis-aligned box as its smallest and largest corner, in double precision (*Notes*, 2.1,
//! listing 2.1).
//!
//! Tests: `tests/it/volumes/boxes.rs`. Benchmark: `box_forms`.

use super::rounding::{LIMIT, add_down, add_up, f32_down, f32_up, mul_down, mul_up};
use super::{Aabb, BoundingVolume};
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;

/// The closed box between two corners. It is never empty.
///
/// This form has the fastest test, six comparisons, and is the only one in which every operation
/// but moving is exact.
///
/// ```
/// use impinge::volume::{BoundingVolume, MinMax};
/// let a = MinMax::new([0.0; 3], [1.0; 3])?;
/// let b = MinMax::new([1.0, 0.0, 0.0], [2.0; 3])?;
/// assert!(a.overlaps(&b)); // they share a face
/// assert_eq!(a.merged(&b).max(), [2.0; 3]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinMax {
    min: [f64; 3],
    max: [f64; 3],
}

const _: () = assert!(size_of::<MinMax>() == 48);

impl MinMax {
    /// Builds the box between two corners.
    ///
    /// # Errors
    /// Returns [`NonFinite`](InputErrorKind::NonFinite) or
    /// [`OutOfRange`](InputErrorKind::OutOfRange) (beyond 2^320) with the index of the coordinate;
    /// those of `max` count from 3. Returns [`Negative`](InputErrorKind::Negative) with the axis on
    /// which `min` exceeds `max`.
    #[inline]
    pub fn new(min: [f64; 3], max: [f64; 3]) -> Result<Self, InputError> {
        // Valid boxes pass without a branch per axis, because worlds build many boxes. NaN fails
        // the comparisons.
        if (0..3).fold(true, |is_box, k| is_box & (-LIMIT <= min[k]) & (min[k] <= max[k]) & (max[k] <= LIMIT)) {
            return Ok(Self { min, max });
        }
        Err(Self::defect_of(min, max))
    }

    /// Returns the reason why two corners have no box between them.
    #[cold]
    fn defect_of(min: [f64; 3], max: [f64; 3]) -> InputError {
        let index = (0..3).find(|&axis| min[axis] > max[axis]).unwrap_or(0);
        let of_extent = || InputError::new(InputErrorKind::Negative { what: "box extent", index });
        in_range("box coordinate", min.into_iter().chain(max)).err().unwrap_or_else(of_extent)
    }

    /// Converts a box from single precision, exactly. Returns `None` if it is empty or not finite.
    #[must_use]
    pub fn from_aabb(aabb: &Aabb) -> Option<Self> {
        Self::new(aabb.min.map(f64::from), aabb.max.map(f64::from)).ok()
    }

    /// Returns the smallest single-precision box that holds this one. A bound that would have to
    /// lie beyond single precision becomes infinite.
    #[must_use]
    pub fn to_aabb(&self) -> Aabb {
        Aabb { min: self.min.map(f32_down), max: self.max.map(f32_up) }
    }

    /// Builds the box between corners that are known to be ordered and finite.
    pub(crate) const fn from_ordered(min: [f64; 3], max: [f64; 3]) -> Self {
        Self { min, max }
    }

    /// Returns the box grown by a length on every side, rounded outward. Returns `None` if no valid
    /// box is that large.
    pub(crate) fn grown(&self, by: f64) -> Option<Self> {
        let (min, max) = (self.min.map(|x| (x - by).next_down()), self.max.map(|x| (x + by).next_up()));
        Self::new(min, max).ok()
    }

    /// Returns the smallest coordinate on each axis.
    #[must_use]
    pub fn min(&self) -> [f64; 3] {
        self.min
    }

    /// Returns the smallest and the largest coordinate on an axis.
    #[inline]
    pub(crate) fn ends(&self, axis: usize) -> [f64; 2] {
        [self.min[axis], self.max[axis]]
    }

    /// Returns the largest coordinate on each axis.
    #[must_use]
    pub fn max(&self) -> [f64; 3] {
        self.max
    }

    /// Reports whether every point of the other box is in this one, exactly.
    #[must_use]
    pub fn encloses(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.min[axis] && other.max[axis] <= self.max[axis])
    }
}

impl BoundingVolume for MinMax {
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        Self::of(points)
    }

    /// Reports whether the boxes overlap, exactly (*Notes*, algorithm 2.1).
    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }

    /// Reports whether the point is inside, exactly.
    fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|axis| self.min[axis] <= point[axis] && point[axis] <= self.max[axis])
    }

    /// Returns the smallest box that holds both, exactly.
    fn merged(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Returns the smallest box of the image, with every sum and product rounded outward. It
    /// accepts any affine map and is exact if no sum or product rounds.
    ///
    /// # Source
    /// Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems 1990. Example 2.2.3 of the
    /// *Notes* uses x in all three terms, which is wrong: term j takes coordinate j.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let (linear, translation) = (world_from_local.linear(), world_from_local.translation());
        let (mut min, mut max) = (*translation, *translation);
        for axis in 0..3 {
            for from in 0..3 {
                let entry = linear[axis][from];
                let (low, high) =
                    if entry < 0.0 { (self.max[from], self.min[from]) } else { (self.min[from], self.max[from]) };
                min[axis] = add_down(min[axis], mul_down(entry, low));
                max[axis] = add_up(max[axis], mul_up(entry, high));
            }
        }
        Self::new(min, max)
    }

    fn volume(&self) -> f64 {
        let [x, y, z] = extents(self);
        x * y * z
    }

    fn surface_area(&self) -> f64 {
        let [x, y, z] = extents(self);
        2.0 * (x * y + y * z + z * x)
    }
}

fn extents(bounds: &MinMax) -> [f64; 3] {
    std::array::from_fn(|axis| bounds.max[axis] - bounds.min[axis])
}

/// Checks that all numbers are finite and within [`LIMIT`]. `what` names them in the error.
///
/// # Errors
/// Returns an error with the index of the first invalid number.
pub(super) fn in_range(what: &'static str, numbers: impl IntoIterator<Item = f64>) -> Result<(), InputError> {
    for (index, number) in numbers.into_iter().enumerate() {
        if !number.is_finite() {
            return Err(InputError::new(InputErrorKind::NonFinite { what, index }));
        }
        if number.abs() > LIMIT {
            return Err(InputError::new(InputErrorKind::OutOfRange { what, index, limit: "2^320" }));
        }
    }
    Ok(())
}

/// Checks that all lengths are finite, within [`LIMIT`] and not negative. `what` names them in the
/// error.
///
/// # Errors
/// Returns an error with the index of the first invalid length.
pub(super) fn lengths_in_range<const N: usize>(what: &'static str, lengths: [f64; N]) -> Result<(), InputError> {
    in_range(what, lengths)?;
    match lengths.iter().position(|&length| length < 0.0) {
        Some(index) => Err(InputError::new(InputErrorKind::Negative { what, index })),
        None => Ok(()),
    }
}
