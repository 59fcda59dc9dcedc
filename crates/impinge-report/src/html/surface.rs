//! The triangles of shapes that are no meshes.

use impinge::{Mesh, Shape};

/// Number of segments around a round shape.
const SEGMENTS: usize = 32;

/// Returns one mesh in the frame of a shape, with the triangles of all its parts, or `None` if it
/// has no bounded surface.
pub(super) fn surface(shape: &Shape) -> Option<Mesh> {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut meshes = shape.to_meshes(SEGMENTS);
    if shape.as_mesh().is_some() {
        return meshes.pop().map(|(mesh, _)| mesh);
    }
    for (mesh, pose) in meshes {
        for face in 0..mesh.faces().len() as u32 {
            let first = positions.len() as u32;
            positions.extend(mesh.corners(face).map(|corner| pose.apply(corner)));
            faces.push([first, first + 1, first + 2]);
        }
    }
    // The corners of faces are joined when they are rounded.
    Mesh::new(positions, faces).ok().filter(|mesh| !mesh.faces().is_empty())
}
