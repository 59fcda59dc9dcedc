//! Implements [`BoundingVolume`] for capsules.

use std::f64::consts::PI;

use crate::input::InputError;
use crate::math::Pose;
use crate::math::vec3::squared_distance;
use crate::volume::capsule::{Capsule, length};
use crate::volume::core::closest_points;
use crate::volume::rigid::{image, stretch};
use crate::volume::rounding::{add_up, mul_up};
use crate::volume::{BoundingSphere, BoundingVolume, Round, fit};

impl BoundingVolume for Capsule {
    /// Uses [`fit::capsule`].
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::capsule(points)
    }

    fn overlaps(&self, other: &Self) -> bool {
        // Shortcut: for clearly overlapping capsules the proved bounds give the same answer and
        // cost more.
        let (p, q) = closest_points(&self.core(), &other.core());
        let sum = self.radius + other.radius;
        squared_distance(&p, &q) <= 0.99 * sum * sum || self.meets(other)
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        self.meets(&BoundingSphere::from_valid(point, 0.0))
    }

    /// Returns the smallest of the capsules whose segment joins two of the four ends.
    fn merged(&self, other: &Self) -> Self {
        let mut spheres = [
            (self.ends[0], self.radius),
            (self.ends[1], self.radius),
            (other.ends[0], other.radius),
            (other.ends[1], other.radius),
        ];
        // A fixed order, so swapping the two capsules changes no bit.
        spheres.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let pairs = (0..4).flat_map(|i| (i + 1..4).map(move |j| [i, j]));
        let candidates = pairs.map(|pair| Self::about(pair.map(|i| spheres[i].0), &spheres));
        candidates.min_by(|a, b| a.volume().total_cmp(&b.volume())).unwrap_or(*self)
    }

    /// Accepts poses that are rigid within 1e-4.
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
