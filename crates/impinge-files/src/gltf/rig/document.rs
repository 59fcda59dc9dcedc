//! The fields of a glTF document that make a mesh a character: skins, weights, morph targets and
//! animations. They are parsed only if a rig is requested, so errors in them do not keep a mesh
//! from being loaded.

use serde::Deserialize;

#[derive(Deserialize)]
pub(super) struct RigDocument {
    #[serde(default)]
    pub(super) nodes: Vec<RigNode>,
    #[serde(default)]
    pub(super) meshes: Vec<RigMesh>,
    #[serde(default)]
    pub(super) skins: Vec<SkinEntry>,
    #[serde(default)]
    pub(super) animations: Vec<AnimationEntry>,
}

#[derive(Deserialize)]
pub(super) struct RigNode {
    pub(super) weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
pub(super) struct RigMesh {
    pub(super) weights: Option<Vec<f64>>,
    #[serde(default)]
    pub(super) primitives: Vec<RigPrimitive>,
}

#[derive(Deserialize)]
pub(super) struct RigPrimitive {
    pub(super) attributes: RigAttributes,
    #[serde(default)]
    pub(super) targets: Vec<MorphTarget>,
}

/// Up to 16 joints per vertex, in sets of four.
#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct RigAttributes {
    joints_0: Option<u32>,
    joints_1: Option<u32>,
    joints_2: Option<u32>,
    joints_3: Option<u32>,
    weights_0: Option<u32>,
    weights_1: Option<u32>,
    weights_2: Option<u32>,
    weights_3: Option<u32>,
}

impl RigAttributes {
    /// Returns the accessors of joints and weights of each set.
    pub(super) fn sets(&self) -> [(Option<u32>, Option<u32>); 4] {
        [
            (self.joints_0, self.weights_0),
            (self.joints_1, self.weights_1),
            (self.joints_2, self.weights_2),
            (self.joints_3, self.weights_3),
        ]
    }
}

#[derive(Deserialize)]
pub(super) struct MorphTarget {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SkinEntry {
    pub(super) inverse_bind_matrices: Option<u32>,
    pub(super) joints: Vec<u32>,
}

#[derive(Deserialize)]
pub(super) struct AnimationEntry {
    pub(super) name: Option<Box<str>>,
    #[serde(default)]
    pub(super) channels: Vec<ChannelEntry>,
    #[serde(default)]
    pub(super) samplers: Vec<SamplerEntry>,
}

#[derive(Deserialize)]
pub(super) struct ChannelEntry {
    pub(super) sampler: u32,
    pub(super) target: TargetEntry,
}

#[derive(Deserialize)]
pub(super) struct TargetEntry {
    pub(super) node: Option<u32>,
    pub(super) path: Box<str>,
}

#[derive(Deserialize)]
pub(super) struct SamplerEntry {
    pub(super) input: u32,
    pub(super) output: u32,
    pub(super) interpolation: Option<Box<str>>,
}
