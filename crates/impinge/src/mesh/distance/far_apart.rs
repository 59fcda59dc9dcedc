//! Distance of meshes so far apart that rounding would make most pairs of faces equally near.
//!
//! Let a gap g along a direction n separate meshes of extent e. The nearest points are the points
//! that reach farthest along n, up to e² / 2g, the length that a point to the side of them adds.
//! Beyond [`FAR_APART`] that is below 2^-48 g, less than the error of values. So the faces that
//! reach farthest are taken, the first ones if several reach equally far. This takes one pass over
//! each mesh.

use super::metric::MetricMap;
use super::scene::{Scene, Valued};
use crate::math::vec3::{Vector, dot, length, sub};
use crate::mesh::Mesh;
use crate::primitive::triangle_triangle;

/// Ratio of the gap to the extent of both meshes above which they count as far apart: 2^24.
const FAR_APART: f64 = (1_u64 << 24) as f64;

/// Returns the faces that reach farthest towards each other, with their value and its error in
/// addition to the error of values, in metric units. Returns `None` if the meshes are not far
/// apart.
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
    // Twice e² / 2g, because the gap between the centers is not quite the gap between the meshes.
    let aside = metric.extent * (metric.extent / size);
    Some((Valued { value: witness.squared.sqrt(), faces, witness }, aside))
}

/// Returns the face with the corner that reaches farthest in a direction of the metric frame, or
/// the first such face.
fn farthest(mesh: &Mesh, map: &MetricMap, direction: Vector) -> u32 {
    let column = |j: usize| [map.linear[0][j], map.linear[1][j], map.linear[2][j]];
    let local = [0, 1, 2].map(|j| dot(&direction, &column(j)));
    let mut farthest = (f64::NEG_INFINITY, 0);
    for face in 0..mesh.faces().len() as u32 {
        let reach = mesh
            .corners(face)
            .iter()
            .fold(f64::NEG_INFINITY, |most, corner| most.max(dot(&local, &sub(corner, &map.center))));
        if reach > farthest.0 {
            farthest = (reach, face);
        }
    }
    farthest.1
}
