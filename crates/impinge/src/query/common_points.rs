//! Points that two intersecting faces have in common: one for each pair of faces.
//!
//! Tests: `tests/it/engine/common_points.rs`. Benchmark: `bench/doors.py`.

use crate::exact::{Crossing, Placement, crossing};
use crate::math::vec3::{add, cross, dot, normalized, scale, scaled_length, sub};
use crate::mesh::PlacedMesh;
use crate::primitive::closest_on_segments;

/// Smallest sine of the angle between two planes, and smallest height of a triangle relative to its
/// edges, for which floats are enough: 1/16. Rounding errors of a point grow with the inverse of
/// both. A larger limit sends more pairs to exact arithmetic, which takes microseconds for each.
const MIN_SINE: f64 = 1.0 / 16.0;

/// Height of a triangle relative to its edges, 2^-40, below which it counts as a segment. Rounding
/// of the corners gives a segment a smaller height.
const MIN_HEIGHT: f64 = 1.0 / (1_u64 << 40) as f64;

/// Returns a common point of each pair of intersecting faces: face of `a`, face of `b`.
///
/// Points are in the world frame. The point of two faces that share a segment is its middle. The
/// point of two faces in one plane is the mean corner of the polygon that they share. The pairs
/// must be pairs of faces that intersect.
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
/// A point is within rounding errors of both faces: 2^-38 of the largest coordinate. If the planes
/// of the faces are nearly parallel, each end of their segment is the exact point with each
/// coordinate rounded.
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
        let on_a = corners[0].map(|at| a.world_from_mesh.apply(at));
        let on_b = corners[1].map(|at| b.world_from_mesh.apply(at));
        if let Some(point) = middle_in_floats(&on_a, &on_b) {
            return point;
        }
        match crossing(&placement, &corners[0], &corners[1]) {
            Crossing::Apart => [0.0; 3],
            Crossing::Point(end) => end.point,
            Crossing::Segment(from, to) => std::array::from_fn(|k| from.point[k] / 2.0 + to.point[k] / 2.0),
            Crossing::Coplanar => point_of_plane(on_a, on_b),
        }
    };
    pairs.iter().map(point).collect()
}

/// Returns the middle of the segment that two intersecting triangles share, if floats are enough:
/// no triangle is thin, the planes are far from parallel, and each plane separates the corners of
/// the other triangle.
fn middle_in_floats(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> Option<[f64; 3]> {
    let (normal_a, normal_b) = (normal_of(a, MIN_SINE)?, normal_of(b, MIN_SINE)?);
    let along = cross(&normal_a, &normal_b);
    if dot(&along, &along) < MIN_SINE * MIN_SINE {
        return None;
    }
    let [[a0, a1], [b0, b1]] = [ends_in_plane(a, &normal_b, &b[0])?, ends_in_plane(b, &normal_a, &a[0])?];
    // The common segment lies between the two inner ones of the four points on the line.
    let mut ends = [a0, a1, b0, b1].map(|end| (dot(&along, &sub(&end, &a[0])), end));
    ends.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
    Some(std::array::from_fn(|k| ends[1].1[k] / 2.0 + ends[2].1[k] / 2.0))
}

/// Returns the unit normal of a triangle, or `None` if its height is less than `min_height` times
/// the longer of two edges.
fn normal_of([x, y, z]: &[[f64; 3]; 3], min_height: f64) -> Option<[f64; 3]> {
    let edges = [sub(y, x), sub(z, x)];
    let longer = scaled_length(&edges[0]).max(scaled_length(&edges[1]));
    if longer < f64::MIN_POSITIVE {
        return None;
    }
    let [one, other] = edges.map(|edge| edge.map(|x| x / longer));
    let normal = cross(&one, &other);
    if scaled_length(&normal) < min_height { None } else { normalized(&normal) }
}

/// Returns the points in which two edges of a triangle cross a plane, or `None` if the plane does
/// not separate its corners strictly.
fn ends_in_plane(triangle: &[[f64; 3]; 3], normal: &[f64; 3], origin: &[f64; 3]) -> Option<[[f64; 3]; 2]> {
    let heights = triangle.each_ref().map(|corner| dot(normal, &sub(corner, origin)));
    let is_above = heights.map(|height| height > 0.0);
    if heights.contains(&0.0) {
        return None;
    }
    // The corner that is alone on its side of the plane.
    let apex = (0..3).find(|&k| is_above[k] != is_above[(k + 1) % 3] && is_above[k] != is_above[(k + 2) % 3])?;
    let end = |other: usize| {
        let share = heights[apex] / (heights[apex] - heights[other]);
        add(&triangle[apex], &scale(&sub(&triangle[other], &triangle[apex]), share))
    };
    Some([end((apex + 1) % 3), end((apex + 2) % 3)])
}

/// Returns a common point of two triangles in one plane, or of two triangles without area.
fn point_of_plane(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [f64; 3] {
    match (normal_of(&a, MIN_HEIGHT), normal_of(&b, MIN_HEIGHT)) {
        (_, Some(normal)) => mean_corner(&a, &b, &normal),
        (Some(normal), None) => mean_corner(&b, &a, &normal),
        (None, None) => {
            let found = closest_on_segments(&longest_edge(&a), &longest_edge(&b));
            std::array::from_fn(|k| found.point_a[k] / 2.0 + found.point_b[k] / 2.0)
        }
    }
}

fn longest_edge(triangle: &[[f64; 3]; 3]) -> [[f64; 3]; 2] {
    let edges = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3]]);
    let length = |edge: &[[f64; 3]; 2]| scaled_length(&sub(&edge[1], &edge[0]));
    edges.into_iter().max_by(|one, other| length(one).total_cmp(&length(other))).unwrap_or(edges[0])
}

/// Returns the mean corner of the polygon that two triangles in one plane share. Clips the first
/// triangle at the edges of the second, which must have an area (Sutherland, Hodgman, *Reentrant
/// polygon clipping*, 1974).
fn mean_corner(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3], normal: &[f64; 3]) -> [f64; 3] {
    let mut polygon = a.to_vec();
    for k in 0..3 {
        let start = &b[k];
        let inward = cross(normal, &sub(&b[(k + 1) % 3], start));
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
