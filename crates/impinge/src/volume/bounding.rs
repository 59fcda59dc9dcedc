//! What every bounding volume can do, for code that wants any of them: trees over volumes, comparisons, laws.

use crate::input::InputError;
use crate::math::Pose;

/// A bounding volume: never empty, finite, and never smaller than what it was made from.
pub trait BoundingVolume: Copy + PartialEq + std::fmt::Debug + Send + Sync {
    /// The volume of these points, by the default construction of its kind.
    ///
    /// # Errors
    /// [`Empty`](crate::input::InputErrorKind::Empty) without points;
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite) and
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) name the first vertex that is not finite or not below
    /// 2^128.
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError>;

    /// Whether the two are not proved apart; touching counts.
    fn overlaps(&self, other: &Self) -> bool;

    /// Whether the point is not proved outside; the boundary counts as inside.
    fn contains(&self, point: [f64; 3]) -> bool;

    /// A volume of the same kind that holds both.
    #[must_use]
    fn merged(&self, other: &Self) -> Self;

    /// A volume of the same kind that holds the image.
    ///
    /// # Errors
    /// [`NotRigid`](crate::input::InputErrorKind::NotRigid) where the kind only stands rigid motions and the pose is none
    /// within 1e-4; [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) where the image leaves the range of 2^320.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError>;

    /// What it encloses, in cubic units, rounded.
    fn volume(&self) -> f64;

    /// The area of its surface, in square units, rounded; both sides of what is flat.
    fn surface_area(&self) -> f64;
}
