//! What a report states about its scenes and its question.

use std::collections::HashMap;

use impinge::Mesh;
use impinge::clash::Rules;
use impinge::mesh::Repair;
use impinge::scene::{PartId, RepairedPart, Scene};
use rayon::prelude::*;
use serde::Serialize;

use crate::unit::Unit;

/// Everything that a report states beside its answer.
#[derive(Clone, Debug, Default)]
pub struct ReportAbout<'r> {
    /// Unit of all lengths; `None` if it is not known.
    pub unit: Option<Unit>,
    /// The scenes.
    pub scenes: Vec<SceneAbout>,
    /// The question.
    pub asked: Asked,
    /// The rules; `None` if there were none.
    pub rules: Option<&'r Rules>,
}

/// Description of a scene in a report.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SceneAbout {
    /// Label of the scene.
    pub label: String,
    /// Path of the file; absent if the scene did not come from a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Unit that the file states; absent if it states none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// Number of parts.
    pub parts: usize,
    /// Number of triangles of all parts.
    pub triangles: usize,
    /// Number of parts whose mesh is open.
    pub open: usize,
    /// Number of open parts that [`Scene::repair`] would change; absent if it would change none.
    #[serde(skip_serializing_if = "is_zero")]
    pub repairable: usize,
    /// Changes that a repair made; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repaired: Option<Repaired>,
    /// Lower and upper corner of the box around all parts; absent without bounded parts.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Point of the file that is the origin of the scene; absent if that is the origin of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<[f64; 3]>,
    /// Warnings of the reader.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// Numbers of changes that a repair of open parts made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Repaired {
    /// Number of parts that changed.
    pub parts: usize,
    /// Number of these parts that are closed now.
    pub closed: usize,
    /// Number of faces that were turned.
    pub turned_faces: usize,
    /// Number of vertices that were moved to another vertex.
    pub welded_vertices: usize,
}

impl Repaired {
    /// Counts the changes of [`Scene::repair`].
    #[must_use]
    pub fn of(parts: &[RepairedPart]) -> Self {
        let count = |of: fn(&Repair) -> &Vec<u32>| parts.iter().map(|part| of(&part.repair).len()).sum();
        Self {
            parts: parts.len(),
            closed: parts.iter().filter(|part| part.is_closed).count(),
            turned_faces: count(|repair| &repair.turned_faces),
            welded_vertices: count(|repair| &repair.welded_vertices),
        }
    }
}

/// The question of a search. What was not asked is absent. Lengths are in world units.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Asked {
    /// Depth up to which common material counts as contact, without the sag.
    pub tolerance: f64,
    /// Whether the tolerance is the default.
    #[serde(skip_serializing_if = "is_false")]
    pub default_tolerance: bool,
    /// Required gap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<f64>,
    /// Chordal error of tessellated surfaces. Twice the sag is added to each tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sag: Option<f64>,
    /// Whether contacts are listed.
    #[serde(skip_serializing_if = "is_false")]
    pub contacts: bool,
    /// Whether the volumes of common material are computed.
    #[serde(skip_serializing_if = "is_false")]
    pub volume: bool,
    /// Whether the intersection curves are traced.
    #[serde(skip_serializing_if = "is_false")]
    pub curves: bool,
    /// Whether only parts of different scenes are compared.
    #[serde(skip_serializing_if = "is_false")]
    pub between: bool,
    /// Path of the file of rules.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rules: Option<String>,
    /// Path of the previous report.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub previous: Option<String>,
    /// Path of the file of accepted clashes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accept: Option<String>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_false(value: &bool) -> bool {
    !value
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &usize) -> bool {
    *value == 0
}

impl SceneAbout {
    /// Counts the parts, the triangles and the open parts of a scene, and the parts that a repair
    /// would change, on all threads of the current rayon pool. Each mesh is examined once, however
    /// many parts share it.
    #[must_use]
    pub fn new(label: impl Into<String>, scene: &Scene) -> Self {
        let parts: Vec<PartId> = scene.parts().collect();
        let mesh_of = |part: PartId| scene.shape(part).as_mesh().map(|(mesh, _)| mesh);
        let mut uses: HashMap<*const [u32; 3], (&Mesh, usize)> = HashMap::new();
        for mesh in parts.iter().filter_map(|&part| mesh_of(part)) {
            uses.entry(mesh.faces().as_ptr()).or_insert((mesh, 0)).1 += 1;
        }
        let meshes: Vec<(&Mesh, usize)> = uses.into_values().collect();
        let open = meshes.par_iter().filter(|(mesh, _)| !mesh.is_closed()).map(|(_, uses)| uses).sum();
        let repairable = if open == 0 { 0 } else { scene.clone().repair().len() };
        let triangles = meshes.iter().map(|(mesh, uses)| mesh.faces().len() * uses).sum();
        let bounds = bounds_of(scene);
        Self { label: label.into(), parts: parts.len(), triangles, open, repairable, bounds, ..Self::default() }
    }
}

/// Returns the lower and upper corner of the box around all bounded parts of a scene, in the world
/// frame, or `None` if no part is bounded.
#[must_use]
pub fn bounds_of(scene: &Scene) -> Option<[[f64; 3]; 2]> {
    let bounds = |part: PartId| scene.shape(part).at(*scene.pose(part)).ok()?.bounds();
    scene.parts().filter_map(bounds).reduce(|[low, high], [min, max]| {
        [std::array::from_fn(|k| low[k].min(min[k])), std::array::from_fn(|k| high[k].max(max[k]))]
    })
}
