//! The answer about the depth of two solids.

use super::goal::Found;

/// Depth of the material that two solids share, as a proved interval, with a point that shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// Lower bound of the depth, in world units: the depth of `point`.
    pub lower: f64,
    /// Upper bound of the depth, in world units.
    pub upper: f64,
    /// A point in both solids, in the world frame, that has at least the depth `lower`. `None` if
    /// `lower` is zero.
    pub point: Option<[f64; 3]>,
    /// Whether the bounds are proved. They are not if a solid is open: its inside is then known
    /// only where its winding number was computed.
    pub is_proved: bool,
}

impl Depth {
    /// The depth of two solids that have no common point.
    pub(super) const NONE: Self = Self { lower: 0.0, upper: 0.0, point: None, is_proved: true };

    /// Returns the answer of a search, which is proved if both solids are closed.
    pub(super) fn new(found: Found, is_proved: bool) -> Self {
        Self { lower: found.lower, upper: found.upper, point: found.point, is_proved }
    }
}
