//! Pairs of faces of two meshes that are near each other, in connected groups.
//!
//! Each face of one mesh that is near the box of the other is searched for in the tree of the
//! other.

use super::{Region, connected};
use crate::budget::Budget;
use crate::convex::Surface;
use crate::mesh::PlacedMesh;

/// Pairs of faces that are connected by shared faces, and the regions of intersection among them.
pub(super) struct Group<'r> {
    pub(super) pairs: Vec<[u32; 2]>,
    pub(super) regions: Vec<&'r Region>,
}

/// Returns the pairs of faces that intersect, or are at most `margin` apart in world units, in
/// connected groups. The pairs of the given regions are among them. Some pairs may be a little
/// farther apart. If the budget is spent, pairs are missing.
///
/// # Complexity
/// O(n log m) for the n faces of one mesh that are near the box of the other mesh, which has m
/// faces. The mesh with fewer such faces is the first.
pub(super) fn groups_within<'r>(
    placed: [PlacedMesh<'_>; 2],
    regions: &'r [Region],
    margin: f64,
    budget: &Budget<'_>,
) -> Vec<Group<'r>> {
    let mut all: Vec<([u32; 2], Option<usize>)> = Vec::new();
    for (number, region) in regions.iter().enumerate() {
        all.extend(region.patch.pairs.iter().map(|&pair| (pair, Some(number))));
    }
    all.extend(pairs_within(placed, margin, budget).into_iter().map(|pair| (pair, None)));
    all.sort_unstable();
    all.dedup_by_key(|(pair, _)| *pair);
    let groups = connected(all, |(pair, _)| *pair).into_iter().map(|group| {
        let mut numbers: Vec<usize> = group.iter().filter_map(|&(_, number)| number).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let regions = numbers.into_iter().map(|number| &regions[number]).collect();
        Group { pairs: group.into_iter().map(|(pair, _)| pair).collect(), regions }
    });
    groups.collect()
}

fn pairs_within(placed: [PlacedMesh<'_>; 2], margin: f64, budget: &Budget<'_>) -> Vec<[u32; 2]> {
    let surfaces = placed.each_ref().map(|placed| {
        let PlacedMesh { mesh, world_from_mesh, .. } = placed;
        Surface { mesh: *mesh, pose: world_from_mesh, is_solid: false }
    });
    let faces = [0, 1].map(|side| surfaces[side].faces_near_box_of(&surfaces[1 - side], margin));
    let outer = usize::from(faces[1].len() < faces[0].len());
    let (surface, other) = (&surfaces[outer], &surfaces[1 - outer]);
    let mut found = Vec::new();
    for &face in &faces[outer] {
        if budget.is_spent() {
            break;
        }
        let pairs = other.faces_near_face_of(surface, face, margin).into_iter();
        found.extend(pairs.map(|near| if outer == 0 { [face, near] } else { [near, face] }));
    }
    found
}
