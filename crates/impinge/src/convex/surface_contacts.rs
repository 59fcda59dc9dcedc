//! The contacts of a mesh and a convex set: contacts of the faces near the set, merged by their
//! normals.
//!
//! A face alone does not know its neighbors: the shortest way out of a floor's triangle may lead
//! sideways, through the next triangle. So the normal of a face's contact is used only if no face
//! at the touched corners reaches farther along it. Otherwise the face's own normal is used, and
//! only the part of the set over the face counts. Corners inside the set belong to faces that
//! intersect it, so all faces at these corners have been found.
//!
//! # Source
//! The problem is known as internal edges, or ghost collisions. Catto (*Box2D*,
//! `b2_collide_edge.cpp`) and Rouwe (*Jolt*, active edges) classify edges in advance; here corners
//! are examined when they are touched.
//!
//! The tests are in `tests/it/shapes/surfaces.rs`, among them
//! `contacts_on_a_floor_of_triangles_have_one_normal`.

use std::collections::HashMap;

use super::manifold::{Contact, Contacts, Faceted, contacts, contacts_along};
use super::overlap::Feature;
use super::posed::to_unit_length;
use super::surface::Surface;
use super::{Facets, HalfSpace};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{cross, dot, sub};

/// Minimum cosine of the angle between normals that count as one: 2.5 degrees.
const SAME_NORMAL_COSINE: f64 = 1.0 - 1.0 / 1_024.0;

/// Touched positions of a mesh, by the bits of their coordinates, with their faces. Duplicate
/// vertices are one position.
type Corners = HashMap<[u64; 3], Vec<u32>>;

impl Surface<'_> {
    /// Returns the contacts of this mesh, which comes first, with a convex set that is at most
    /// `margin` away, in world units. There is at least one if the set is that near.
    pub(crate) fn contacts(&self, shape: &Faceted<'_>, margin: f64) -> Vec<Contacts> {
        let faces = self.faces_within(&shape.swept, margin);
        let mut about: Corners = HashMap::new();
        for &face in &faces {
            for corner in self.mesh.corners(face) {
                about.entry(key(&corner)).or_default().push(face);
            }
        }
        let mut found: Vec<Contacts> = Vec::new();
        let mut alone: Option<Contacts> = None;
        for &face in &faces {
            let corners = self.mesh.corners(face);
            let facets = Facets::of_points(&corners);
            let faceted = Faceted { swept: self.face(&corners), facets: facets.as_ref() };
            let mut of_face = contacts(&faceted, shape, margin);
            let is_outermost = self.is_outermost(&about, &corners, &of_face.normal);
            if !is_outermost {
                let outward = self.normal_towards(&corners, &of_face.normal);
                let own = outward.map(|normal| contacts_along(&faceted, shape, normal, margin));
                if alone.as_ref().is_none_or(|alone| deepest(&of_face) > deepest(alone)) {
                    alone = Some(self.renamed(of_face, face));
                }
                let Some(own) = own.filter(|own| !own.contacts.is_empty()) else { continue };
                of_face = own;
            }
            merge(&mut found, self.renamed(of_face, face));
        }
        if found.is_empty() { alone.into_iter().collect() } else { found }
    }

    /// Returns the contacts of a half-space, which comes first, with this mesh.
    pub(crate) fn contacts_with_half_space(&self, half_space: &HalfSpace<'_>, margin: f64) -> Vec<Contacts> {
        let mut found: Vec<Contacts> = Vec::new();
        for (face, contacts) in half_space.contacts_of_surface(self, margin) {
            merge(&mut found, self.renamed(contacts.swapped(), face));
        }
        found.into_iter().map(Contacts::swapped).collect()
    }

    /// Reports whether no face reaches farther along a direction than this face. Only the faces at
    /// the corners that reach farthest are compared.
    fn is_outermost(&self, about: &Corners, corners: &[[f64; 3]; 3], direction: &[f64; 3]) -> bool {
        let world = corners.map(|corner| self.pose.apply(corner));
        let heights = world.map(|corner| dot(direction, &corner));
        let highest = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        // A slightly higher corner does not count, as in a floor whose corners were rounded.
        let size = (0..3).map(|k| (world[1][k] - world[0][k]).abs() + (world[2][k] - world[0][k]).abs()).sum::<f64>();
        let far = world.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
        let slack = size / 1_024.0 + 64.0 * UNIT_ROUNDOFF * far;
        let touched = corners.iter().zip(heights).filter(|(_, height)| *height >= highest - slack);
        touched.into_iter().all(|(corner, _)| {
            about.get(&key(corner)).into_iter().flatten().all(|&face| {
                let others = self.mesh.corners(face).map(|corner| dot(direction, &self.pose.apply(corner)));
                others.iter().all(|&height| height <= highest + slack)
            })
        })
    }

    /// Returns the normal of a face in the world frame. It points outwards if the mesh is solid,
    /// otherwise to the side of `direction`. Returns `None` for a face without area.
    fn normal_towards(&self, corners: &[[f64; 3]; 3], direction: &[f64; 3]) -> Option<[f64; 3]> {
        let [p, q, r] = corners.map(|corner| self.pose.apply(corner));
        let area = cross(&sub(&q, &p), &sub(&r, &p));
        if area == [0.0; 3] {
            return None;
        }
        let normal = to_unit_length(area);
        let is_turned = if self.is_solid { self.pose.mirrors() } else { dot(&normal, direction) < 0.0 };
        Some(if is_turned { normal.map(|x| 0.0 - x) } else { normal })
    }

    /// Renames the features of a triangle to features of the mesh: its vertices, its edges by
    /// vertices, and the face.
    fn renamed(&self, mut contacts: Contacts, face: u32) -> Contacts {
        let vertices = self.mesh.faces()[face as usize];
        let vertex = |corner: u32| vertices[corner as usize];
        for contact in &mut contacts.contacts {
            contact.features[0] = match contact.features[0] {
                Feature::Vertex(corner) => Feature::Vertex(vertex(corner)),
                Feature::Edge(from, to) => Feature::Edge(vertex(from).min(vertex(to)), vertex(from).max(vertex(to))),
                Feature::Face(_) => Feature::Face(face),
            };
        }
        contacts
    }
}

/// Adds contacts to the contacts with the same normal. Of contacts in one place the deepest stays;
/// the first wins a tie.
fn merge(found: &mut Vec<Contacts>, of_face: Contacts) {
    let Some(same) = found.iter_mut().find(|known| dot(&known.normal, &of_face.normal) >= SAME_NORMAL_COSINE) else {
        found.push(of_face);
        return;
    };
    if deepest(&of_face) > deepest(same) {
        same.normal = of_face.normal;
    }
    for contact in of_face.contacts {
        let is_there =
            |known: &&mut Contact| known.features == contact.features || known.points[1] == contact.points[1];
        match same.contacts.iter_mut().find(is_there) {
            Some(known) if contact.upper > known.upper => *known = contact,
            Some(_) => {}
            None => same.contacts.push(contact),
        }
    }
}

fn deepest(contacts: &Contacts) -> f64 {
    contacts.contacts.iter().map(|contact| contact.upper).fold(f64::NEG_INFINITY, f64::max)
}

fn key(corner: &[f64; 3]) -> [u64; 3] {
    // Zeros of either sign are one position.
    corner.map(|x| (x + 0.0).to_bits())
}
