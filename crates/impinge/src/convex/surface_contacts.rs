//! The contacts of a mesh and a convex set: the contacts of the convex pieces of the touched part
//! of the surface.
//!
//! Faces that may touch the set are found through the tree (`near_faces`). They are divided into
//! convex pieces (`piece`). Each piece has the contacts of two convex sets. Of these, the ones
//! remain that are not resolved by shallower ones (`piece::resolve`).
//!
//! # Source
//! Contacts with single triangles are known to be wrong at internal edges (ghost collisions). Catto
//! (*Box2D*, `b2_collide_edge.cpp`) and Rouwe (*Jolt*, active edges) classify edges in advance.
//! Here the neighborhood of the contact is one convex set.
//!
//! The tests are in `tests/it/shapes/mesh_contacts.rs` and `tests/it/shapes/surfaces.rs`.

use super::beside::Beside;
use super::distance::nearness;
use super::manifold::{Contact, Contacts, Faceted, contacts};
use super::near_faces::NearestFirst;
use super::overlap::Feature;
use super::piece::{Body, Found, Seeds, Touched, contacts_of_bodies, pieces, unresolved};
use super::posed::{Core, Pair, Swept};
use super::surface::{Surface, corners_of_box};
use super::{Facets, HalfSpace};
use crate::budget::Budget;
use crate::math::vec3::{length, sub};
use crate::mesh::Faces;
use crate::volume::Proximity;

/// Depth that counts as none beside other contacts, relative to the size of the set: 2^-28.
const NO_DEPTH: f64 = 1.0 / (1 << 28) as f64;

impl Surface<'_> {
    /// Returns the contacts of this mesh, which comes first, with a convex set that is at most
    /// `margin` away, in world units. There is at least one if a face is that near. If the budget
    /// is spent, contacts are missing.
    pub(crate) fn contacts(&self, shape: &Faceted<'_>, margin: f64, budget: &Budget<'_>) -> Vec<Contacts> {
        let Some(corners) = self.mesh.local_bounds().map(corners_of_box) else { return Vec::new() };
        let bounds = Swept { core: Core::Points(&corners), pose: self.pose, radius: [0.0; 2] };
        let pair = Pair::new(&bounds, &shape.swept);
        let beside = Beside::new(&pair, shape.swept.radius[1]);
        let near = beside.near_faces(self, margin);
        let faces: Vec<u32> = near.iter().map(|near| near.face).collect();
        let touched = Touched::new(self.mesh, self.pose, &faces);
        let place = |piece| Body::of_piece(piece, &touched);
        let nearest = NearestFirst::new(self, &beside, near);
        let pieces = pieces(self.mesh, &faces, nearest, budget);
        let mut bodies: Vec<Body<'_>> = pieces.into_iter().filter_map(place).collect();
        let mut set = [Body::Convex(*shape)];
        let mut found = Vec::new();
        for (number, body) in bodies.iter_mut().enumerate() {
            if budget.is_spent() {
                break;
            }
            if let Some(contacts) =
                contacts_of_bodies(body, &mut set[0], margin).filter(|found| found.deepest() >= -margin)
            {
                found.push(Found { contacts, bodies: [number, 0] });
            }
        }
        if found.is_empty() && budget.stopped().is_none() {
            let mut nearest = NearestFirst::new(self, &beside, beside.near_faces(self, margin));
            let faces = std::iter::from_fn(|| nearest.next(&|_| false)).map(|seed| seed.face);
            return self.deepest_of_faces(shape, margin, faces).into_iter().collect();
        }
        let [min, max] = shape.swept.world_bounds();
        unresolved(found, [&bodies, &set], NO_DEPTH * length(&sub(&max, &min)))
    }

    /// Returns the contacts of the face with the deepest ones, of those that are not proved to be
    /// farther than `margin`. The first wins a tie. Faces without area are faces here.
    fn deepest_of_faces(&self, shape: &Faceted<'_>, margin: f64, faces: impl Iterator<Item = u32>) -> Option<Contacts> {
        let mut best: Option<Contacts> = None;
        for face in faces {
            let corners = self.mesh.corners(face);
            let swept = self.face(&corners);
            if nearness(&swept, &shape.swept, margin) == Proximity::Apart {
                continue;
            }
            let facets = Facets::of_points(&corners);
            let faceted = Faceted { swept, facets: facets.as_ref(), has_all_facets: false };
            let mut found = contacts(&faceted, shape, margin);
            let vertices = self.mesh.faces()[face as usize];
            let vertex = |corner: u32| vertices[corner as usize];
            for Contact { features, .. } in &mut found.contacts {
                features[0] = match features[0] {
                    Feature::Vertex(corner) => Feature::Vertex(vertex(corner)),
                    Feature::Edge(p, q) => Feature::Edge(vertex(p).min(vertex(q)), vertex(p).max(vertex(q))),
                    Feature::Face(_) => Feature::Face(face),
                };
            }
            if best.as_ref().is_none_or(|best| found.deepest() > best.deepest()) {
                best = Some(found);
            }
        }
        best
    }

    /// Returns the faces that are within `margin` of the box of another mesh, and maybe others that
    /// are near.
    pub(crate) fn faces_near_box_of(&self, other: &Self, margin: f64) -> Vec<u32> {
        let Some(corners) = other.mesh.local_bounds().map(corners_of_box) else { return Vec::new() };
        self.faces_near(&Swept { core: Core::Points(&corners), pose: other.pose, radius: [0.0; 2] }, margin)
    }

    /// Returns the faces that are within `margin` of a face of another mesh, and maybe others that
    /// are near.
    pub(crate) fn faces_near_face_of(&self, other: &Self, face: u32, margin: f64) -> Vec<u32> {
        self.faces_near(&other.face(&other.mesh.corners(face)), margin)
    }

    fn faces_near(&self, shape: &Swept<'_>, margin: f64) -> Vec<u32> {
        let Some(corners) = self.mesh.local_bounds().map(corners_of_box) else { return Vec::new() };
        let bounds = Swept { core: Core::Points(&corners), pose: self.pose, radius: [0.0; 2] };
        let pair = Pair::new(&bounds, shape);
        Beside::new(&pair, shape.radius[1]).near_faces(self, margin).into_iter().map(|near| near.face).collect()
    }
}

impl<F: Faces> Surface<'_, F> {
    /// Returns the contacts of a half-space, which comes first, with this mesh.
    pub(crate) fn contacts_with_half_space(&self, half_space: &HalfSpace<'_>, margin: f64) -> Vec<Contacts> {
        let contacts = half_space.contacts_of_surface(self, margin);
        if contacts.contacts.is_empty() { Vec::new() } else { vec![contacts] }
    }
}
