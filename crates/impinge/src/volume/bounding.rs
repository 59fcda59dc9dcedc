//! The operations that every bounding volume has, for generic code such as trees over volumes,
//! comparisons and property tests.

use crate::input::InputError;
use crate::math::Pose;

/// A bounding volume: never empty, always finite, and never smaller than the input it was made
/// from. Points and volumes of one call are in one frame and unit, which the caller chooses.
pub trait BoundingVolume: Copy + PartialEq + std::fmt::Debug + Send + Sync {
    /// Returns the volume that encloses the points, built by the default construction of its kind.
    ///
    /// # Errors
    /// Returns [`Empty`](crate::input::InputErrorKind::Empty) if there are no points. Returns
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite) if a coordinate is not finite, and
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) if its magnitude is 2^128 or more,
    /// with the index of the first such vertex.
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError>;

    /// Reports whether the two volumes may overlap: `false` is returned only if they are proved
    /// apart. Touching volumes overlap.
    fn overlaps(&self, other: &Self) -> bool;

    /// Reports whether the point may be inside: `false` is returned only if it is proved outside.
    /// The boundary counts as inside. The point must be finite; otherwise the answer means nothing.
    fn contains(&self, point: [f64; 3]) -> bool;

    /// Returns a volume of the same kind that encloses both.
    #[must_use]
    fn merged(&self, other: &Self) -> Self;

    /// Returns a volume of the same kind, in the world frame, that encloses the image of this one
    /// under the pose.
    ///
    /// # Errors
    /// Returns [`NotRigid`](crate::input::InputErrorKind::NotRigid) if this kind of volume supports
    /// only rigid motions and the pose is not rigid within 1e-4. Returns
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) if the image exceeds 2^320.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError>;

    /// Returns the enclosed volume in cubic units, rounded.
    fn volume(&self) -> f64;

    /// Returns the surface area in square units, rounded. For a flat volume both sides count.
    fn surface_area(&self) -> f64;
}
