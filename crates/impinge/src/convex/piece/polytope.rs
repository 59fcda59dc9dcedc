//! The polytope of a piece: the hull of its corners, and the face of the mesh at a point of it.

use super::Piece;
use crate::convex::Faceted;
use crate::convex::facets::Facets;
use crate::convex::overlap::Feature;
use crate::convex::posed::{Core, Swept};
use crate::hull::Hull;
use crate::math::Pose;
use crate::math::vec3::{length, sub};
use crate::mesh::Mesh;
use crate::primitive::closest_on_segment;

/// Number of corners above which the corners inside flat parts are left out before the hull is
/// built. Fewer corners cost less than the test.
const MIN_CULLED_CORNERS: usize = 64;

/// The hull of a piece. Its corners have the numbers of the mesh's vertices.
#[derive(Debug)]
pub(super) struct Polytope {
    pub(super) hull: Hull,
    facets: Facets,
}

impl Polytope {
    pub(super) fn of(piece: &Piece<'_>) -> Option<Self> {
        let corners = if piece.corners.len() > MIN_CULLED_CORNERS {
            outer(piece)
        } else {
            distinct(piece.corners.iter().map(|&(vertex, _)| vertex).collect())
        };
        let points: Vec<[f64; 3]> = corners.iter().map(|&at| piece.mesh.position(at)).collect();
        let hull = Hull::new(&points).ok()?;
        let mut facets = Facets::of_hull(&hull);
        for (corner, &number) in facets.corners.iter_mut().zip(hull.vertices()) {
            corner.0 = corners[number as usize];
        }
        Some(Self { hull, facets })
    }

    pub(super) fn faceted<'a>(&'a self, pose: &'a Pose) -> Faceted<'a> {
        let swept = Swept { core: Core::Hull(&self.hull), pose, radius: [0.0; 2] };
        Faceted { swept, facets: Some(&self.facets), has_all_facets: true }
    }

    /// Returns the mesh's vertices at the hull's corners.
    pub(super) fn vertices(&self) -> impl Iterator<Item = u32> {
        self.facets.corners.iter().map(|corner| corner.0)
    }
}

fn distinct(mut corners: Vec<u32>) -> Vec<u32> {
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// Returns the corners that may be on the hull: of each plane, those on the border of a polygon
/// between the farthest corners along eight directions, or beyond it.
fn outer(piece: &Piece<'_>) -> Vec<u32> {
    let mut of_plane: Vec<Vec<u32>> = vec![Vec::new(); piece.planes.len()];
    for &(vertex, plane) in &piece.corners {
        of_plane[plane as usize].push(vertex);
    }
    let mut kept = Vec::new();
    for (plane, corners) in piece.planes.iter().zip(of_plane) {
        if corners.len() <= MIN_CULLED_CORNERS {
            kept.extend(corners);
            continue;
        }
        let normal = plane.normal.map(f64::abs);
        let across = (0..3).max_by(|&i, &j| normal[i].total_cmp(&normal[j])).unwrap_or(0);
        let (i, j) = ((across + 1) % 3, (across + 2) % 3);
        let flat: Vec<[f64; 2]> = corners
            .iter()
            .map(|&at| {
                let point = piece.mesh.position(at);
                [point[i], point[j]]
            })
            .collect();
        let polygon = octagon(&flat);
        let inner = inner_box(&polygon);
        let is_outer = |at: &[f64; 2]| !is_in_box(&inner, at) && !is_inside(&polygon, at);
        kept.extend(corners.into_iter().zip(&flat).filter(|(_, at)| is_outer(at)).map(|(corner, _)| corner));
    }
    distinct(kept)
}

/// Returns the farthest points along eight directions, in counterclockwise order.
fn octagon(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (mut highest, mut lowest) = ([(f64::NEG_INFINITY, 0); 4], [(f64::INFINITY, 0); 4]);
    for (at, [x, y]) in points.iter().enumerate() {
        for (k, height) in [*x, x + y, *y, y - x].into_iter().enumerate() {
            if height >= highest[k].0 {
                highest[k] = (height, at);
            }
            if height <= lowest[k].0 {
                lowest[k] = (height, at);
            }
        }
    }
    highest.into_iter().chain(lowest).filter_map(|(_, at)| points.get(at).copied()).collect()
}

/// Returns a box inside a convex polygon, with the middle and the proportions of the box around it.
/// Most points of a plane are in it, which is faster to decide. Returns an empty box if no box that
/// is tried is certainly inside.
fn inner_box(polygon: &[[f64; 2]]) -> [[f64; 2]; 2] {
    /// Sizes that are tried, relative to the box around the polygon.
    const SHARES: [f64; 6] = [0.99, 0.95, 0.9, 0.8, 0.7, 0.5];
    let end = |k: usize, pick: fn(f64, f64) -> f64, start: f64| polygon.iter().map(|p| p[k]).fold(start, pick);
    let low = [0, 1].map(|k| end(k, f64::min, f64::INFINITY));
    let high = [0, 1].map(|k| end(k, f64::max, f64::NEG_INFINITY));
    let shrunk = |share: f64| {
        let [ends_i, ends_j] = [0, 1].map(|k| {
            let (middle, half) = (0.5 * low[k] + 0.5 * high[k], 0.5 * share * (high[k] - low[k]));
            [middle - half, middle + half]
        });
        [[ends_i[0], ends_j[0]], [ends_i[1], ends_j[1]]]
    };
    let is_within = |[low, high]: &[[f64; 2]; 2]| {
        [*low, [low[0], high[1]], *high, [high[0], low[1]]].iter().all(|corner| is_inside(polygon, corner))
    };
    let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    SHARES.into_iter().map(shrunk).find(is_within).unwrap_or(empty)
}

fn is_in_box([low, high]: &[[f64; 2]; 2], [x, y]: &[f64; 2]) -> bool {
    low[0] <= *x && *x <= high[0] && low[1] <= *y && *y <= high[1]
}

/// Reports whether a point is certainly inside a convex polygon.
fn is_inside(polygon: &[[f64; 2]], point: &[f64; 2]) -> bool {
    /// Relative margin, which is larger than the rounding error of an area.
    const MARGIN: f64 = 1e-9;
    (0..polygon.len()).all(|at| {
        let (from, to) = (polygon[at], polygon[(at + 1) % polygon.len()]);
        let (e, f) = ([to[0] - from[0], to[1] - from[1]], [point[0] - from[0], point[1] - from[1]]);
        let (forward, backward) = (e[0] * f[1], e[1] * f[0]);
        from == to || forward - backward > MARGIN * (forward.abs() + backward.abs())
    })
}

/// Returns the mesh's own feature for a feature of a piece's polytope, given a point on it in the
/// frame of the mesh. A facet becomes the face that is nearest to the point. An edge along several
/// edges of the mesh becomes the edge of that face along it.
pub(super) fn named(mesh: &Mesh, feature: Feature, point: &[f64; 3]) -> Feature {
    let nearest = || mesh.closest_point(*point).ok().flatten().map(|nearest| nearest.face);
    match feature {
        Feature::Vertex(_) => feature,
        Feature::Face(number) => Feature::Face(nearest().unwrap_or(number)),
        Feature::Edge(from, to) if is_edge(mesh, from, to) => feature,
        Feature::Edge(from, to) => {
            let line = [from, to].map(|vertex| mesh.positions().get(vertex as usize));
            nearest().and_then(|face| edge_along(mesh, face, &line)).unwrap_or(feature)
        }
    }
}

fn is_edge(mesh: &Mesh, from: u32, to: u32) -> bool {
    let first_at = &mesh.topology().first_at;
    let corners = |face: u32| mesh.faces()[face as usize].map(|vertex| first_at[vertex as usize]);
    mesh.faces_at(from).iter().any(|&face| corners(face).contains(&to))
}

/// Returns the edge of a face that lies on a segment, or `None`.
fn edge_along(mesh: &Mesh, face: u32, segment: &[[f64; 3]; 2]) -> Option<Feature> {
    /// Maximum distance of an end from the segment, relative to the segment's length.
    const ON_SEGMENT: f64 = 1e-9;
    let first_at = &mesh.topology().first_at;
    let vertices = mesh.faces()[face as usize].map(|vertex| first_at[vertex as usize]);
    let near = ON_SEGMENT * length(&sub(&segment[1], &segment[0]));
    let is_on = mesh.corners(face).map(|corner| closest_on_segment(&corner, segment).distance <= near);
    let edge = (0..3).find(|&edge| is_on[edge] && is_on[(edge + 1) % 3])?;
    let (from, to) = (vertices[edge], vertices[(edge + 1) % 3]);
    Some(Feature::Edge(from.min(to), from.max(to)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    /// Points on a small grid, of which many are on the border of the octagon.
    #[test]
    fn points_in_the_inner_box_are_inside_the_hull() {
        let mut rng = Rng::new(65);
        let (mut inside, mut outside, mut empty) = (0, 0, 0);
        for round in 0..300 {
            let reach = [0, 9, 9][round % 3];
            let points: Vec<[f64; 2]> =
                (0..100).map(|_| [rng.integer(-9, 9) as f64, rng.integer(-reach, reach) as f64]).collect();
            let polygon = octagon(&points);
            for turn in 0..64 {
                let (y, x) = (f64::from(turn) * 0.1).sin_cos();
                let height = |point: &[f64; 2]| x * point[0] + y * point[1];
                let best = |points: &[[f64; 2]]| points.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
                assert!(best(&polygon) <= best(&points));
                if turn == 0 {
                    assert_eq!(best(&polygon), best(&points));
                }
            }
            let inner = inner_box(&polygon);
            empty += usize::from(inner[0][0] > inner[1][0]);
            for point in &points {
                if is_in_box(&inner, point) {
                    assert!(is_inside(&polygon, point), "{point:?} {polygon:?}");
                    inside += 1;
                } else {
                    outside += 1;
                }
            }
        }
        assert!(inside > 5000 && outside > 5000, "{inside} {outside}");
        assert!((100..110).contains(&empty), "{empty}");
    }
}
