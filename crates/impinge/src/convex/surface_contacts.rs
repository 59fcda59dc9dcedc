//! The contacts of a mesh and a convex set: the contacts of the convex pieces of the touched part
//! of the surface.
//!
//! Faces that may touch the set are found through the tree. They are divided into convex pieces
//! (`piece`). Each piece has the contacts of two convex sets. Of these, the ones remain that are
//! not resolved by shallower ones (`piece::resolve`).
//!
//! # Source
//! Contacts with single triangles are known to be wrong at internal edges (ghost collisions). Catto
//! (*Box2D*, `b2_collide_edge.cpp`) and Rouwe (*Jolt*, active edges) classify edges in advance.
//! Here the neighborhood of the contact is one convex set.
//!
//! The tests are in `tests/it/shapes/mesh_contacts.rs` and `tests/it/shapes/surfaces.rs`.

use std::ops::ControlFlow::{self, Continue};

use super::distance::nearness;
use super::interval::{above, below};
use super::manifold::{Contact, Contacts, Faceted, contacts};
use super::overlap::Feature;
use super::piece::{Body, Found, OrientedFace, Touched, contacts_of_bodies, pieces, unresolved};
use super::posed::{Core, Pair, Swept, to_unit_length};
use super::surface::{Beside, Surface, corners_of_box};
use super::{Facets, HalfSpace};
use crate::budget::Budget;
use crate::math::vec3::{cross, dot, length, sub};
use crate::mesh::{FaceSearch, Faces};
use crate::primitive::closest_on_triangle;
use crate::volume::Proximity;

/// Depth that counts as none beside other contacts, relative to the size of the set: 2^-28.
const NO_DEPTH: f64 = 1.0 / (1 << 28) as f64;

/// Difference of two distances, in the common unit, that count as equal: 2^-36.
const SAME_DISTANCE: f64 = 1.0 / (1_u64 << 36) as f64;

impl Surface<'_> {
    /// Returns the contacts of this mesh, which comes first, with a convex set that is at most
    /// `margin` away, in world units. There is at least one if a face is that near. If the budget
    /// is spent, contacts are missing.
    pub(crate) fn contacts(&self, shape: &Faceted<'_>, margin: f64, budget: &Budget<'_>) -> Vec<Contacts> {
        let faces = self.touched(&shape.swept, margin);
        let touched = Touched::new(self.mesh, self.pose, &faces);
        let place = |piece| Body::of_piece(piece, &touched);
        let mut bodies: Vec<Body<'_>> = pieces(self.mesh, &faces, budget).into_iter().filter_map(place).collect();
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
            return self.deepest_of_faces(shape, margin, &faces).into_iter().collect();
        }
        let [min, max] = shape.swept.world_bounds();
        unresolved(found, [&bodies, &set], NO_DEPTH * length(&sub(&max, &min)))
    }

    /// Returns the contacts of the face with the deepest ones, of those that are not proved to be
    /// farther than `margin`. Faces without area are faces here.
    fn deepest_of_faces(&self, shape: &Faceted<'_>, margin: f64, faces: &[OrientedFace]) -> Option<Contacts> {
        let mut best: Option<Contacts> = None;
        for &OrientedFace { face, .. } in faces {
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
        self.touched(shape, margin).into_iter().map(|touched| touched.face).collect()
    }

    /// Returns all faces that are within `margin` of a convex set, and maybe others that are near,
    /// the nearest to the set's center first. Each is oriented as its corners are ordered if the
    /// mesh is solid, or else so that the center is outside. That is right for the nearest face,
    /// and `pieces` carries it over to the neighbors.
    fn touched(&self, shape: &Swept<'_>, margin: f64) -> Vec<OrientedFace> {
        let Some(corners) = self.mesh.local_bounds().map(corners_of_box) else { return Vec::new() };
        let bounds = Swept { core: Core::Points(&corners), pose: self.pose, radius: [0.0; 2] };
        let pair = Pair::new(&bounds, shape);
        let beside = Beside::new(&pair, shape.radius[1]);
        let radius = above(shape.radius[1] / pair.unit);
        let heights = ([0.0; 3], [0.0; 2]);
        let mut search = Touching { surface: self, pair: &pair, beside, radius, margin, heights, found: Vec::new() };
        self.mesh.search(&mut search);
        let mut found = search.found;
        found.sort_unstable_by(|x, y| x.away.total_cmp(&y.away).then(x.face.face.cmp(&y.face.face)));
        // Of the faces around the nearest corner or edge, the one whose plane is farthest from the
        // center tells its side (Ericson, *Real-Time Collision Detection*, 5.1.5).
        let mut start = 0;
        while start < found.len() {
            let run = found[start..].iter().take_while(|near| near.away <= found[start].away + SAME_DISTANCE).count();
            found[start..start + run].sort_by(|x, y| y.height.total_cmp(&x.height));
            start += run;
        }
        found.into_iter().map(|near| near.face).collect()
    }
}

/// Search for the faces that may touch a set.
struct Touching<'q> {
    surface: &'q Surface<'q>,
    pair: &'q Pair<'q>,
    beside: Beside<'q>,
    radius: f64,
    margin: f64,
    /// A direction, and the least and greatest height of the set along it.
    heights: ([f64; 3], [f64; 2]),
    found: Vec<Near>,
}

/// A face near a set.
struct Near {
    /// Distance of the face from the center of the set, in the common unit.
    away: f64,
    /// Distance of the face's plane from the center.
    height: f64,
    face: OrientedFace,
}

impl FaceSearch for Touching<'_> {
    fn bound(&self, center: &[f64; 3], half_extents: &[f64; 3]) -> f64 {
        self.beside.bound(center, half_extents)
    }

    fn cut(&self) -> f64 {
        self.margin
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let corners = self.surface.mesh.corners(face).map(|corner| self.pair.a.spot(corner).point);
        if self.beside.gap_of_points(&corners) > self.margin {
            return Continue(());
        }
        let area = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
        let turn = if self.surface.pose.mirrors() { -1.0 } else { 1.0 };
        let normal = to_unit_length(area.map(|x| turn * x));
        let [lowest, highest] = self.set_along(normal);
        let level = dot(&normal, &corners[0]);
        let (over, under) = (highest - level, level - lowest);
        let less = over.min(under);
        if area != [0.0; 3] && (below(less) + 16.0 * self.pair.height_error(normal)) * self.pair.unit < -self.margin {
            return Continue(());
        }
        let center = self.beside.center();
        let height = dot(&normal, &sub(&center, &corners[0]));
        let is_flipped = !self.surface.is_solid && height < 0.0;
        let away = closest_on_triangle(&center, &corners).distance;
        self.found.push(Near { away, height: height.abs(), face: OrientedFace { face, is_flipped } });
        Continue(())
    }
}

impl Touching<'_> {
    /// Returns the least and the greatest height of the set along a direction. Neighboring faces
    /// often have the same one.
    fn set_along(&mut self, direction: [f64; 3]) -> [f64; 2] {
        if self.heights.0 != direction {
            let height = |direction: [f64; 3]| dot(&direction, &self.pair.b.support(direction).point) + self.radius;
            self.heights = (direction, [-height(direction.map(|x| -x)), height(direction)]);
        }
        self.heights.1
    }
}

impl<F: Faces> Surface<'_, F> {
    /// Returns the contacts of a half-space, which comes first, with this mesh.
    pub(crate) fn contacts_with_half_space(&self, half_space: &HalfSpace<'_>, margin: f64) -> Vec<Contacts> {
        let contacts = half_space.contacts_of_surface(self, margin);
        if contacts.contacts.is_empty() { Vec::new() } else { vec![contacts] }
    }
}
