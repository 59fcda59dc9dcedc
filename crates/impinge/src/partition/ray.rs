//! Rays and their intersection with boxes.

use crate::input::{InputError, InputErrorKind};
use crate::volume::MinMax;

/// A ray: the points `origin + t * direction` for `t` from 0 to `reach`, in the frame of the boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: [f64; 3],
    direction: [f64; 3],
    reach: f64,
}

/// Minimum magnitude of the largest component of a direction: 2^-600. With it no ray parameter at a
/// box overflows.
const MIN_DIRECTION: f64 = f64::from_bits((1023 - 600) << 52);

/// Bound on the relative error of a ray parameter: a difference and a quotient, each rounded by at
/// most 2^-53, and the product with `1 ± ROUNDING` itself.
const ROUNDING: f64 = 1.0 / (1_u64 << 51) as f64;

impl Ray {
    /// Returns the ray from `origin` along `direction` that ends at `origin + reach * direction`.
    /// Both are in the frame of the boxes. The direction may have any length, and `reach` may be
    /// infinite.
    ///
    /// # Errors
    /// Returns [`NonFinite`](InputErrorKind::NonFinite) or
    /// [`OutOfRange`](InputErrorKind::OutOfRange) (beyond 2^300) for an invalid `"ray origin"` or
    /// `"ray direction"`, with index 0. Returns [`ZeroDirection`](InputErrorKind::ZeroDirection) if
    /// no component of the direction is at least 2^-600 in magnitude. Returns
    /// [`NonFinite`](InputErrorKind::NonFinite) if the `"ray reach"` is NaN, and
    /// [`Negative`](InputErrorKind::Negative) if it is below zero.
    pub fn new(origin: [f64; 3], direction: [f64; 3], reach: f64) -> Result<Self, InputError> {
        InputError::validate_row(&origin, "ray origin", 0)?;
        InputError::validate_row(&direction, "ray direction", 0)?;
        if direction.iter().all(|d| d.abs() < MIN_DIRECTION) {
            return Err(InputError::new(InputErrorKind::ZeroDirection { index: 0 }));
        }
        if reach.is_nan() {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "ray reach", index: 0 }));
        }
        if reach < 0.0 {
            return Err(InputError::new(InputErrorKind::Negative { what: "ray reach", index: 0 }));
        }
        Ok(Self { origin, direction, reach })
    }

    /// Returns the point at which the ray starts, in the frame of the boxes.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the direction of the ray as given, in the frame of the boxes: the displacement per
    /// unit of `t`.
    #[must_use]
    pub fn direction(&self) -> [f64; 3] {
        self.direction
    }

    /// Returns the largest value of `t` on the ray, which may be infinite.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the point `origin + t * direction` in the frame of the boxes, rounded.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + t * self.direction[k])
    }

    /// Returns the parameter `t >= 0` at which the ray enters the closed box, zero if it starts
    /// inside. Returns `None` if the ray provably misses the box or ends before it.
    ///
    /// # Accuracy
    /// Conservative: it never returns `None` for a ray that hits the box, and `t` is never larger
    /// than the exact value. The computed ends of the interval have a relative error of at most
    /// 2^-50. So a box may be reported although the ray passes it at less than that distance. A box
    /// that contains another is never entered later.
    ///
    /// # Source
    /// Ize, *Robust BVH ray traversal*, JCGT 2(2), 2013. Ours divides instead of multiplying by
    /// reciprocals, handles zero components separately so that no NaN arises, and widens both ends
    /// of the interval.
    #[inline]
    #[must_use]
    pub fn enters(&self, bounds: &MinMax) -> Option<f64> {
        self.through(bounds).map(|[enter, _]| enter).filter(|&enter| enter <= self.reach)
    }

    /// Returns the parameters at which the ray enters and leaves the box, or `None` if it misses
    /// it. Ignores `reach`.
    #[inline]
    pub(crate) fn through(&self, bounds: &MinMax) -> Option<[f64; 2]> {
        let (min, max) = (bounds.min(), bounds.max());
        let (mut enter, mut leave) = (0.0_f64, f64::MAX);
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            if direction == 0.0 {
                if origin < min[axis] || origin > max[axis] {
                    return None;
                }
                continue;
            }
            let (near, far) = if direction > 0.0 { (min[axis], max[axis]) } else { (max[axis], min[axis]) };
            enter = enter.max((near - origin) / direction * (1.0 - ROUNDING));
            leave = leave.min((far - origin) / direction * (1.0 + ROUNDING));
        }
        // A quotient that underflows has an error below the smallest normal number.
        (enter <= leave + f64::MIN_POSITIVE).then_some([enter, leave])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(min: f64, max: f64) -> MinMax {
        MinMax::from_ordered([min; 3], [max; 3])
    }

    #[test]
    fn rays_enter_through_faces_edges_and_corners() {
        let ray = |origin, direction| Ray::new(origin, direction, f64::INFINITY).unwrap();
        let near = |found: Option<f64>, t: f64| found.is_some_and(|found| (found - t).abs() <= t * 1e-15);
        assert!(near(ray([-1.0, 0.5, 0.5], [0.5, 0.0, 0.0]).enters(&cube(0.0, 1.0)), 2.0));
        assert!(near(ray([-1.0; 3], [1.0; 3]).enters(&cube(0.0, 1.0)), 1.0));
        assert!(near(ray([-1.0, 2.0, 0.0], [1.0, -1.0, 0.0]).enters(&cube(0.0, 1.0)), 1.0), "through an edge");
        assert_eq!(ray([0.5; 3], [-1.0, 0.0, 0.0]).enters(&cube(0.0, 1.0)), Some(0.0));
        assert_eq!(ray([-1.0, 1.5, 0.5], [1.0, 0.0, 0.0]).enters(&cube(0.0, 1.0)), None);
        assert_eq!(ray([2.0, 0.5, 0.5], [1.0, 0.0, 0.0]).enters(&cube(0.0, 1.0)), None, "behind");
        let far = f64::from_bits((1023 + 299) << 52);
        let slow = f64::from_bits((1023 - 600) << 52);
        assert!(ray([0.0; 3], [slow, 0.0, 0.0]).enters(&MinMax::from_ordered([far; 3], [far; 3])).is_none());
        assert!(ray([0.0; 3], [slow; 3]).enters(&MinMax::from_ordered([far; 3], [far; 3])).is_some());
    }

    #[test]
    fn invalid_rays_are_rejected() {
        let kind = |origin, direction, reach| Ray::new(origin, direction, reach).unwrap_err().kind().clone();
        assert_eq!(kind([0.0; 3], [0.0, -0.0, 1e-200], 1.0), InputErrorKind::ZeroDirection { index: 0 });
        assert_eq!(kind([0.0; 3], [1.0; 3], f64::NAN), InputErrorKind::NonFinite { what: "ray reach", index: 0 });
        assert_eq!(kind([0.0; 3], [1.0; 3], -1.0), InputErrorKind::Negative { what: "ray reach", index: 0 });
        assert_eq!(kind([f64::NAN; 3], [1.0; 3], 1.0), InputErrorKind::NonFinite { what: "ray origin", index: 0 });
    }
}
