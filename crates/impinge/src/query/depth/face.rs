//! A face in the frame of the search for a depth, and the boxes of this frame.

use super::cell::{Cell, Plane, Polygon};
use crate::math::Pose;
use crate::math::vec3::{Vector, add, cross, dot, length, scale, sub, unit};
use crate::mesh::PlacedMesh;
use crate::primitive::PreparedTriangle;

/// A face in the frame of the search.
pub(super) struct Face {
    pub(super) corners: [Vector; 3],
    /// Unit normal at the front, or `None` if the face has no area.
    pub(super) normal: Option<Vector>,
    /// Twice the area.
    double_area: f64,
    pub(super) bounds: [Vector; 2],
    /// The planes through the edges, at right angles to the face, with the face inside.
    edges: [Option<Plane>; 3],
    prepared: PreparedTriangle,
}

impl Face {
    /// Returns the face with these corners. `is_mirrored` tells that the pose of the mesh mirrors:
    /// the corners are then in clockwise order, seen from the front.
    pub(super) fn new(corners: [Vector; 3], is_mirrored: bool) -> Self {
        let product = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
        let turn = unit(&product);
        let edges = std::array::from_fn(|edge| {
            let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
            let across = unit(&cross(&sub(&to, &from), &turn?))?;
            Some(Plane { normal: across, height: dot(&across, &from) })
        });
        let normal = if is_mirrored { turn.map(|turn| scale(&turn, -1.0)) } else { turn };
        Self {
            corners,
            normal,
            double_area: length(&product),
            bounds: box_about(&corners),
            edges,
            prepared: PreparedTriangle::new(&corners),
        }
    }

    /// Returns the squared distance of a point from the face, and the nearest point. Returns `None`
    /// if the distance is known not to be less than the root of `best`.
    pub(super) fn nearest_within(&self, point: &Vector, best: f64) -> Option<(f64, Vector)> {
        let [low, high] = &self.bounds;
        let apart: f64 =
            (0..3).map(|axis| (low[axis] - point[axis]).max(point[axis] - high[axis]).max(0.0).powi(2)).sum();
        (apart < best).then(|| self.prepared.nearest(point, &self.corners))
    }

    /// Returns the squared distance of a point from the face.
    pub(super) fn squared_distance(&self, point: &Vector) -> f64 {
        self.prepared.nearest(point, &self.corners).0
    }

    /// Returns the plane through an edge, at right angles to the face, with the face inside.
    pub(super) fn edge_plane(&self, edge: usize) -> Option<Plane> {
        self.edges[edge]
    }

    /// Reports whether the face may reach a cell.
    pub(super) fn reaches(&self, cell: &Cell, slack: f64) -> bool {
        if let Some(normal) = self.normal {
            let level = dot(&normal, &self.corners[0]);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for corner in cell.corners() {
                let height = dot(&normal, corner) - level;
                (low, high) = (low.min(height), high.max(height));
            }
            if low > slack || high < -slack {
                return false;
            }
        }
        cell.meets(&self.corners, slack)
    }

    /// Reports whether a cell that the face reaches lies on both sides of its plane.
    pub(super) fn divides(&self, cell: &Cell, slack: f64) -> bool {
        let Some(plane) = self.plane() else { return false };
        let beyond = cell.corners().map(|corner| plane.beyond(corner));
        let (low, high) = beyond.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        low < -4.0 * slack && high > 4.0 * slack
    }

    /// Returns the plane of the face, with the front beyond it, or `None` if the face has no area.
    pub(super) fn plane(&self) -> Option<Plane> {
        self.normal.map(|normal| Plane { normal, height: dot(&normal, &self.corners[0]) })
    }

    /// Reports whether the foot of a point in the face's plane is in the face.
    pub(super) fn is_below(&self, point: &Vector, slack: f64) -> bool {
        self.edges.iter().all(|edge| edge.is_some_and(|plane| plane.beyond(point) <= slack))
    }
}

/// Returns the face with the largest part in a cell, and that part, which may be empty.
pub(super) fn largest_in<'f, T>(
    cell: &Cell,
    faces: impl Iterator<Item = (T, &'f Face)>,
    margin: f64,
) -> Option<(T, Polygon)> {
    let (mut largest, mut best) = (-1.0, None);
    // A part is no larger than its face.
    for (name, face) in faces {
        if face.double_area > largest {
            let part = cell.clip(&face.corners, margin);
            let part_area = double_area(&part);
            if part_area > largest {
                (largest, best) = (part_area, Some((name, part)));
            }
        }
    }
    best
}

/// Returns twice the area of a polygon in a plane.
fn double_area(polygon: &[Vector]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else { return 0.0 };
    let sum =
        rest.windows(2).fold([0.0; 3], |sum, pair| add(&sum, &cross(&sub(&pair[0], first), &sub(&pair[1], first))));
    length(&sum)
}

/// Returns the box about a triangle.
pub(super) fn box_about(corners: &[Vector; 3]) -> [Vector; 2] {
    [f64::min, f64::max].map(|choose: fn(f64, f64) -> f64| {
        std::array::from_fn(|axis| choose(choose(corners[0][axis], corners[1][axis]), corners[2][axis]))
    })
}

/// Returns the gap between two boxes: the largest difference along an axis, or a negative number if
/// they overlap.
pub(super) fn gap(a: &[Vector; 2], b: &[Vector; 2]) -> f64 {
    (0..3).map(|axis| (a[0][axis] - b[1][axis]).max(b[0][axis] - a[1][axis])).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the corners of a face in the world, less the origin.
pub(super) fn world_corners(placed: &PlacedMesh<'_>, face: u32, origin: &Vector) -> [Vector; 3] {
    placed.mesh.corners(face).map(|corner| sub(&placed.world_from_mesh.apply(corner), origin))
}

/// Returns a face of a mesh in the frame of the search.
pub(super) fn world_face(placed: &PlacedMesh<'_>, face: u32, origin: &Vector) -> Face {
    Face::new(world_corners(placed, face, origin), placed.world_from_mesh.mirrors())
}

/// Returns a box of the search that holds a box of the mesh, given by center and half-extents.
pub(super) fn world_box(pose: &Pose, origin: &Vector, center: &Vector, half_extents: &Vector) -> [Vector; 2] {
    let center = sub(&pose.apply(*center), origin);
    let half: Vector =
        pose.linear().map(|row| row.iter().zip(half_extents).map(|(entry, half)| entry.abs() * half).sum());
    [sub(&center, &half), add(&center, &half)]
}

/// Returns the box about two boxes.
pub(super) fn joined(a: &[Vector; 2], b: &[Vector; 2]) -> [Vector; 2] {
    let corner =
        |end: usize, choose: fn(f64, f64) -> f64| std::array::from_fn(|axis| choose(a[end][axis], b[end][axis]));
    [corner(0, f64::min), corner(1, f64::max)]
}

/// Returns a factor by which a pose makes no length longer.
pub(super) fn stretch(pose: &Pose) -> f64 {
    pose.linear().iter().map(|row| dot(row, row)).sum::<f64>().sqrt()
}
