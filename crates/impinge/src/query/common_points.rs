//! Points that two intersecting faces have in common: one for each pair of faces.
//!
//! Tests: `tests/it/engine/common_points.rs`. Benchmark: `bench/doors.py`.

use crate::exact::{Crossing, Placement, crossing};
use crate::math::vec3::{add, cross, dot, normalized, scale, sub};
use crate::mesh::PlacedMesh;

/// Returns a common point of each pair of intersecting faces: face of `a`, face of `b`.
///
/// Points are in the world frame. The point of two faces that share a segment is its middle. The
/// point of two faces in one plane is the mean corner of the polygon that they share. A pair that
/// does not intersect gets the origin.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let upright = mesh.at(Pose::new([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]], [0.0, 1.0, -1.0])?);
/// let pairs = query::intersecting_pairs(&mesh, upright);
/// assert_eq!(query::common_points(&mesh, upright, &pairs), [[1.5, 1.0, 0.0]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Each end of a segment is the exact point with each coordinate rounded. The point of two faces in
/// one plane is within rounding errors of both faces.
///
/// # Panics
/// If a face index of a pair is out of range.
#[must_use]
pub fn common_points<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    pairs: &[[u32; 2]],
) -> Vec<[f64; 3]> {
    let (a, b) = (a.into(), b.into());
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let point = |&[face_a, face_b]: &[u32; 2]| {
        let corners = [a.mesh.corners(face_a), b.mesh.corners(face_b)];
        match crossing(&placement, &corners[0], &corners[1]) {
            Crossing::Apart => [0.0; 3],
            Crossing::Point(end) => end.point,
            Crossing::Segment(from, to) => std::array::from_fn(|k| from.point[k] / 2.0 + to.point[k] / 2.0),
            Crossing::Coplanar => {
                let [on_a, on_b] = corners;
                point_of_plane(on_a.map(|at| a.world_from_mesh.apply(at)), on_b.map(|at| b.world_from_mesh.apply(at)))
            }
        }
    };
    pairs.iter().map(point).collect()
}

/// Returns the mean corner of the polygon that two triangles in one plane share. Clips the first
/// triangle at the edges of the second (Sutherland, Hodgman, *Reentrant polygon clipping*, 1974).
fn point_of_plane(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [f64; 3] {
    let normal_of = |[x, y, z]: &[[f64; 3]; 3]| normalized(&cross(&sub(y, x), &sub(z, x)));
    let normal = normal_of(&b).or_else(|| normal_of(&a)).unwrap_or_default();
    let mut polygon = a.to_vec();
    for k in 0..3 {
        let start = &b[k];
        let inward = cross(&normal, &sub(&b[(k + 1) % 3], start));
        let heights: Vec<f64> = polygon.iter().map(|point| dot(&inward, &sub(point, start))).collect();
        let mut clipped = Vec::new();
        for (i, (point, &height)) in polygon.iter().zip(&heights).enumerate() {
            let last = i.checked_sub(1).unwrap_or(polygon.len() - 1);
            let (before, lower) = (&polygon[last], heights[last]);
            if (height < 0.0) != (lower < 0.0) {
                clipped.push(add(before, &scale(&sub(point, before), lower / (lower - height))));
            }
            if height >= 0.0 {
                clipped.push(*point);
            }
        }
        if clipped.is_empty() {
            // The common part was lost to rounding: keep the corner that is nearest to the edge.
            let highest = (0..polygon.len()).max_by(|&i, &j| heights[i].total_cmp(&heights[j]));
            clipped.extend(highest.map(|at| polygon[at]));
        }
        polygon = clipped;
    }
    let count = polygon.len() as f64;
    polygon.iter().fold([0.0; 3], |sum, point| add(&sum, point)).map(|sum| sum / count)
}
