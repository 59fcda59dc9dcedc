//! Implements [`BoundingVolume`] for oriented boxes.

use crate::input::InputError;
use crate::math::Pose;
use crate::math::vec3::{cross, dot, sub};
use crate::volume::obb::{Generated, Obb, deviation, orthonormal};
use crate::volume::rigid::{direction, image};
use crate::volume::rounding::{HALF_ULP, add_up, mul_up};
use crate::volume::{BoundingVolume, fit};

impl BoundingVolume for Obb {
    /// Uses [`fit::obb`].
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::obb(points).map(|fitted| fitted.obb)
    }

    /// Separating axis test with the six face normals and the nine edge-cross axes. Each axis
    /// proves separation on its own, whatever its rounding.
    ///
    /// # Source
    /// Gottschalk, Lin and Manocha, *OBBTree*, 1996; Ericson 4.4.1. Both add a constant to the
    /// edge-cross axes if edges are nearly parallel; here each axis has its own error bound.
    fn overlaps(&self, other: &Self) -> bool {
        let between = sub(&other.center, &self.center);
        let sum = |v: [f64; 3]| v[0].abs() + v[1].abs() + v[2].abs();
        // Error bound: two roundings of a difference or product, three of each dot product, one of
        // its product with the half-extent, six of sums. That is 12 half units of |n|·size, with
        // components of the axes slightly above 1. 24 cover this as well.
        let size = sum(between) + sum(self.half_extents) + sum(other.half_extents);
        let error = 24.0 * HALF_ULP * size + f64::MIN_POSITIVE;
        let separates = |n: [f64; 3]| {
            let reach = |part: &Self| (0..3).map(|k| part.half_extents[k] * dot(&n, &part.axes[k]).abs()).sum::<f64>();
            dot(&n, &between).abs() - (reach(self) + reach(other)) > error * sum(n) + f64::MIN_POSITIVE
        };
        if self.axes.into_iter().chain(other.axes).any(separates) {
            return false;
        }
        let edges = self.axes.into_iter().flat_map(|a| other.axes.map(|b| cross(&a, &b)));
        !edges.into_iter().any(separates)
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        let offset = sub(&point, &self.center);
        let size = offset[0].abs() + offset[1].abs() + offset[2].abs();
        // The skew of the axes, at most 2^-40 and its square, plus eight roundings.
        let error = (2.0 * deviation(&self.axes) + 16.0 * HALF_ULP) * size + f64::MIN_POSITIVE;
        !(0..3).any(|k| dot(&self.axes[k], &offset).abs() - error > self.half_extents[k])
    }

    /// Returns the smaller of the two boxes that have the axes of one of the inputs.
    fn merged(&self, other: &Self) -> Self {
        let (first, second) = (
            Self::around(self.axes, &[self.generated(), other.generated()]),
            Self::around(other.axes, &[other.generated(), self.generated()]),
        );
        let key = |obb: &Self| (obb.volume(), obb.axes, obb.center);
        if key(&first) <= key(&second) { first } else { second }
    }

    /// Accepts any affine map. The axes are rotated and made orthonormal again; the half-extents
    /// cover the extent of the image along them.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let (center, center_error) = image(world_from_local, self.center);
        let turned = self.axes.map(|axis| direction(world_from_local, axis));
        let generators = turned.map(|(generator, _)| generator);
        let error = (0..3).fold(center_error, |error, k| add_up(error, mul_up(self.half_extents[k], turned[k].1)));
        let image = Generated { center, generators, half_extents: self.half_extents, error };
        let moved = Self::around(orthonormal(generators), &[image]);
        Self::new(moved.center, moved.axes, moved.half_extents)
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
