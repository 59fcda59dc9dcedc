//! One pose of a rig.

use super::skeleton::PlacedBone;
use super::transform::Transform;

/// The positions of the bones of a rig, and the weights of its morph targets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigPose {
    pub(super) locals: Vec<Transform>,
    pub(super) morph_weights: Vec<f64>,
    pub(super) bones: Vec<PlacedBone>,
}

impl RigPose {
    /// Returns the bones, placed in the world.
    #[must_use]
    pub fn bones(&self) -> &[PlacedBone] {
        &self.bones
    }

    /// Returns the weights of the morph targets.
    #[must_use]
    pub fn morph_weights(&self) -> &[f64] {
        &self.morph_weights
    }
}
