//! How much material two solids share.

/// Depth of the common material of two solids, as an interval that holds the true depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// Lower bound of the depth, in world units.
    pub lower: f64,
    /// Upper bound of the depth, in world units. Infinite if it was only proved that the depth
    /// exceeds a threshold.
    pub upper: f64,
    /// Point inside both solids whose depth is at least the lower bound, in the world frame.
    pub point: Option<[f64; 3]>,
}
