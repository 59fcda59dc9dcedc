//! Support functions of ellipsoids and of the cores of tapered capsules. The largest entry of a
//! direction is ±1, so that squares of its entries do not overflow.

use crate::convex::Support;
use crate::math::vec3::dot;

/// An ellipsoid about the origin, with its axes along the coordinate axes.
#[derive(Debug)]
pub(super) struct Ellipsoid {
    pub(super) half_axes: [f64; 3],
}

impl Support for Ellipsoid {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        // The ellipsoid is the image of the unit sphere under a stretch. Its support point is the
        // image of the sphere's point along the stretched direction.
        let greatest = self.half_axes.into_iter().fold(0.0, f64::max);
        let stretched: [f64; 3] = std::array::from_fn(|k| self.half_axes[k] / greatest * direction[k]);
        let length = stretched.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 { std::array::from_fn(|k| self.half_axes[k] * (stretched[k] / length)) } else { [0.0; 3] }
    }

    fn reach(&self) -> [f64; 3] {
        self.half_axes
    }
}

/// The convex hull of a sphere and a point: a tapered capsule without the radius of its smaller
/// end.
///
/// # Accuracy
/// With u = 2^-53, a point of the sphere is off by 5.5 u of the reach on each axis, and a height by
/// 4 u. The radius is a difference of two radii, off by 1 u. So the point and its height are within
/// the 8 u that [`Support::support`] allows (docs/notes/proof.md, L36).
#[derive(Debug)]
pub(super) struct Tapered {
    pub(super) center: [f64; 3],
    pub(super) radius: f64,
    pub(super) tip: [f64; 3],
}

impl Support for Tapered {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let length = dot(&direction, &direction).sqrt();
        if dot(&direction, &self.tip) > dot(&direction, &self.center) + self.radius * length {
            return self.tip;
        }
        let out = if length > 0.0 { self.radius / length } else { 0.0 };
        std::array::from_fn(|k| self.center[k] + out * direction[k])
    }

    fn reach(&self) -> [f64; 3] {
        // One step covers the rounding of the sum, here and in the support.
        std::array::from_fn(|k| (self.center[k].abs() + self.radius).next_up().max(self.tip[k].abs()))
    }
}
