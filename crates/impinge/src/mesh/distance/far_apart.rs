//! Meshes so far apart that rounding would make most pairs of faces equally near.
//!
//! With a gap g between meshes of extent e, along a direction n, the nearest points are those that reach farthest along n, up
//! to e² / 2g: what a point to the side of them adds. Beyond [`FAR_APART`] that is below 2^-48 g, less than values are off by in
//! any case. So the faces that reach farthest are taken, the first among equals, after one pass over each mesh.

use super::metric::MetricMap;
use super::scene::{Scene, Valued};
use crate::math::vec3::{Vector, dot, length, sub};
use crate::mesh::Mesh;
use crate::primitive::triangle_triangle;

/// Ratio of the gap to the extent of both meshes above which they count as far apart.
const FAR_APART: f64 = (1_u64 << 24) as f64;

/// Returns the faces that reach farthest, with their value and its error beyond the error of values. Returns `None` if the meshes
/// are not far apart.
pub(super) fn nearest(scene: &Scene<'_>) -> Option<(Valued, f64)> {
    let metric = &scene.metric;
    let gap = sub(&metric.maps[1].offset, &metric.maps[0].offset);
    let size = length(&gap);
    if size <= FAR_APART * metric.extent {
        return None;
    }
    let direction = gap.map(|x| x / size);
    let faces = [
        farthest(scene.meshes[0], &metric.maps[0], direction),
        farthest(scene.meshes[1], &metric.maps[1], direction.map(|x| -x)),
    ];
    let [a, b] = scene.corners(faces);
    let witness = triangle_triangle(&a, &b);
    // Twice e² / 2g, as the gap between the centres is not quite that between the meshes.
    let aside = metric.extent * (metric.extent / size);
    Some((Valued { value: witness.squared.sqrt(), faces, witness }, aside))
}

/// Returns the face with the corner that reaches farthest in a direction, the first among equals.
fn farthest(mesh: &Mesh, map: &MetricMap, direction: Vector) -> u32 {
    let column = |j: usize| [map.linear[0][j], map.linear[1][j], map.linear[2][j]];
    let local = [0, 1, 2].map(|j| dot(&direction, &column(j)));
    let mut farthest = (f64::NEG_INFINITY, 0);
    for face in 0..mesh.faces().len() as u32 {
        let reach = mesh
            .corners(face)
            .iter()
            .fold(f64::NEG_INFINITY, |most, corner| most.max(dot(&local, &sub(corner, &map.centre))));
        if reach > farthest.0 {
            farthest = (reach, face);
        }
    }
    farthest.1
}
