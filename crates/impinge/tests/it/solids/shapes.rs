//! Meshes for the tests of solids, and oracles that share no code with the engine.

use impinge::mesh::PlacedMesh;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::oracle::triangles_meet;
use impinge_testkit::{Affine, generate::solids};

/// Returns the engine's mesh for a mesh of the testkit.
pub(crate) fn engine(mesh: &impinge_testkit::Mesh) -> Mesh {
    Mesh::new(Positions::F64(mesh.vertices.clone()), mesh.faces.clone()).expect("a legal mesh")
}

pub(crate) fn pose(map: &Affine) -> Pose {
    Pose::new(map.linear, map.translation).expect("a legal pose")
}

/// Returns the mesh with every face flipped.
pub(crate) fn flipped(mut mesh: impinge_testkit::Mesh) -> impinge_testkit::Mesh {
    mesh.faces.iter_mut().for_each(|face| face.swap(1, 2));
    mesh
}

/// Returns the mesh with separate vertices for each face.
pub(crate) fn soup(mesh: &impinge_testkit::Mesh) -> impinge_testkit::Mesh {
    let vertices = mesh.faces.iter().flatten().map(|&vertex| mesh.vertices[vertex as usize]).collect();
    let faces = (0..mesh.faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    impinge_testkit::Mesh { vertices, faces }
}

pub(crate) fn moved(mut mesh: impinge_testkit::Mesh, by: [f64; 3]) -> impinge_testkit::Mesh {
    mesh.vertices.iter_mut().for_each(|vertex| *vertex = std::array::from_fn(|k| vertex[k] + by[k]));
    mesh
}

/// Returns the mesh without the faces of a sorted list.
pub(crate) fn without_faces(mut mesh: impinge_testkit::Mesh, left_out: &[usize]) -> impinge_testkit::Mesh {
    let mut number = 0;
    mesh.faces.retain(|_| {
        number += 1;
        left_out.binary_search(&(number - 1)).is_err()
    });
    mesh
}

pub(crate) fn sphere() -> impinge_testkit::Mesh {
    solids::icosphere(2)
}

/// Returns the sum of the solid angles over 4π, by the platform's arctangent. Faces in one plane
/// with the point count zero.
///
/// The error is about 1e-12 for points that are not close to an edge.
pub(crate) fn solid_angles(mesh: &impinge_testkit::Mesh, p: [f64; 3]) -> f64 {
    let mut sum = 0.0;
    for face in &mesh.faces {
        let [a, b, c] = face.map(|vertex| {
            let corner = mesh.vertices[vertex as usize];
            [corner[0] - p[0], corner[1] - p[1], corner[2] - p[2]]
        });
        let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let length = |u: [f64; 3]| dot(u, u).sqrt();
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        let determinant = dot(a, cross);
        let (la, lb, lc) = (length(a), length(b), length(c));
        if determinant.abs() > 1e-13 * la * lb * lc {
            sum += 2.0 * determinant.atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
        }
    }
    sum / (4.0 * std::f64::consts::PI)
}

/// Reports whether a point is on a face, by the testkit's linear programming.
pub(crate) fn is_on_surface(mesh: &impinge_testkit::Mesh, p: [f64; 3]) -> bool {
    let identity = Affine::IDENTITY;
    (0..mesh.faces.len()).map(|face| mesh.at(identity).triangle(face)).any(|corners| {
        let beyond = |k: usize| corners.iter().all(|c| c[k] < p[k]) || corners.iter().all(|c| c[k] > p[k]);
        !(0..3).any(beyond) && triangles_meet(&corners, &identity, &[p; 3], &identity)
    })
}

/// Choices of which of two meshes are solid.
pub(crate) const NEITHER: [bool; 2] = [false; 2];
pub(crate) const A: [bool; 2] = [true, false];
pub(crate) const B: [bool; 2] = [false, true];
pub(crate) const BOTH: [bool; 2] = [true; 2];

/// Returns a mesh as its surface or as a solid.
pub(crate) fn surface_or_solid<'a>(placed: impl Into<PlacedMesh<'a>>, is_solid: bool) -> PlacedMesh<'a> {
    PlacedMesh { is_solid, ..placed.into() }
}
