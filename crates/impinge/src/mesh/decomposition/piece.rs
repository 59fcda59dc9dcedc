//! The part of a solid in one cell, and how a plane divides it.
//!
//! The extreme points of the part of a solid S in a convex cell C are corners of C in S, and
//! corners of the polygons that C cuts out of the faces. Proof: an extreme point away from the
//! faces is one of C. Any other is on a face T, and an extreme point of the convex polygon T ∩ C.
//! So the cut surface needs no caps, and it may be any closed mesh.
//!
//! Proof: docs/notes/proof.md, L38. Guarded by `tests/it/solids/decomposition.rs`.

use super::cut_point::{CutPoint, Side, crosses};
use super::frame::{Cell, CutPlane, Frame};
use crate::exact::{PosedPoint, Spot};
use crate::math::vec3::{Vector, length};
use crate::mesh::Mesh;
use crate::mesh::solid::winding::{Containment, PointClassifier};

/// The part of a solid in one cell. A face that a plane crosses or touches may be in several
/// pieces.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    cell: Cell,
    /// Vertices of the mesh in the cell, in ascending order.
    vertices: Vec<u32>,
    /// Faces of the mesh that are completely in the cell.
    faces: Vec<u32>,
    /// Corners of the polygons that the cell cuts out of other faces, one polygon after the other.
    corners: Vec<CutPoint>,
    /// End of each polygon in `corners`.
    ends: Vec<usize>,
}

impl Piece {
    /// Returns the whole solid of a mesh.
    pub(super) fn whole(mesh: &Mesh) -> Self {
        let mut vertices = mesh.faces().as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let faces = (0..mesh.faces().len() as u32).collect();
        Self { faces, vertices, ..Self::empty(Cell::EVERYWHERE) }
    }

    fn empty(cell: Cell) -> Self {
        Self { cell, vertices: Vec::new(), faces: Vec::new(), corners: Vec::new(), ends: Vec::new() }
    }

    /// Iterates over the positions of the mesh vertices in the piece.
    pub(super) fn vertices(&self, mesh: &Mesh) -> impl Iterator<Item = Vector> {
        self.vertices.iter().map(|&vertex| vertex_of(mesh, vertex))
    }

    /// Returns points whose hull contains the piece. Returns an empty list if the piece is empty.
    pub(super) fn points(&self, mesh: &Mesh, frame: &Frame) -> Vec<CutPoint> {
        if self.faces.is_empty() && self.ends.is_empty() && !self.is_filled(mesh, frame) {
            return Vec::new();
        }
        let vertices = self.vertices(mesh).map(CutPoint::exact);
        let mut points: Vec<CutPoint> = vertices.chain(self.corners.iter().copied()).collect();
        let mut classifier = PointClassifier::new(mesh);
        points.extend(self.cell.corners(frame).filter(|corner| may_contain(&mut classifier, corner)));
        points
    }

    /// Reports whether a cell without faces in its interior is in the solid.
    fn is_filled(&self, mesh: &Mesh, frame: &Frame) -> bool {
        let mut classifier = PointClassifier::new(mesh);
        self.cell.middle(frame).is_some_and(|middle| may_contain(&mut classifier, &middle))
    }

    /// Returns the parts of the piece below and above a plane. A polygon in the plane belongs to
    /// the part behind it. Other polygons belong to a part only if they reach into its interior, so
    /// a wall that ends at the plane does not.
    pub(super) fn halves(&self, mesh: &Mesh, frame: &Frame, plane: CutPlane) -> [Self; 2] {
        let mut halves = self.cell.halves(plane).map(Self::empty);
        let side = |point: &CutPoint| frame.side(plane, point);
        for &face in &self.faces {
            let polygon = mesh.corners(face).map(CutPoint::exact);
            let sides = polygon.each_ref().map(side);
            if sides.iter().all(|side| side.is_on()) {
                halves[usize::from(!faces_up(&polygon, plane.axis))].faces.push(face);
                continue;
            }
            for (half, sides) in halves.iter_mut().zip([sides.map(Side::flipped), sides]) {
                if !sides.iter().any(|side| side.is_below()) {
                    half.faces.push(face);
                } else {
                    half.push_clipped(frame, plane, &polygon, &sides);
                }
            }
        }
        let mut start = 0;
        for &end in &self.ends {
            let polygon = &self.corners[start..end];
            start = end;
            let sides: Vec<Side> = polygon.iter().map(side).collect();
            if sides.iter().all(|side| side.is_on()) {
                let half = &mut halves[usize::from(!faces_up(polygon, plane.axis))];
                half.corners.extend_from_slice(polygon);
                half.ends.push(half.corners.len());
                continue;
            }
            let flipped: Vec<Side> = sides.iter().map(|side| side.flipped()).collect();
            for (half, sides) in halves.iter_mut().zip([flipped, sides]) {
                half.push_clipped(frame, plane, polygon, &sides);
            }
        }
        for half in &mut halves {
            half.vertices = half.faces.iter().flat_map(|&face| mesh.faces()[face as usize]).collect();
            half.vertices.sort_unstable();
            half.vertices.dedup();
        }
        halves
    }

    /// Adds the part of a convex polygon that is not below a plane, if it has a point above.
    ///
    /// Source: Sutherland and Hodgman, *Reentrant polygon clipping*, 1974. Corners whose side is
    /// not decided are kept, so the result contains the exact part.
    fn push_clipped(&mut self, frame: &Frame, plane: CutPlane, polygon: &[CutPoint], sides: &[Side]) {
        if sides.iter().all(|side| side.is_below() || side.is_on()) {
            return;
        }
        for at in 0..polygon.len() {
            let next = (at + 1) % polygon.len();
            if !sides[at].is_below() {
                self.corners.push(polygon[at]);
            }
            if crosses(sides[at], sides[next]) || crosses(sides[next], sides[at]) {
                self.corners.push(frame.crossing(plane, (&polygon[at], sides[at]), (&polygon[next], sides[next])));
            }
        }
        self.ends.push(self.corners.len());
    }
}

/// Reports whether a polygon across an axis is counterclockwise seen from above, by rounded areas.
fn faces_up(polygon: &[CutPoint], axis: usize) -> bool {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let local = |corner: &CutPoint| [corner.at[u] - polygon[0].at[u], corner.at[v] - polygon[0].at[v]];
    let area = |pair: &[CutPoint]| {
        let (a, b) = (local(&pair[0]), local(&pair[1]));
        a[0] * b[1] - a[1] * b[0]
    };
    polygon.windows(2).map(area).sum::<f64>() > 0.0
}

fn vertex_of(mesh: &Mesh, vertex: u32) -> Vector {
    // Adding zero turns -0 into 0.
    mesh.0.vertices.get(vertex as usize).map(|x| x + 0.0)
}

/// Reports whether the exact point may be in the solid. `false` is proved.
fn may_contain(classifier: &mut PointClassifier<'_>, point: &CutPoint) -> bool {
    let is_outside = classifier.containment(&PosedPoint::local(Spot::At(point.at))) == Containment::Outside;
    let is_far = || {
        // A point without faces near it is on the same side of the surface as the exact point.
        let nearest = classifier.mesh.closest_point(point.at);
        nearest.is_ok_and(|nearest| nearest.is_none_or(|nearest| nearest.lower > 2.0 * length(&point.error)))
    };
    !(is_outside && (point.is_exact() || is_far()))
}
