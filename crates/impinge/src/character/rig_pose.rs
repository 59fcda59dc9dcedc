//! One pose of a rig.

use super::skeleton::PlacedBone;
use super::transform::Transform;

/// The positions of the bones of a rig, and the weights of its morph targets. The default value has
/// no bones; [`Rig::pose_into`](super::Rig::pose_into) fills it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigPose {
    pub(super) locals: Vec<Transform>,
    pub(super) morph_weights: Vec<f64>,
    pub(super) bones: Vec<PlacedBone>,
}

impl RigPose {
    /// Returns the placement of each bone in the world, indexed like the bones of the skeleton.
    #[must_use]
    pub fn bones(&self) -> &[PlacedBone] {
        &self.bones
    }

    /// Returns the weight of each morph target, indexed like the morph targets of the skin.
    #[must_use]
    pub fn morph_weights(&self) -> &[f64] {
        &self.morph_weights
    }
}
