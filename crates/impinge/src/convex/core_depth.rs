//! What is proved of the depth of two cores.

/// What is proved of the cores, in the common unit; negative where they are apart.
pub(super) struct CoreDepth {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) direction: [f64; 3],
    pub(super) points: [[f64; 3]; 2],
}
