//! The contacts of the regions in which two meshes meet.

use std::collections::HashSet;

use super::{Met, Region, regions_of};
use crate::convex::{Contact, Contacts, Feature};
use crate::exact;
use crate::math::vec3::{cross, dot, sub};
use crate::mesh::{PlacedMesh, Ray};

/// The contacts of the regions in which two meshes meet: the vertices of either that are inside the other, over the face that is
/// there along the normal; where there are none, the ends of the curve's pieces, as deep as the region at most.
pub(crate) fn contacts_of_patches(a: PlacedMesh<'_>, b: PlacedMesh<'_>) -> Vec<Contacts> {
    let placed = [a, b];
    let of_region = |region: Region| {
        let patch = &region.patch;
        let mut contacts = Vec::new();
        for side in 0..2 {
            let (own, other) = (placed[side], placed[1 - side]);
            // Out of the other mesh: back along the normal for the first, along it for the second.
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

/// The points of a region's curve, by the corners, edges and faces that they are on.
fn contacts_of_curve(placed: [PlacedMesh<'_>; 2], Region { patch, met, linked }: &Region) -> Vec<Contact> {
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
    for (Met { pair: [a, b], crossing }, piece) in met.iter().zip(&linked.pieces) {
        for (joint, &end) in crossing.ends().zip(piece.ends()) {
            let point = linked.points[end];
            if known.insert(point.map(f64::to_bits)) {
                let features = [feature(0, *a, joint.on_a), feature(1, *b, joint.on_b)];
                contacts.push(Contact { points: [point; 2], lower: 0.0, upper: patch.depth, features });
            }
        }
    }
    if let (true, Some(&[a, b])) = (contacts.is_empty(), patch.pairs.first()) {
        // Faces in one plane whose borders do not meet are in each other: a corner of the first tells of them.
        let point = placed[0].world_from_mesh.apply(placed[0].mesh.corners(a)[0]);
        let features = [Feature::Face(a), Feature::Face(b)];
        contacts.push(Contact { points: [point; 2], lower: 0.0, upper: patch.depth, features });
    }
    contacts
}

/// What a ray's way and its start in another mesh's frame may be off by, next to their sizes: that of a ray, 2^-40, and of a pose that
/// is inverted.
const CAST_ERROR: f64 = 1.0 / (1_u64 << 38) as f64;

/// How far along a direction of length 1 a mesh's surface is from a point, and which face that is.
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
