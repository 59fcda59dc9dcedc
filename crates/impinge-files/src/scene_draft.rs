//! What a reader finds in a scene, before parts have unique names and keys.

use impinge::Pose;

use crate::{model::Warnings, scene_model::SceneMesh, unit::Unit};

/// The meshes and parts of a file, in the frame of the scene.
pub(crate) struct Draft {
    pub(crate) meshes: Vec<SceneMesh>,
    pub(crate) parts: Vec<PartDraft>,
    pub(crate) unit: Option<Unit>,
    pub(crate) warnings: Warnings,
}

/// A part as the file describes it.
pub(crate) struct PartDraft {
    /// Name of the part in the file; empty if the file gives none.
    pub(crate) title: String,
    /// Names of the groups that contain the part, the outermost first.
    pub(crate) path: Vec<String>,
    /// Properties of the part, in the order of the file.
    pub(crate) extras: Vec<(String, String)>,
    /// Index of the mesh, which has triangles.
    pub(crate) mesh: usize,
    pub(crate) world_from_part: Pose,
}
