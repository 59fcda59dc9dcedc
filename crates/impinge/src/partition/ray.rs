//! Rays against boxes.

use crate::input::{InputError, InputErrorKind};
use crate::volume::MinMax;

/// What is at `origin + t direction` for t from 0 to a reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: [f64; 3],
    direction: [f64; 3],
    reach: f64,
}

/// The least direction: 2^-600 along its longest axis, so that no way through a box overflows.
const LEAST_DIRECTION: f64 = f64::from_bits((1023 - 600) << 52);

/// Of a quotient of a difference, which is twice rounded by 2^-53; this covers the product with it, too.
const ROUNDING: f64 = 1.0 / (1_u64 << 51) as f64;

impl Ray {
    /// The ray from `origin` along `direction`, of any length, as far as `reach` times that.
    ///
    /// # Errors
    /// [`NonFinite`](InputErrorKind::NonFinite) and [`OutOfRange`](InputErrorKind::OutOfRange) (beyond 2^300) for `"ray
    /// origin"` 0 and `"ray direction"` 0; [`ZeroDirection`](InputErrorKind::ZeroDirection) where no component is at least
    /// 2^-600; [`NonFinite`](InputErrorKind::NonFinite) for a `"ray reach"` that is NaN and
    /// [`Negative`](InputErrorKind::Negative) for one below zero; it may be infinite.
    pub fn new(origin: [f64; 3], direction: [f64; 3], reach: f64) -> Result<Self, InputError> {
        InputError::judge_row(&origin, "ray origin", 0)?;
        InputError::judge_row(&direction, "ray direction", 0)?;
        if direction.iter().all(|d| d.abs() < LEAST_DIRECTION) {
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

    /// Where it starts.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Where it goes, for each unit of t.
    #[must_use]
    pub fn direction(&self) -> [f64; 3] {
        self.direction
    }

    /// The greatest t.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Where it enters the closed box, not below zero; none where it is proved to miss.
    ///
    /// # Accuracy
    /// Conservative: never none for a ray that meets the box, and t never later than the true one. Both are off by
    /// 2^-50 of themselves at most, so that a box may count as met which the ray passes closer than that. A box that
    /// holds another is never met later.
    ///
    /// # Source
    /// Ize, *Robust BVH ray traversal*, JCGT 2(2), 2013; ours divides, where zeros are asked apart, so that no NaN arises,
    /// and widens both ends.
    #[inline]
    #[must_use]
    pub fn enters(&self, bounds: &MinMax) -> Option<f64> {
        self.through(bounds).map(|[enter, _]| enter).filter(|&enter| enter <= self.reach)
    }

    /// Where it enters and leaves the box, its reach aside.
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
        // Quotients too small for a float are off by less than the least normal number.
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
    fn what_is_no_ray_is_refused() {
        let kind = |origin, direction, reach| Ray::new(origin, direction, reach).unwrap_err().kind().clone();
        assert_eq!(kind([0.0; 3], [0.0, -0.0, 1e-200], 1.0), InputErrorKind::ZeroDirection { index: 0 });
        assert_eq!(kind([0.0; 3], [1.0; 3], f64::NAN), InputErrorKind::NonFinite { what: "ray reach", index: 0 });
        assert_eq!(kind([0.0; 3], [1.0; 3], -1.0), InputErrorKind::Negative { what: "ray reach", index: 0 });
        assert_eq!(kind([f64::NAN; 3], [1.0; 3], 1.0), InputErrorKind::NonFinite { what: "ray origin", index: 0 });
    }
}
