//! Some faces of a height field as a mesh, for queries that need the tree or the connectivity of a
//! mesh.

use super::field::HeightField;
use crate::mesh::Mesh;

/// A mesh of some faces of a height field, in the frame of the field. Its faces and points have the
/// order of the field.
#[derive(Debug)]
pub(crate) struct Crop {
    pub(crate) mesh: Mesh,
    faces: Vec<u32>,
    vertices: Vec<u32>,
}

impl Crop {
    /// Returns the number in the field of a face of the mesh.
    pub(crate) fn face(&self, face: u32) -> u32 {
        self.faces[face as usize]
    }

    /// Returns the number in the field of a vertex of the mesh.
    pub(crate) fn vertex(&self, vertex: u32) -> u32 {
        self.vertices[vertex as usize]
    }
}

impl HeightField {
    /// Returns a mesh of some faces, which must exist. Returns `None` if the list is empty or the
    /// mesh is too large.
    pub(crate) fn crop(&self, mut faces: Vec<u32>) -> Option<Crop> {
        if faces.is_empty() {
            return None;
        }
        faces.sort_unstable();
        faces.dedup();
        let mut vertices: Vec<u32> = faces.iter().flat_map(|&face| self.vertices(face)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let renamed =
            |face: &u32| self.vertices(*face).map(|vertex| vertices.partition_point(|&other| other < vertex) as u32);
        let corners: Vec<[u32; 3]> = faces.iter().map(renamed).collect();
        let positions: Vec<[f64; 3]> = vertices.iter().map(|&vertex| self.position(vertex)).collect();
        Some(Crop { mesh: Mesh::new(positions, corners).ok()?, faces, vertices })
    }
}
