//! The contacts of two bodies, each a convex shape or a convex piece of a surface.
//!
//! The normal is that of the two convex sets. It is checked against the rest of the surface. If a
//! face beside the piece rises along the normal and fits the piece, the piece grows. So a way out
//! through the middle of a floor becomes longer until another way is shorter. If a face that does
//! not fit rises from a point of contact, there is no such contact: the surface is concave there,
//! and that face has a piece and a normal of its own. Then the normals of the piece's own faces are
//! tried.

use super::polytope::{Polytope, named};
use super::touched::Touched;
use super::{ALL_CORNERS, Connected, OrientedFace, Piece};
use crate::convex::along::Along;
use crate::convex::manifold::{Contacts, Faceted, contacts};
use crate::convex::posed::to_unit_length;
use crate::math::Pose;
use crate::math::vec3::{cross, dot, length, sub};

/// Maximum number of times that a piece grows for one contact. Shapes that are deep in a fine mesh
/// need more; they get the normal of one of the piece's faces.
const MAX_GROWTHS: usize = 16;

/// Minimum cosine of a normal with the normal of some face of a piece. Zero is needed for the
/// border of a surface.
const MIN_OUTWARD_COSINE: f64 = -1e-6;

/// Minimum cosine of two directions that count as the same: an angle of about 2^-15.
const SAME_DIRECTION_COSINE: f64 = 1.0 - 1.0 / (1_u64 << 31) as f64;

/// One of two bodies in contact.
pub(crate) enum Body<'b> {
    /// A convex shape.
    Convex(Faceted<'b>),
    /// A convex piece of a surface.
    Piece(Box<PlacedPiece<'b>>),
}

/// A convex piece of a surface in the world.
pub(crate) struct PlacedPiece<'b> {
    piece: Piece<'b>,
    polytope: Polytope,
    /// All faces of the surface that may be touched, in the world.
    touched: &'b Touched<'b>,
}

impl<'b> Body<'b> {
    /// Places a piece. Returns `None` if it has no hull.
    pub(crate) fn of_piece(piece: Piece<'b>, touched: &'b Touched<'b>) -> Option<Self> {
        let polytope = Polytope::of(&piece)?;
        Some(Self::Piece(Box::new(PlacedPiece { piece, polytope, touched })))
    }

    pub(super) fn faceted(&self) -> Faceted<'_> {
        match self {
            Self::Convex(shape) => *shape,
            Self::Piece(placed) => placed.polytope.faceted(placed.touched.pose()),
        }
    }

    /// Returns the normals of the faces of a piece, and none for a convex shape.
    fn face_normals(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Convex(_) => Vec::new(),
            Self::Piece(placed) => placed.face_normals(),
        }
    }

    /// Reports whether a direction leads out through the back of a piece.
    fn is_behind(&self, direction: &[f64; 3]) -> bool {
        matches!(self, Self::Piece(_))
            && self.face_normals().iter().all(|normal| dot(normal, direction) < MIN_OUTWARD_COSINE)
    }

    fn grow(&mut self, direction: &[f64; 3]) -> bool {
        match self {
            Self::Convex(_) => false,
            Self::Piece(placed) => placed.grow(direction),
        }
    }

    fn is_blocked(&self, direction: &[f64; 3], points: &[[f64; 3]]) -> Vec<bool> {
        match self {
            Self::Convex(_) => vec![false; points.len()],
            Self::Piece(placed) => placed.is_blocked(direction, points),
        }
    }
}

impl PlacedPiece<'_> {
    /// Returns the normals of the planes of faces, of length 1 in the world frame.
    fn face_normals(&self) -> Vec<[f64; 3]> {
        let [x, y, z] = *self.touched.pose().linear();
        let rows = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
        let sign = if self.touched.pose().mirrors() { -1.0 } else { 1.0 };
        let world = |normal: &[f64; 3]| to_unit_length(rows.each_ref().map(|row| sign * dot(row, normal)));
        self.piece.planes.iter().filter(|plane| plane.is_of_face).map(|plane| world(&plane.normal)).collect()
    }

    /// Returns a direction of the world as a covector of the mesh's frame.
    fn turned(&self, direction: &[f64; 3]) -> [f64; 3] {
        let linear = self.touched.pose().linear();
        std::array::from_fn(|j| (0..3).map(|k| linear[k][j] * direction[k]).sum())
    }

    /// Adds the faces that rise along a direction from the corners that are farthest along it, if
    /// they fit. Reports whether a face was added.
    fn grow(&mut self, direction: &[f64; 3]) -> bool {
        let along = self.turned(direction);
        let slack = self.piece.slack * length(&along);
        let Connected { mesh, first_at, .. } = self.piece.mesh;
        let base = self.piece.planes[0].base;
        let height = |point: &[f64; 3]| dot(&along, &sub(point, &base));
        let position = |vertex: u32| self.piece.mesh.position(vertex);
        let top = self.polytope.vertices().map(|vertex| height(&position(vertex))).fold(f64::NEG_INFINITY, f64::max);
        let highest: Vec<u32> =
            self.polytope.vertices().filter(|&vertex| height(&position(vertex)) >= top - slack).collect();
        let is_flipped = self.piece.faces[0].is_flipped;
        let mut has_grown = false;
        for vertex in highest {
            for &face in mesh.faces_at(first_at[vertex as usize]) {
                let rises = mesh.corners(face).iter().any(|corner| height(corner) > top + slack);
                if rises && !self.piece.has(face) {
                    has_grown |= self.piece.add(OrientedFace { face, is_flipped }, ALL_CORNERS).is_some();
                }
            }
        }
        if has_grown && let Some(polytope) = Polytope::of(&self.piece) {
            self.polytope = polytope;
        }
        has_grown
    }

    /// Reports for each of some contact points on this piece, in the world frame, whether a touched
    /// face that is not in the piece rises from it along a direction. No face rises along the
    /// normal of a face that counts.
    fn is_blocked(&self, direction: &[f64; 3], points: &[[f64; 3]]) -> Vec<bool> {
        let mut blocked = vec![false; points.len()];
        if self.face_normals().iter().any(|normal| dot(normal, direction) >= SAME_DIRECTION_COSINE) {
            return blocked;
        }
        for (point, is_blocked) in points.iter().zip(&mut blocked) {
            *is_blocked = self.touched.rises_from(point, direction, |face| !self.piece.has(face));
        }
        blocked
    }

    fn rename(&self, contacts: &mut Contacts, side: usize) {
        for contact in &mut contacts.contacts {
            let point = local(self.touched.pose(), &contact.points[side]);
            contact.features[side] = named(self.piece.mesh.mesh, contact.features[side], &point);
        }
    }
}

impl Piece<'_> {
    fn has(&self, face: u32) -> bool {
        self.faces.iter().any(|known| known.face == face)
    }
}

/// Returns a point of the world in the frame of a pose.
fn local(pose: &Pose, point: &[f64; 3]) -> [f64; 3] {
    let [x, y, z] = *pose.linear();
    let from = sub(point, pose.translation());
    let columns = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
    let determinant = dot(&x, &columns[0]);
    std::array::from_fn(|k| (0..3).map(|row| columns[row][k] * from[row]).sum::<f64>() / determinant)
}

/// Returns the contacts of two bodies that are at most `margin` apart, in world units. Returns
/// `None` if other pieces have all of their contacts.
pub(crate) fn contacts_of_bodies(a: &mut Body<'_>, b: &mut Body<'_>, margin: f64) -> Option<Contacts> {
    let mut found = by_shortest_way(a, b, margin).or_else(|| by_face_normals(a, b, margin))?;
    for (side, body) in [&*a, &*b].into_iter().enumerate() {
        if let Body::Piece(placed) = body {
            placed.rename(&mut found, side);
        }
    }
    Some(found)
}

fn by_shortest_way(a: &mut Body<'_>, b: &mut Body<'_>, margin: f64) -> Option<Contacts> {
    for _ in 0..MAX_GROWTHS {
        let mut found = contacts(&a.faceted(), &b.faceted(), margin);
        let (normal, opposite) = (found.normal, found.normal.map(|x| 0.0 - x));
        if a.is_behind(&normal) || b.is_behind(&opposite) {
            return None;
        }
        // Both grow, so that the answer is the same in either order.
        if a.grow(&normal) | b.grow(&opposite) {
            continue;
        }
        let on = |side: usize| -> Vec<[f64; 3]> { found.contacts.iter().map(|contact| contact.points[side]).collect() };
        let blocked = [a.is_blocked(&normal, &on(0)), b.is_blocked(&opposite, &on(1))];
        let mut number = 0..;
        found.contacts.retain(|_| number.next().is_some_and(|at: usize| !blocked[0][at] && !blocked[1][at]));
        return (!found.contacts.is_empty()).then_some(found);
    }
    None
}

/// Returns the contacts along the normal of a face of either body: the one along which the second
/// body has the shortest way out, of those along which the bodies lie over each other.
fn by_face_normals(a: &Body<'_>, b: &Body<'_>, margin: f64) -> Option<Contacts> {
    let opposite = b.face_normals().into_iter().map(|normal| normal.map(|x| 0.0 - x));
    let along = Along::new(&a.faceted(), &b.faceted());
    let depth = |normal| (along.depth(normal), normal);
    let mut ways: Vec<(f64, [f64; 3])> = a.face_normals().into_iter().chain(opposite).map(depth).collect();
    ways.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.partial_cmp(&y.1).unwrap_or(std::cmp::Ordering::Equal)));
    // Bodies that are apart along one normal have no contact along another.
    let is_apart = ways.first().is_some_and(|(depth, _)| *depth < -margin);
    let found = ways.into_iter().filter(|_| !is_apart);
    found.map(|(_, normal)| along.contacts(normal, margin)).find(|found| !found.contacts.is_empty())
}
