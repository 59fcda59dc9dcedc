//! One solid of the search for a depth: its faces near the search, and which points are inside.

use std::ops::ControlFlow::{self, Continue};

use super::cell::{Cell, Plane};
use crate::exact::{Placement, PosedPoint, Spot};
use crate::math::Pose;
use crate::math::vec3::{Vector, add, cross, dot, sub, unit};
use crate::mesh::{Containment, FaceSearch, Mesh, PlacedMesh, PointClassifier};
use crate::primitive::point_triangle;

/// A face in the frame of the search.
pub(super) struct Face {
    pub(super) corners: [Vector; 3],
    /// Unit normal, or `None` if the face has no area.
    pub(super) normal: Option<Vector>,
    pub(super) bounds: [Vector; 2],
}

/// A flat part of the surface, in the frame of the search.
pub(super) struct Facet {
    /// The plane. The front of the facet is beyond it.
    pub(super) plane: Plane,
    /// Greatest distance of a corner from the plane.
    flatness: f64,
    pub(super) bounds: [Vector; 2],
    faces: Vec<u32>,
    /// The planes through the edges of the border, at right angles to the facet, with the ends of
    /// the edge. The facet is inside, near the edge.
    border: Vec<(Plane, [Vector; 2])>,
}

/// A solid in the frame of the search: the world frame less an origin that is near both solids.
pub(super) struct Side<'m> {
    placed: PlacedMesh<'m>,
    /// Places points of the world in the frame of the mesh.
    placement: Placement,
    origin: Vector,
    /// The faces that may be within the margin of the box of the search.
    pub(super) faces: Vec<Face>,
    /// The number of each face's flat part in the mesh. Equal numbers follow each other.
    pub(super) facet_of: Vec<u32>,
    /// The flat parts that these faces make up.
    pub(super) facets: Vec<Facet>,
    pub(super) is_closed: bool,
}

impl<'m> Side<'m> {
    /// Collects the faces of a solid within a margin of a box, which is in the frame of the search.
    pub(super) fn new(placed: PlacedMesh<'m>, origin: Vector, bounds: &[Vector; 2], margin: f64) -> Self {
        let mut near = Near { placed: &placed, origin, bounds, margin, found: Vec::new() };
        placed.mesh.search(&mut near);
        let of_face = &placed.mesh.facets().of_face;
        near.found.sort_unstable_by_key(|&(face, _)| (of_face[face as usize], face));
        let facet_of = near.found.iter().map(|&(face, _)| of_face[face as usize]).collect();
        let facets = near.found.chunk_by(|x, y| of_face[x.0 as usize] == of_face[y.0 as usize]);
        let mut start = 0;
        let facets = facets.filter_map(|faces| {
            start += faces.len() as u32;
            Facet::new(placed.mesh, faces, start - faces.len() as u32)
        });
        let facets = facets.collect();
        let placement = Placement::new(&placed.world_from_mesh, &Pose::IDENTITY);
        let faces = near.found.into_iter().map(|(_, face)| face).collect();
        Self { placed, placement, origin, faces, facet_of, facets, is_closed: placed.mesh.is_closed() }
    }

    /// Returns the position of a point of the search relative to the solid. The point is rounded to
    /// the world's numbers.
    pub(super) fn containment(&self, point: &Vector) -> Containment {
        let world = add(point, &self.origin);
        PointClassifier::new(self.placed.mesh).containment(&PosedPoint::new(&self.placement, Spot::At(world)))
    }

    /// Returns the squared distance of a point from the nearest of some faces, the nearest point
    /// and the face.
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

    /// Reports whether all points of a cell are over a facet: their feet in its plane are in it.
    pub(super) fn is_over(&self, facet: &Facet, cell: &Cell, slack: f64) -> bool {
        let center = cell.center();
        facet.edge_below(cell, slack).is_none()
            && facet.faces.iter().any(|&face| self.faces[face as usize].is_below(&center, slack))
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

    /// Returns the plane through an edge, at right angles to the face, with the face inside.
    fn edge_plane(&self, edge: usize) -> Option<Plane> {
        let (from, to) = (self.corners[edge], self.corners[(edge + 1) % 3]);
        let normal = unit(&cross(&sub(&to, &from), &self.normal?))?;
        Some(Plane { normal, height: dot(&normal, &from) })
    }

    /// Reports whether the foot of a point in the face's plane is in the face.
    fn is_below(&self, point: &Vector, slack: f64) -> bool {
        (0..3).all(|edge| self.edge_plane(edge).is_some_and(|plane| plane.beyond(point) <= slack))
    }
}

impl Facet {
    /// Returns the facet of some faces, which have consecutive numbers from `first` on in the
    /// search. Faces without area have none.
    fn new(mesh: &Mesh, faces: &[(u32, Face)], first: u32) -> Option<Self> {
        let area = |face: &Face| {
            let [p, q, r] = face.corners;
            let normal = cross(&sub(&q, &p), &sub(&r, &p));
            dot(&normal, &normal)
        };
        let largest = faces.iter().max_by(|x, y| area(&x.1).total_cmp(&area(&y.1)))?;
        let normal = largest.1.normal?;
        let plane = Plane { normal, height: dot(&normal, &largest.1.corners[0]) };
        let mut bounds = largest.1.bounds;
        let (mut flatness, mut border) = (0.0_f64, Vec::new());
        for (number, face) in faces {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(face.bounds[0][axis]);
                bounds[1][axis] = bounds[1][axis].max(face.bounds[1][axis]);
            }
            flatness = face.corners.iter().fold(flatness, |most, corner| most.max(plane.beyond(corner).abs()));
            for edge in (0..3).filter(|&edge| mesh.is_border_of_facet(*number, edge)) {
                let ends = [face.corners[edge], face.corners[(edge + 1) % 3]];
                border.extend(face.edge_plane(edge).map(|plane| (plane, ends)));
            }
        }
        let faces = (first..first + faces.len() as u32).collect();
        Some(Self { plane, flatness, bounds, faces, border })
    }

    /// Returns the greatest distance of a point of a cell from the facet's plane, and more if the
    /// facet is not flat.
    pub(super) fn height(&self, cell: &Cell) -> f64 {
        cell.corners().map(|corner| self.plane.beyond(corner).abs()).fold(0.0, f64::max) + self.flatness
    }

    /// Returns the plane through an edge of the border that may divide the feet of a cell's points,
    /// or `None` if no edge does. Of several it is the one that divides the cell most evenly.
    pub(super) fn edge_below(&self, cell: &Cell, slack: f64) -> Option<Plane> {
        let mut best: Option<(f64, Plane)> = None;
        for (plane, ends) in &self.border {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for corner in cell.corners() {
                let beyond = plane.beyond(corner);
                (low, high) = (low.min(beyond), high.max(beyond));
            }
            let evenness = high.min(-low);
            if evenness <= slack || best.is_some_and(|(most, _)| evenness <= most) {
                continue;
            }
            if !self.is_beside(cell, ends) {
                best = Some((evenness, *plane));
            }
        }
        best.map(|(_, plane)| plane)
    }

    /// Reports whether an edge of the border is known to be beside the feet of a cell's points.
    fn is_beside(&self, cell: &Cell, ends: &[Vector; 2]) -> bool {
        let along = sub(&ends[1], &ends[0]);
        let (from, to) = (dot(&along, &ends[0]), dot(&along, &ends[1]));
        let places = || cell.corners().map(|corner| dot(&along, corner));
        if places().all(|at| at <= from) || places().all(|at| at >= to) {
            return true;
        }
        let height = cell.corners().map(|corner| self.plane.beyond(corner).abs()).fold(0.0, f64::max);
        // A foot is as far from its point as the point is high.
        let is_beyond = |plane: &Plane| {
            let shift = height * dot(&plane.normal, &self.plane.normal).abs();
            ends.iter().all(|end| plane.beyond(end) >= shift)
        };
        cell.planes().any(is_beyond)
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
    found: Vec<(u32, Face)>,
}

impl FaceSearch for Near<'_, '_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        gap(&world_box(&self.placed.world_from_mesh, &self.origin, center, half_extents), self.bounds)
    }

    fn cut(&self) -> f64 {
        self.margin
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let found = Face::new(world_corners(self.placed, face, &self.origin));
        if gap(&found.bounds, self.bounds) <= self.margin {
            self.found.push((face, found));
        }
        Continue(())
    }
}
