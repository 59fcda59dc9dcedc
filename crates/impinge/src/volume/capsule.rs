//! The capsule: a segment swept by a sphere (*Notes*, 2.3 and 3; Ericson 4.5).

use std::f64::consts::PI;

use super::core::{Core, closest_points, squared_distance, subtract};
use super::fit;
use super::min_max::{in_range, lengths_in_range};
use super::rigid::{image, stretch};
use super::rounding::{add_up, mul_up};
use super::{BoundingSphere, BoundingVolume, Round, round};
use crate::input::InputError;
use crate::math::Pose;

/// The points within `radius` of the segment between two ends, which may be one point.
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
    ends: [[f64; 3]; 2],
    radius: f64,
}

const _: () = assert!(size_of::<Capsule>() == 56);

impl Capsule {
    /// The capsule between two ends.
    ///
    /// # Errors
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite), [`OutOfRange`](crate::input::InputErrorKind::OutOfRange)
    /// (beyond 2^320), [`Negative`](crate::input::InputErrorKind::Negative) for the radius.
    pub fn new(start: [f64; 3], end: [f64; 3], radius: f64) -> Result<Self, InputError> {
        in_range("capsule end", start.into_iter().chain(end))?;
        lengths_in_range("radius", [radius])?;
        Ok(Self { ends: [start, end], radius })
    }

    /// From numbers that are known to be in range.
    pub(super) fn from_valid(ends: [[f64; 3]; 2], radius: f64) -> Self {
        Self { ends, radius }
    }

    /// The ends of the segment.
    #[must_use]
    pub fn ends(&self) -> [[f64; 3]; 2] {
        self.ends
    }

    /// The radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The segment; its edge is the rounded difference of the ends, which the bounds of [`round`] count.
    pub(super) fn core(&self) -> Core {
        Core { corner: self.ends[0], edges: [subtract(self.ends[1], self.ends[0]), [0.0; 3]], dimension: 1 }
    }

    /// The capsule about a segment that holds spheres, given as centres and radii.
    fn about(ends: [[f64; 3]; 2], spheres: &[([f64; 3], f64)]) -> Self {
        let core = Self { ends, radius: 0.0 }.core();
        let reach = |&(centre, radius): &([f64; 3], f64)| add_up(round::distance_to_core(centre, &core), radius);
        Self { ends, radius: spheres.iter().map(reach).fold(0.0, f64::max) }
    }
}

impl BoundingVolume for Capsule {
    /// By [`fit::capsule`].
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::capsule(points)
    }

    fn overlaps(&self, other: &Self) -> bool {
        // A quick yes: the bounds below say the same of what is clearly closer, and cost more.
        let (p, q) = closest_points(&self.core(), &other.core());
        let sum = self.radius + other.radius;
        squared_distance(p, q) <= 0.99 * sum * sum || self.meets(other)
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        self.meets(&BoundingSphere::from_valid(point, 0.0))
    }

    /// The smallest of the capsules whose ends are two of the four.
    fn merged(&self, other: &Self) -> Self {
        let mut spheres = [
            (self.ends[0], self.radius),
            (self.ends[1], self.radius),
            (other.ends[0], other.radius),
            (other.ends[1], other.radius),
        ];
        // In one order, so that swapping the two changes no bit.
        spheres.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let pairs = (0..4).flat_map(|i| (i + 1..4).map(move |j| [i, j]));
        let candidates = pairs.map(|pair| Self::about(pair.map(|i| spheres[i].0), &spheres));
        candidates.min_by(|a, b| a.volume().total_cmp(&b.volume())).unwrap_or(*self)
    }

    /// A rigid motion within 1e-4.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let stretch = stretch(world_from_local)?;
        let [(start, off_start), (end, off_end)] = self.ends.map(|end| image(world_from_local, end));
        Self::new(start, end, add_up(mul_up(self.radius, stretch), off_start.max(off_end)))
    }

    fn volume(&self) -> f64 {
        PI * self.radius * self.radius * (length(self) + 4.0 / 3.0 * self.radius)
    }

    fn surface_area(&self) -> f64 {
        2.0 * PI * self.radius * (length(self) + 2.0 * self.radius)
    }
}

fn length(capsule: &Capsule) -> f64 {
    squared_distance(capsule.ends[0], capsule.ends[1]).sqrt()
}
