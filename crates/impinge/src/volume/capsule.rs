//! The capsule: a segment swept by a sphere (*Notes*, 2.3 and 3; Ericson 4.5).

use super::core::Core;
use super::min_max::{in_range, lengths_in_range};
use super::round::sealed::Swept;
use super::round::{self, Round};
use super::rounding::add_up;
use crate::input::InputError;
use crate::math::vec3::{squared_distance, sub};

/// All points within `radius` of the segment between two ends. The ends may coincide, which makes a
/// sphere.
///
/// ```
/// use impinge::volume::{BoundingVolume, Capsule};
/// let limb = Capsule::new([0.0; 3], [0.0, 0.0, 1.0], 0.25)?;
/// let other = Capsule::new([0.5, -1.0, 0.5], [0.5, 1.0, 0.5], 0.25)?;
/// assert!(limb.overlaps(&other)); // they touch
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    pub(super) ends: [[f64; 3]; 2],
    pub(super) radius: f64,
}

const _: () = assert!(size_of::<Capsule>() == 56);

impl Capsule {
    /// Builds the capsule between two ends.
    ///
    /// # Errors
    /// Returns [`NonFinite`](crate::input::InputErrorKind::NonFinite) or
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) (beyond 2^320) for an invalid end
    /// or radius, and [`Negative`](crate::input::InputErrorKind::Negative) for a negative radius.
    pub fn new(start: [f64; 3], end: [f64; 3], radius: f64) -> Result<Self, InputError> {
        in_range("capsule end", start.into_iter().chain(end))?;
        lengths_in_range("radius", [radius])?;
        Ok(Self { ends: [start, end], radius })
    }

    /// Builds the capsule from numbers that are known to be valid.
    pub(super) fn from_valid(ends: [[f64; 3]; 2], radius: f64) -> Self {
        Self { ends, radius }
    }

    /// Returns the ends of the segment.
    #[must_use]
    pub fn ends(&self) -> [[f64; 3]; 2] {
        self.ends
    }

    /// Returns the radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the segment. Its edge is the rounded difference of the ends; the bounds of [`round`]
    /// account for that rounding.
    pub(super) fn core(&self) -> Core {
        Core { corner: self.ends[0], edges: [sub(&self.ends[1], &self.ends[0]), [0.0; 3]], dimension: 1 }
    }

    /// Returns the capsule around a segment that encloses the given spheres (centers and radii).
    pub(super) fn about(ends: [[f64; 3]; 2], spheres: &[([f64; 3], f64)]) -> Self {
        let core = Self { ends, radius: 0.0 }.core();
        let reach = |&(center, radius): &([f64; 3], f64)| add_up(round::distance_to_core(center, &core), radius);
        Self { ends, radius: spheres.iter().map(reach).fold(0.0, f64::max) }
    }
}

pub(super) fn length(capsule: &Capsule) -> f64 {
    squared_distance(&capsule.ends[0], &capsule.ends[1]).sqrt()
}

#[allow(private_interfaces, reason = "its members are for this module alone")]
impl Swept for Capsule {
    fn core(&self) -> Core {
        Self::core(self)
    }

    fn reach(&self) -> f64 {
        self.radius
    }
}

impl Round for Capsule {}
