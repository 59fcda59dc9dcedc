//! The proved bounds on the depth of two cores.

/// Bounds on the depth of two cores, in the common unit, with a direction and the two points in the
/// common frame. The depth is negative if the cores are apart.
pub(super) struct CoreDepth {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) direction: [f64; 3],
    pub(super) points: [[f64; 3]; 2],
}
