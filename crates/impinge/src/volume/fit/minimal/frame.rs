//! The frame in which minimal spheres are computed.

use super::super::enclosing::{scaled_offset, squared, unit_scale};
use crate::volume::MinMax;

/// A frame in which the points have a size of about 1: an origin, and a scale that is a power of
/// two.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) origin: [f64; 3],
    pub(super) scale: f64,
}

impl Frame {
    pub(super) fn of(bounds: &MinMax) -> Self {
        let (min, max) = (bounds.min(), bounds.max());
        Self { origin: std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]), scale: unit_scale(bounds) }
    }

    #[inline(always)]
    pub(super) fn local(&self, point: [f64; 3]) -> [f64; 3] {
        scaled_offset(point, self.origin, self.scale)
    }

    #[inline(always)]
    pub(super) fn squared_distance(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        squared(scaled_offset(p, q, self.scale))
    }
}
