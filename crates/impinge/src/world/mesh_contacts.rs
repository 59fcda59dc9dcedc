//! The contacts of two meshes: one for each pair of faces that meet.
//!
//! Which faces meet is exact. Where they do and how they come apart is of each two triangles by themselves, in double
//! precision: the least of their overlaps along the two normals and the nine directions across two edges, which is how far one
//! has to move to leave the other (Ericson, *Real-Time Collision Detection*, 5.2.1 and 4.4.1). Faces that share a plane have a
//! depth of zero.

use crate::mesh::Placed;
use crate::primitive::{closest_on_triangles, cross, dot, length, sub};
use crate::query::intersecting_pairs;
use crate::query::shapes::{ContactId, ContactPoint, Feature, Manifold};

type Triangle = [[f64; 3]; 3];

/// Directions shorter than this share of the lengths that they are products of say nothing: edges that are parallel but for
/// rounding, faces that are needles.
const PARALLEL: f64 = 1e-9;

/// More than what depths may be off by, in units of the coordinates: 5 units of 2^-53 for the image of a corner, 3 for a
/// difference, 8 for a cross product and its length, 4 for heights; taken twice, on both sides.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Every pair of faces that meet, by the first face, then by the second.
pub(super) fn contacts(a: Placed<'_>, b: Placed<'_>) -> Vec<Manifold> {
    let posed = |mesh: &Placed<'_>, face: u32| mesh.mesh.corners(face).map(|corner| mesh.world_from_mesh.apply(corner));
    let pairs = intersecting_pairs(a, b);
    pairs.into_iter().map(|[face_a, face_b]| contact([face_a, face_b], &posed(&a, face_a), &posed(&b, face_b))).collect()
}

fn contact([part_a, part_b]: [u32; 2], a: &Triangle, b: &Triangle) -> Manifold {
    let Separation { normal, depth } = least_separation(a, b);
    let middle = common_middle(a, b);
    let reach = a.iter().chain(b).flatten().fold(0.0_f64, |reach, x| reach.max(x.abs()));
    let doubt = ROUNDING * reach;
    let half = normal.map(|x| 0.5 * depth * x);
    let point = ContactPoint {
        point_a: [0, 1, 2].map(|k| middle[k] + half[k]),
        point_b: [0, 1, 2].map(|k| middle[k] - half[k]),
        lower: (depth - doubt).max(0.0),
        upper: depth + doubt,
        id: ContactId { part_a, part_b, feature_a: Feature::Face(part_a), feature_b: Feature::Face(part_b) },
    };
    Manifold { normal, points: vec![point] }
}

/// The least way on which the second triangle leaves the first.
struct Separation {
    normal: [f64; 3],
    depth: f64,
}

fn least_separation(a: &Triangle, b: &Triangle) -> Separation {
    let (edges_a, edges_b) = (edges(a), edges(b));
    let mut best = Separation { normal: [0.0, 0.0, 1.0], depth: f64::INFINITY };
    let mut consider = |axis: [f64; 3], size: f64| {
        let long = length(&axis);
        // Not only where it is too short: what is no number is no direction either.
        if !(long > PARALLEL * size) {
            return;
        }
        let unit = axis.map(|x| x / long);
        let ([low_a, high_a], [low_b, high_b]) = (heights(&unit, a), heights(&unit, b));
        let (forward, back) = ((high_a - low_b).max(0.0), (high_b - low_a).max(0.0));
        let (depth, normal) = if forward <= back { (forward, unit) } else { (back, unit.map(|x| -x)) };
        if depth < best.depth {
            best = Separation { normal, depth };
        }
    };
    for edges in [&edges_a, &edges_b] {
        consider(cross(&edges[0], &edges[1]), length(&edges[0]) * length(&edges[1]));
    }
    for edge_a in &edges_a {
        for edge_b in &edges_b {
            consider(cross(edge_a, edge_b), length(edge_a) * length(edge_b));
        }
    }
    if best.depth.is_infinite() {
        // Two segments of one line, or points.
        best.depth = 0.0;
    }
    best
}

fn edges([p, q, r]: &Triangle) -> Triangle {
    [sub(q, p), sub(r, q), sub(p, r)]
}

/// The least and the greatest height of the corners.
fn heights(unit: &[f64; 3], triangle: &Triangle) -> [f64; 2] {
    let [p, q, r] = triangle.map(|corner| dot(unit, &corner));
    [p.min(q).min(r), p.max(q).max(r)]
}

/// The middle of what two triangles that meet have in common.
fn common_middle(a: &Triangle, b: &Triangle) -> [f64; 3] {
    let on_line = [pierce(a, b), pierce(b, a)].concat();
    if let [first, .., last] = &on_line[..]
        && on_line.len() >= 4
    {
        // Of the four ends of two intervals on one line, the middle two are those of what they share.
        let along = sub(last, first);
        let mut ends = on_line.clone();
        ends.sort_by(|p, q| dot(&along, p).total_cmp(&dot(&along, q)));
        let (p, q) = (ends[ends.len() / 2 - 1], ends[ends.len() / 2]);
        return [0, 1, 2].map(|k| 0.5 * p[k] + 0.5 * q[k]);
    }
    closest_on_triangles(a, b).point_a
}

/// Where the edges of one triangle go through the plane of another.
fn pierce(edges_of: &Triangle, plane: &Triangle) -> Vec<[f64; 3]> {
    let [first, second, _] = edges(plane);
    let normal = cross(&first, &second);
    let height = edges_of.map(|corner| dot(&normal, &sub(&corner, &plane[0])));
    (0..3)
        .filter_map(|i| {
            let j = (i + 1) % 3;
            if (height[i] < 0.0) == (height[j] < 0.0) {
                return None;
            }
            let t = height[i] / (height[i] - height[j]);
            let way = sub(&edges_of[j], &edges_of[i]);
            let point = [0, 1, 2].map(|k| edges_of[i][k] + t * way[k]);
            point.iter().all(|x| x.is_finite()).then_some(point)
        })
        .collect()
}
