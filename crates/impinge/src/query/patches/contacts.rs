//! Contacts of the regions in which two meshes intersect.

use std::collections::HashSet;

use super::{PairCrossing, Region, regions_of};
use crate::convex::{Contact, Contacts, Feature};
use crate::exact;
use crate::math::vec3::{cross, dot, sub};
use crate::mesh::{PlacedMesh, Ray};

/// Returns the contacts of each region in which two meshes intersect.
///
/// Each vertex of one mesh that is inside the other gives a contact with the face of the other mesh
/// that lies over it along the normal. A region without such vertices has a contact at each end of
/// a piece of its curve, whose depth is at most that of the region.
pub(crate) fn contacts_of_patches(a: PlacedMesh<'_>, b: PlacedMesh<'_>) -> Vec<Contacts> {
    let placed = [a, b];
    let of_region = |region: Region| {
        let patch = &region.patch;
        let mut contacts = Vec::new();
        for side in 0..2 {
            let (own, other) = (placed[side], placed[1 - side]);
            // The direction out of the other mesh: against the normal for the first mesh, along it
            // for the second.
            let out = if side == 0 { patch.normal.map(|x| -x) } else { patch.normal };
            for &vertex in &patch.inside[side] {
                let point = own.world_from_mesh.apply(own.mesh.positions().get(vertex as usize));
                let Some((t, face)) = cast(other, point, out) else { continue };
                let there = std::array::from_fn(|k| point[k] + t * out[k]);
                let slack = t * CAST_ERROR + point.iter().map(|x| x.abs()).sum::<f64>() * CAST_ERROR;
                let (mut points, mut features) = ([point, there], [Feature::Vertex(vertex), Feature::Face(face)]);
                if side == 1 {
                    points.swap(0, 1);
                    features.swap(0, 1);
                }
                contacts.push(Contact { points, lower: t - slack, upper: t + slack, features });
            }
        }
        if contacts.is_empty() {
            contacts = contacts_of_curve(placed, &region);
        }
        Contacts { normal: patch.normal, contacts }
    };
    regions_of(placed).into_iter().map(of_region).collect()
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

/// Bound on the relative error of the distance along a ray, 2^-38. It includes the error bound of a
/// ray, 2^-40, and the error of mapping the ray with the inverse of a pose. A smaller value would
/// make the intervals of depths wrong, a larger one would make them wider.
const CAST_ERROR: f64 = 1.0 / (1_u64 << 38) as f64;

/// Returns the distance from a point to a mesh's surface along a direction of length 1, with the
/// face there. Point and direction are in the world frame. Returns `None` if the ray hits nothing.
fn cast(placed: PlacedMesh<'_>, point: [f64; 3], direction: [f64; 3]) -> Option<(f64, u32)> {
    let [x, y, z] = *placed.world_from_mesh.linear();
    let columns = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
    let determinant = dot(&x, &columns[0]);
    let turn = |v: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|j| (columns[0][j] * v[0] + columns[1][j] * v[1] + columns[2][j] * v[2]) / determinant)
    };
    let ray = Ray::new(turn(&sub(&point, placed.world_from_mesh.translation())), turn(&direction)).ok()?;
    placed.mesh.ray_cast(&ray).map(|hit| (hit.t, hit.face))
}
