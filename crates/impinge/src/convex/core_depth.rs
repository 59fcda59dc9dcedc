//! The proved bounds on the depth of two cores.

/// Bounds on the depth of two cores, with a direction of any length and the two points, all in the
/// common frame and unit. The depth is negative if the cores are apart.
pub(super) struct CoreDepth {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) direction: [f64; 3],
    pub(super) points: [[f64; 3]; 2],
}

impl CoreDepth {
    /// Returns the same depth with all lengths multiplied by a power of two.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            lower: self.lower * factor,
            upper: self.upper * factor,
            direction: self.direction,
            points: self.points.map(|point| point.map(|x| x * factor)),
        }
    }
}
