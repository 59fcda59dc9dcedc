//! Contacts of the regions in which two meshes intersect, or come near.
//!
//! On either side of a region are the faces that intersect the other mesh or are near it, and the
//! faces at the vertices that are inside it. They are divided into convex pieces. Two pieces of
//! which faces intersect or are near have the contacts of two convex sets.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::near::{Group, groups_within};
use super::{ContactPatch, PairCrossing, Region, regions_of};
use crate::budget::Budget;
use crate::convex::{
    Body, Contact, Contacts, Feature, Found, OrientedFace, Surface, Touched, contacts_of_bodies, pieces, unresolved,
};
use crate::exact;
use crate::math::vec3::{length, sub};
use crate::mesh::PlacedMesh;

/// Depth that counts as none beside other contacts, relative to the size of the smaller mesh:
/// 2^-28.
const NO_DEPTH: f64 = 1.0 / (1 << 28) as f64;

/// Returns the contacts of each region in which two meshes intersect, or are at most `margin`
/// apart, in world units. Each has one normal. Corners of faces must be in counterclockwise order
/// seen from outside.
///
/// A region that touches only with faces without area has a contact at each end of a piece of its
/// curve, whose depth is at most that of the region. If the budget is spent, contacts are missing.
pub(crate) fn contacts_of_patches(placed: [PlacedMesh<'_>; 2], margin: f64, budget: &Budget<'_>) -> Vec<Contacts> {
    let near = NO_DEPTH * size(&placed[0]).min(size(&placed[1]));
    let of_region = |region: &Region| {
        let ContactPatch { pairs, inside, normal, .. } = &region.patch;
        let found = of_pieces(placed, pairs, inside, [near, 0.0], budget);
        if !found.is_empty() {
            return found;
        }
        vec![Contacts { normal: *normal, contacts: contacts_of_curve(placed, region) }]
    };
    let regions = regions_of(placed, budget);
    if margin <= 0.0 {
        return regions.iter().flat_map(of_region).collect();
    }
    let of_group = |Group { pairs, regions }: Group<'_>| {
        let inside = [0, 1].map(|side| regions.iter().flat_map(|r| r.patch.inside[side].iter().copied()).collect());
        let found = of_pieces(placed, &pairs, &inside, [near, margin], budget);
        if found.is_empty() { regions.into_iter().flat_map(of_region).collect() } else { found }
    };
    groups_within(placed, &regions, margin, budget).into_iter().flat_map(of_group).collect()
}

fn size(placed: &PlacedMesh<'_>) -> f64 {
    let surface = Surface { mesh: placed.mesh, pose: &placed.world_from_mesh, is_solid: false };
    surface.world_bounds().map_or(0.0, |[min, max]| length(&sub(&max, &min)))
}

/// Returns the contacts of the convex pieces on either side of some pairs of faces, with the
/// vertices that are inside the other mesh. A depth of at most `near` counts as none.
fn of_pieces(
    placed: [PlacedMesh<'_>; 2],
    of_faces: &[[u32; 2]],
    inside: &[Vec<u32>; 2],
    [near, margin]: [f64; 2],
    budget: &Budget<'_>,
) -> Vec<Contacts> {
    let faces = [0, 1].map(|side| faces_of(placed[side], of_faces.iter().map(|pair| pair[side]), &inside[side]));
    let touched = [0, 1].map(|side| Touched::new(placed[side].mesh, &placed[side].world_from_mesh, &faces[side]));
    let mut piece_of: [HashMap<u32, usize>; 2] = Default::default();
    let mut bodies: [Vec<Body<'_>>; 2] = Default::default();
    for side in 0..2 {
        let seeds = faces[side].iter().map(|&face| OrientedFace { face, is_flipped: false });
        for piece in pieces(placed[side].mesh, &faces[side], seeds, budget) {
            let members: Vec<u32> = piece.faces().collect();
            if let Some(body) = Body::of_piece(piece, &touched[side]) {
                piece_of[side].extend(members.into_iter().map(|face| (face, bodies[side].len())));
                bodies[side].push(body);
            }
        }
    }
    let [of_a, of_b] = &piece_of;
    let mut pairs: BTreeSet<[usize; 2]> =
        of_faces.iter().filter_map(|[a, b]| Some([*of_a.get(a)?, *of_b.get(b)?])).collect();
    // A piece that is all inside the other mesh may be in contact with any of its pieces.
    for side in 0..2 {
        let crossed: HashSet<usize> = pairs.iter().map(|pair| pair[side]).collect();
        for inside in (0..bodies[side].len()).filter(|number| !crossed.contains(number)) {
            let others = 0..bodies[1 - side].len();
            pairs.extend(others.map(|other| if side == 0 { [inside, other] } else { [other, inside] }));
        }
    }
    let [bodies_a, bodies_b] = &mut bodies;
    let mut found = Vec::new();
    for [a, b] in pairs {
        if budget.is_spent() {
            break;
        }
        if let Some(contacts) = contacts_of_bodies(&mut bodies_a[a], &mut bodies_b[b], margin)
            && contacts.contacts.iter().any(|contact| contact.upper >= -margin)
        {
            found.push(Found { contacts, bodies: [a, b] });
        }
    }
    unresolved(found, [bodies_a, bodies_b], near)
}

/// Returns the faces of one side of a region, in ascending order: given ones, and those at the
/// vertices inside the other mesh.
fn faces_of(placed: PlacedMesh<'_>, faces: impl Iterator<Item = u32>, inside: &[u32]) -> Vec<u32> {
    let inside = inside.iter().flat_map(|&vertex| placed.mesh.faces_at(vertex).iter().copied());
    let mut faces: Vec<u32> = faces.chain(inside).collect();
    faces.sort_unstable();
    faces.dedup();
    faces
}

/// Returns the ends of the pieces of a region's curve as contacts, with the corners, edges and
/// faces that they lie on.
fn contacts_of_curve(placed: [PlacedMesh<'_>; 2], Region { patch, crossings, linked }: &Region) -> Vec<Contact> {
    let feature = |side: usize, face: u32, on: exact::Feature| {
        let vertices = placed[side].mesh.faces()[face as usize];
        match on {
            exact::Feature::Vertex(corner) => Feature::Vertex(vertices[usize::from(corner)]),
            exact::Feature::Edge(corner) => {
                let (from, to) = (vertices[usize::from(corner)], vertices[(usize::from(corner) + 1) % 3]);
                Feature::Edge(from.min(to), from.max(to))
            }
            exact::Feature::Face => Feature::Face(face),
        }
    };
    let mut known = HashSet::new();
    let mut contacts = Vec::new();
    for (PairCrossing { pair: [a, b], crossing }, piece) in crossings.iter().zip(&linked.pieces) {
        for (joint, &end) in crossing.ends().zip(piece.ends()) {
            let point = linked.points[end];
            if known.insert(point.map(f64::to_bits)) {
                let features = [feature(0, *a, joint.on_a), feature(1, *b, joint.on_b)];
                contacts.push(Contact { points: [point; 2], lower: 0.0, upper: patch.depth, features });
            }
        }
    }
    if let (true, Some(&[a, b])) = (contacts.is_empty(), patch.pairs.first()) {
        // Faces in one plane whose borders do not intersect contain each other: a corner of the
        // first face is a point of both.
        let point = placed[0].world_from_mesh.apply(placed[0].mesh.corners(a)[0]);
        let features = [Feature::Face(a), Feature::Face(b)];
        contacts.push(Contact { points: [point; 2], lower: 0.0, upper: patch.depth, features });
    }
    contacts
}
