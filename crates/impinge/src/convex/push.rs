//! The height of the set of differences along a direction: how far the second core must move along
//! it to be beyond the first one.

use super::interval::above;
use super::posed::{Difference, Pair};
use crate::math::vec3::{dot, length};

/// The farthest difference along a direction, and an upper bound on the height of all differences
/// along it.
pub(super) struct Push {
    pub(super) farthest: Difference,
    pub(super) height: f64,
}

impl Push {
    pub(super) fn along(pair: &Pair<'_>, direction: [f64; 3]) -> Self {
        let farthest = pair.support(direction);
        let height = dot(&direction, &farthest.a.point) - dot(&direction, &farthest.b.point);
        Self { farthest, height: above((height + pair.height_error(direction)) / length(&direction)) }
    }
}
