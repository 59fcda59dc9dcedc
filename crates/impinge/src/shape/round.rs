//! Support functions of the cores of ellipsoids and of tapered capsules. The largest entry of a
//! direction is ±1, so that squares of its entries do not overflow.

use crate::convex::Support;
use crate::math::vec3::dot;

/// The set whose sum with a ball is an ellipsoid about the origin, with its axes along the
/// coordinate axes. So an ellipsoid is swept by a ball as a capsule is, and two ellipsoids that are
/// not deeper in each other than their balls are solved by the distance of these sets.
///
/// The ball is as large as the least radius of curvature of the ellipsoid, so it rolls inside
/// everywhere, and the set is convex.
///
/// # Source
/// Blaschke, *Kreis und Kugel*, 1916, section 24: a ball rolls freely inside a convex body if its
/// radius is at most each radius of curvature.
///
/// # Accuracy
/// A point is off by 10.4 u of the half-axis on each axis (u = 2^-53). The reach is half as large
/// again, so this is within the 8 u that [`Support::support`] allows (docs/notes/proof.md, L36).
#[derive(Debug)]
pub(super) struct ErodedEllipsoid {
    half_axes: [f64; 3],
    ball: f64,
}

impl ErodedEllipsoid {
    /// Returns the set for the half-axes of an ellipsoid, and the radius of the ball.
    pub(super) fn of(half_axes: [f64; 3]) -> (Self, f64) {
        let [least, greatest] = [half_axes.into_iter().fold(f64::INFINITY, f64::min), greatest(&half_axes)];
        // The least radius of curvature is at the ends of the longest axis. It is rounded down.
        let ball = if greatest > 0.0 { least * (least / greatest) * (1.0 - 4.0 * f64::EPSILON) } else { 0.0 };
        (Self { half_axes, ball }, ball)
    }
}

impl Support for ErodedEllipsoid {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        // The ellipsoid is the image of the unit sphere under a stretch. Its support point is the
        // image of the sphere's point along the stretched direction.
        let greatest = greatest(&self.half_axes);
        let stretched: [f64; 3] = std::array::from_fn(|k| self.half_axes[k] / greatest * direction[k]);
        let length = dot(&stretched, &stretched).sqrt();
        if length > 0.0 {
            let back = self.ball / dot(&direction, &direction).sqrt();
            std::array::from_fn(|k| self.half_axes[k] * (stretched[k] / length) - back * direction[k])
        } else {
            [0.0; 3]
        }
    }

    fn reach(&self) -> [f64; 3] {
        self.half_axes.map(|half_axis| 1.5 * half_axis)
    }
}

fn greatest(half_axes: &[f64; 3]) -> f64 {
    half_axes.iter().copied().fold(0.0, f64::max)
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
