//! One pose of a rig.

use super::skeleton::PlacedBone;
use super::transform::Transform;

/// Where the bones of a rig are, and how its morph targets are weighed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigPose {
    pub(super) locals: Vec<Transform>,
    pub(super) morph_weights: Vec<f64>,
    pub(super) bones: Vec<PlacedBone>,
}

impl RigPose {
    /// The bones in the world.
    #[must_use]
    pub fn bones(&self) -> &[PlacedBone] {
        &self.bones
    }

    /// The weights of the morph targets.
    #[must_use]
    pub fn morph_weights(&self) -> &[f64] {
        &self.morph_weights
    }
}
