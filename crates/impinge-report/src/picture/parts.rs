//! The parts of scenes, with their surfaces in the world frame.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use impinge::clash::{Member, Side};
use impinge::scene::{PartId, Scene};
use impinge::{Mesh, Pose};

use super::bounds::{Bounds, triangles};
use super::sharp_edges::sharp_edges;
use super::vector::Vector;

/// Maximum number of faces of a mesh whose sharp edges are drawn. More take longer to find than to
/// draw, and their edges are closer than pixels.
const MAX_FACES: usize = 400_000;

/// All bounded parts of some scenes.
pub(super) struct Parts<'s> {
    all: Vec<Part<'s>>,
    /// Index of a part by label and handle.
    places: HashMap<(&'s str, PartId), usize>,
    /// Sharp edges of the meshes that were drawn, by the address of their faces.
    edges: Mutex<HashMap<usize, Edges>>,
}

/// Sharp edges in the frame of their mesh.
type Edges = Arc<Vec<[Vector; 2]>>;

/// A part at its pose.
#[derive(Clone, Copy)]
pub(super) struct Part<'s> {
    pub(super) bounds: Bounds,
    /// The mesh and its pose; `None` for a part of another shape, which is drawn as its box.
    pub(super) mesh: Option<(&'s Mesh, Pose)>,
}

impl<'s> Parts<'s> {
    pub(super) fn new(sides: &'s [Side<'s>]) -> Self {
        let mut parts = Self { all: Vec::new(), places: HashMap::new(), edges: Mutex::default() };
        for Side { label, scene } in sides {
            for part in scene.parts() {
                if let Some(placed) = Part::new(scene, part) {
                    parts.places.insert((label, part), parts.all.len());
                    parts.all.push(placed);
                }
            }
        }
        parts
    }

    /// Returns the index of the part that a report names, or `None` if it is unbounded.
    pub(super) fn find(&self, member: &Member) -> Option<usize> {
        self.places.get(&(member.scene.as_str(), member.part)).copied()
    }

    pub(super) fn get(&self, part: usize) -> &Part<'s> {
        &self.all[part]
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Part<'s>> {
        self.all.iter()
    }

    /// Returns the sharp edges of a part in the world frame.
    pub(super) fn edges(&self, part: &Part<'_>) -> Vec<[Vector; 2]> {
        let Some((mesh, pose)) = part.mesh.filter(|(mesh, _)| mesh.faces().len() <= MAX_FACES) else {
            return Vec::new();
        };
        let edges = {
            let mut known = self.edges.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(known.entry(mesh.faces().as_ptr().addr()).or_insert_with(|| Arc::new(sharp_edges(mesh))))
        };
        edges.iter().map(|ends| ends.map(|end| pose.apply(end))).collect()
    }
}

impl<'s> Part<'s> {
    fn new(scene: &'s Scene, part: PartId) -> Option<Self> {
        let (shape, pose) = (scene.shape(part), *scene.pose(part));
        let bounds = shape.at(pose).ok()?.bounds()?;
        Some(Self { bounds, mesh: shape.as_mesh().map(|(mesh, _)| (mesh, pose)) })
    }

    /// Returns the number of triangles.
    pub(super) fn len(&self) -> usize {
        self.mesh.map_or(12, |(mesh, _)| mesh.faces().len())
    }

    /// Returns the corners of a triangle in the world frame, rounded.
    pub(super) fn triangle(&self, at: usize) -> [Vector; 3] {
        match &self.mesh {
            Some((mesh, pose)) => mesh.corners(at as u32).map(|corner| pose.apply(corner)),
            None => triangles(&self.bounds)[at],
        }
    }
}
