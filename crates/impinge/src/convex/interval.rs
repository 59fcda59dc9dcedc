//! Intervals that hold a distance, and the rounding of their ends.

use super::gjk::SLACK;
use crate::volume::Proximity;

/// Width of an interval, relative to its upper end, above which exact arithmetic narrows it: 2^-36.
/// Floats give a relative width of 2^-48 if the shapes are well apart, and 2^-36 at a gap of 2^-12
/// of their size.
pub(super) const EXACT_DISTANCE_WIDTH: f64 = f64::from_bits((1023 - 36) << 52);

/// Proved bounds on the distance of two shapes, in world units, with the nearest points in the
/// world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Separation {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) points: [[f64; 3]; 2],
    pub(crate) proximity: Proximity,
}

/// Returns a lower bound of the exact sum of a few numbers, given their rounded sum.
pub(super) fn below(sum: f64) -> f64 {
    sum - sum.abs() * SLACK
}

/// Returns an upper bound of the exact sum of a few numbers, given their rounded sum.
pub(super) fn above(sum: f64) -> f64 {
    sum + sum.abs() * SLACK
}
