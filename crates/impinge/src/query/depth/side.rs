//! One solid of the search for a depth: its faces near the search, and which points are inside.

use std::ops::ControlFlow::{self, Continue};

use crate::exact::{Placement, PosedPoint, Spot};
use crate::math::Pose;
use crate::math::vec3::{Vector, add, cross, dot, sub, unit};
use crate::mesh::{Containment, FaceSearch, PlacedMesh, PointClassifier};
use crate::primitive::point_triangle;

/// A face in the frame of the search.
pub(super) struct Face {
    pub(super) corners: [Vector; 3],
    /// Unit normal, or `None` if the face has no area.
    pub(super) normal: Option<Vector>,
    pub(super) bounds: [Vector; 2],
}

/// A solid in the frame of the search: the world frame less an origin that is near both solids.
pub(super) struct Side<'m> {
    placed: PlacedMesh<'m>,
    /// Places points of the world in the frame of the mesh.
    placement: Placement,
    origin: Vector,
    /// The faces that may be within the margin of the box of the search.
    pub(super) faces: Vec<Face>,
    pub(super) is_closed: bool,
}

impl<'m> Side<'m> {
    /// Collects the faces of a solid within a margin of a box, which is in the frame of the search.
    pub(super) fn new(placed: PlacedMesh<'m>, origin: Vector, bounds: &[Vector; 2], margin: f64) -> Self {
        let mut near = Near { placed: &placed, origin, bounds, margin, found: Vec::new() };
        placed.mesh.search(&mut near);
        near.found.sort_unstable();
        let faces = near.found.iter().map(|&face| Face::new(world_corners(&placed, face, &origin))).collect();
        let placement = Placement::new(&placed.world_from_mesh, &Pose::IDENTITY);
        Self { placed, placement, origin, faces, is_closed: placed.mesh.is_closed() }
    }

    /// Returns the position of a point of the search relative to the solid. The point is rounded to
    /// the world's numbers.
    pub(super) fn containment(&self, point: &Vector) -> Containment {
        let world = add(point, &self.origin);
        PointClassifier::new(self.placed.mesh).containment(&PosedPoint::new(&self.placement, Spot::At(world)))
    }

    /// Returns the squared distance of a point from the nearest of some faces, the nearest point and
    /// the face.
    pub(super) fn nearest(&self, point: &Vector, faces: &[u32]) -> Option<(f64, Vector, u32)> {
        let mut best: Option<(f64, Vector, u32)> = None;
        for &face in faces {
            let (squared, foot) = point_triangle(point, &self.faces[face as usize].corners);
            if best.is_none_or(|(least, ..)| squared < least) {
                best = Some((squared, foot, face));
            }
        }
        best
    }
}

impl Face {
    fn new(corners: [Vector; 3]) -> Self {
        let normal = unit(&cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0])));
        let bounds = [f64::min, f64::max].map(|choose: fn(f64, f64) -> f64| {
            std::array::from_fn(|axis| choose(choose(corners[0][axis], corners[1][axis]), corners[2][axis]))
        });
        Self { corners, normal, bounds }
    }

    /// Returns the distance of a point from the face's plane, with a sign. A face without area has
    /// no plane.
    pub(super) fn height(&self, point: &Vector) -> Option<f64> {
        Some(dot(&self.normal?, &sub(point, &self.corners[0])))
    }
}

/// Returns the gap between two boxes: the largest difference along an axis, or a negative number if
/// they overlap.
pub(super) fn gap(a: &[Vector; 2], b: &[Vector; 2]) -> f64 {
    (0..3).map(|axis| (a[0][axis] - b[1][axis]).max(b[0][axis] - a[1][axis])).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the corners of a face in the world, less the origin.
fn world_corners(placed: &PlacedMesh<'_>, face: u32, origin: &Vector) -> [Vector; 3] {
    placed.mesh.corners(face).map(|corner| sub(&placed.world_from_mesh.apply(corner), origin))
}

/// Returns a box of the search that holds a box of the mesh, given by center and half-extents.
pub(super) fn world_box(pose: &Pose, origin: &Vector, center: &Vector, half_extents: &Vector) -> [Vector; 2] {
    let center = sub(&pose.apply(*center), origin);
    let half: Vector =
        pose.linear().map(|row| row.iter().zip(half_extents).map(|(entry, half)| entry.abs() * half).sum());
    [sub(&center, &half), add(&center, &half)]
}

/// A search for the faces near a box.
struct Near<'s, 'm> {
    placed: &'s PlacedMesh<'m>,
    origin: Vector,
    bounds: &'s [Vector; 2],
    margin: f64,
    found: Vec<u32>,
}

impl FaceSearch for Near<'_, '_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        gap(&world_box(&self.placed.world_from_mesh, &self.origin, center, half_extents), self.bounds)
    }

    fn cut(&self) -> f64 {
        self.margin
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let face_bounds = Face::new(world_corners(self.placed, face, &self.origin)).bounds;
        if gap(&face_bounds, self.bounds) <= self.margin {
            self.found.push(face);
        }
        Continue(())
    }
}
