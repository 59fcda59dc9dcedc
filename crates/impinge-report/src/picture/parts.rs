//! The parts of scenes, with their surfaces in the world frame.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use impinge::clash::{Member, Side};
use impinge::scene::{PartId, Scene};
use impinge::{Mesh, Pose, Shape};

use super::bounds::Bounds;
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::Color;
use super::sharp_edges::sharp_edges;
use super::vector::Vector;

/// Maximum number of faces of a mesh whose sharp edges are drawn. More take longer to find than to
/// draw, and their edges are closer than pixels.
const MAX_FACES: usize = 400_000;

/// Number of segments around a round shape. More are closer than a few pixels in most pictures.
const SEGMENTS: usize = 48;

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
pub(super) struct Part<'s> {
    pub(super) bounds: Bounds,
    shape: &'s Shape,
    pose: Pose,
    /// Meshes that are drawn, each with its pose in the frame of the part; found when the part is
    /// first drawn.
    surface: OnceLock<Vec<(Mesh, Pose)>>,
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

    /// Draws the surface of a part.
    pub(super) fn draw(&self, part: &Part<'_>, canvas: &mut Canvas, camera: &Camera, color: Color) {
        for (mesh, pose) in part.surface() {
            let triangle = |face: usize| (part.corners(mesh, pose, face), color);
            canvas.draw(camera, [0.0; 2], mesh.faces().len(), triangle);
        }
    }

    /// Draws the sharp edges of a part.
    pub(super) fn draw_edges(&self, part: &Part<'_>, canvas: &mut Canvas, camera: &Camera, stroke: EdgeStroke) {
        let EdgeStroke { width, color, opacity } = stroke;
        for (mesh, pose) in part.surface().iter().filter(|(mesh, _)| mesh.faces().len() <= MAX_FACES) {
            for ends in self.edges(mesh).iter() {
                if let Some(seen) = camera.segment(ends.map(|end| part.pose.apply(pose.apply(end)))) {
                    canvas.edge(seen, width, color, opacity);
                }
            }
        }
    }

    /// Returns the sharp edges of a mesh that lives as long as the parts.
    fn edges(&self, mesh: &Mesh) -> Edges {
        let mut known = self.edges.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(known.entry(mesh.faces().as_ptr().addr()).or_insert_with(|| Arc::new(sharp_edges(mesh))))
    }
}

/// How edges are drawn.
#[derive(Clone, Copy)]
pub(super) struct EdgeStroke {
    /// Width in pixels.
    pub(super) width: f64,
    pub(super) color: Color,
    pub(super) opacity: f64,
}

impl<'s> Part<'s> {
    fn new(scene: &'s Scene, part: PartId) -> Option<Self> {
        let (shape, pose) = (scene.shape(part), *scene.pose(part));
        let bounds = shape.at(pose).ok()?.bounds()?;
        Some(Self { bounds, shape, pose, surface: OnceLock::new() })
    }

    /// Returns the mesh and its pose, or `None` for a part of another shape.
    pub(super) fn mesh(&self) -> Option<(&'s Mesh, Pose)> {
        self.shape.as_mesh().map(|(mesh, _)| (mesh, self.pose))
    }

    /// Returns the triangles of the part, with their corners in the world frame, rounded.
    pub(super) fn triangles<'p>(&'p self) -> impl Iterator<Item = [Vector; 3]> + use<'p, 's> {
        let faces = move |(mesh, pose): &'p (Mesh, Pose)| {
            (0..mesh.faces().len()).map(move |face| self.corners(mesh, pose, face))
        };
        self.surface().iter().flat_map(faces)
    }

    fn surface(&self) -> &[(Mesh, Pose)] {
        self.surface.get_or_init(|| self.shape.to_meshes(SEGMENTS))
    }

    fn corners(&self, mesh: &Mesh, pose: &Pose, face: usize) -> [Vector; 3] {
        mesh.corners(face as u32).map(|corner| self.pose.apply(pose.apply(corner)))
    }
}
