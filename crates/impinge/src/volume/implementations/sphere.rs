//! Implements [`BoundingVolume`] for spheres.

use crate::input::InputError;
use crate::math::{Pose, Sign};
use crate::volume::rigid::{image, stretch};
use crate::volume::rounding::{add_up, distance_up, mul_up};
use crate::volume::sphere::{BoundingSphere, distance_against};
use crate::volume::{BoundingVolume, fit};

impl BoundingVolume for BoundingSphere {
    /// Uses [`fit::minimal_sphere`].
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::minimal_sphere(points).map(|fitted| fitted.sphere)
    }

    /// Reports whether the spheres overlap, exactly. Algorithm 2.3 of the *Notes* compares with the
    /// difference of the radii, which is wrong; the sum is right.
    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        distance_against(self.center, other.center, self.radius, other.radius) != Sign::Positive
    }

    /// Reports whether the point is inside, exactly for a point within the range of 2^320.
    fn contains(&self, point: [f64; 3]) -> bool {
        distance_against(self.center, point, self.radius, 0.0) != Sign::Positive
    }

    /// Returns the smallest sphere that encloses both, up to rounding: one of them, or the one
    /// through both far poles.
    fn merged(&self, other: &Self) -> Self {
        if self.encloses(other) {
            return *self;
        }
        if other.encloses(self) {
            return *other;
        }
        // A fixed order, so swapping the two spheres changes no bit.
        let (a, b) =
            if (self.center, self.radius) <= (other.center, other.radius) { (self, other) } else { (other, self) };
        let between: [f64; 3] = std::array::from_fn(|axis| b.center[axis] - a.center[axis]);
        let distance = distance_up(a.center, b.center);
        let share = (0.5 * (distance + b.radius - a.radius) / distance).clamp(0.0, 1.0);
        let center: [f64; 3] = std::array::from_fn(|axis| a.center[axis] + share * between[axis]);
        let reach = |part: &Self| add_up(distance_up(center, part.center), part.radius);
        Self { center, radius: reach(a).max(reach(b)) }
    }

    /// Accepts poses that are rigid within 1e-4. The radius grows by the bound of the pose's
    /// stretch and by the rounding error of the center. If both are exact it does not grow.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let stretch = stretch(world_from_local)?;
        let (center, off) = image(world_from_local, self.center);
        Self::new(center, add_up(mul_up(self.radius, stretch), off))
    }

    fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius * self.radius * self.radius
    }

    fn surface_area(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius * self.radius
    }
}
