//! Vertices of one mesh that are inside another, as far as they are connected to the intersection
//! curves.
//!
//! If an edge does not intersect the other surface, a closed mesh has the same winding number all
//! along the edge. So one end of the edge decides for the other. The faces that a curve goes
//! through have such edges all along each side of the curve, and all edges of the other faces are
//! such edges. So a curve takes one exact query for each of its sides, however long it is.
//!
//! Proof: see `query/patches/interior.rs` in docs/notes/proof.md. Tests:
//! `tests/it/solids/patches.rs`.

use std::collections::HashMap;

use rayon::prelude::*;

use super::PairCrossing;
use crate::budget::Budget;
use crate::exact::{Corners, Crossing, Feature, Joint, Placement, PosedPoint, Spot};
use crate::math::vec3::sub;
use crate::mesh::{Containment, Mesh, PlacedMesh, PointClassifier};

/// Minimum number of point queries that a thread takes at a time. With fewer queries, threads cost
/// more than they save.
const MIN_QUERIES_PER_TASK: usize = 16;

/// One of two intersecting meshes, with its vertices that are inside the other mesh.
pub(super) struct Interior<'m> {
    mesh: &'m Mesh,
    /// Whether each face intersects the other mesh.
    is_touched: Vec<bool>,
    /// Corners of those faces that are inside the other mesh, in ascending order. A corner is named
    /// by the first vertex at its position.
    at_curves: Vec<u32>,
    /// Number of the last region that each vertex was found for.
    found_for: Vec<u32>,
    /// Number of regions that were searched.
    regions: u32,
}

impl<'m> Interior<'m> {
    /// Finds the vertices at the curves that are inside: of the first mesh in the second if `side`
    /// is 0, and of the second in the first if it is 1. `crossings` must be all intersecting pairs.
    /// If the budget is spent, vertices are missing.
    pub(super) fn new(
        placed: [PlacedMesh<'m>; 2],
        crossings: &[PairCrossing],
        side: usize,
        budget: &Budget<'_>,
    ) -> Self {
        let (own, other) = (placed[side], placed[1 - side]);
        let mesh = own.mesh;
        let mut is_touched = vec![false; mesh.faces().len()];
        crossings.iter().for_each(|found| is_touched[found.pair[side] as usize] = true);
        let placement = Placement::new(&other.world_from_mesh, &own.world_from_mesh);
        let groups = groups(mesh, touched_edges(mesh, other.mesh, crossings, side));
        let is_inside = |classifier: &mut PointClassifier<'_>, group: &Vec<u32>| {
            if budget.is_spent() {
                return false;
            }
            let spot = Spot::At(mesh.positions().get(group[0] as usize));
            classifier.containment(&PosedPoint::new(&placement, spot)) == Containment::Inside
        };
        let inside: Vec<bool> = groups
            .par_iter()
            .with_min_len(MIN_QUERIES_PER_TASK)
            .map_init(|| PointClassifier::new(other.mesh), is_inside)
            .collect();
        let mut at_curves: Vec<u32> =
            groups.into_iter().zip(inside).filter(|(_, is_inside)| *is_inside).flat_map(|(group, _)| group).collect();
        at_curves.sort_unstable();
        Self { mesh, is_touched, at_curves, found_for: vec![0; mesh.positions().len()], regions: 0 }
    }

    /// Returns the vertices inside the other mesh that are connected to the given faces through
    /// faces that do not intersect the other mesh, in ascending order. The given faces intersect
    /// it.
    pub(super) fn of_region(&mut self, faces: impl Iterator<Item = u32>) -> Vec<u32> {
        self.regions += 1;
        let region = self.regions;
        let first_at = &self.mesh.topology().first_at;
        let corners = |face: u32| self.mesh.faces()[face as usize].map(|vertex| first_at[vertex as usize]);
        let mut inside = Vec::new();
        for vertex in faces.flat_map(corners) {
            if self.found_for[vertex as usize] != region && self.at_curves.binary_search(&vertex).is_ok() {
                self.found_for[vertex as usize] = region;
                inside.push(vertex);
            }
        }
        let mut next = 0;
        while let Some(&vertex) = inside.get(next) {
            next += 1;
            for &face in self.mesh.faces_at(vertex) {
                if self.is_touched[face as usize] {
                    continue;
                }
                for corner in corners(face) {
                    if self.found_for[corner as usize] != region {
                        self.found_for[corner as usize] = region;
                        inside.push(corner);
                    }
                }
            }
        }
        inside.sort_unstable();
        inside
    }
}

/// Returns the faces that intersect the other mesh, each with a bit for every edge that may
/// intersect it too. Edge k runs from corner k to the next.
fn touched_edges(mesh: &Mesh, other: &Mesh, crossings: &[PairCrossing], side: usize) -> HashMap<u32, u8> {
    const ALL: u8 = 0b111;
    // The winding number of an open mesh also passes one half away from its surface, so that each
    // vertex is checked by itself.
    let start = if other.is_closed() { 0 } else { ALL };
    let mut edges = HashMap::new();
    for PairCrossing { pair, crossing } in crossings {
        let face = pair[side];
        // The features of a face without area have several names, and a crossing holds one of them.
        let of_face =
            edges.entry(face).or_insert_with(|| if surely_has_area(&mesh.corners(face)) { start } else { ALL });
        let of_end = |on: Feature| match on {
            Feature::Vertex(corner) => 1 << corner | 1 << ((corner + 2) % 3),
            Feature::Edge(edge) => 1 << edge,
            Feature::Face => 0,
        };
        let on = |end: &Joint| if side == 0 { end.on_a } else { end.on_b };
        *of_face |= match crossing {
            Crossing::Coplanar => ALL,
            crossing => crossing.ends().fold(0, |edges, end| edges | of_end(on(end))),
        };
    }
    edges
}

/// Groups the corners of some faces. Edges that do not intersect the other mesh join corners. The
/// groups are sorted, so that the order of the map has no influence.
fn groups(mesh: &Mesh, touched_edges: HashMap<u32, u8>) -> Vec<Vec<u32>> {
    let first_at = &mesh.topology().first_at;
    let mut sets: HashMap<u32, u32> = HashMap::with_capacity(touched_edges.len());
    for (face, touched) in touched_edges {
        let corners = mesh.faces()[face as usize].map(|vertex| first_at[vertex as usize]);
        for corner in corners {
            sets.entry(corner).or_insert(corner);
        }
        for edge in 0..3 {
            if touched & 1 << edge == 0 {
                let (p, q) = (root(&mut sets, corners[edge]), root(&mut sets, corners[(edge + 1) % 3]));
                sets.insert(p.max(q), p.min(q));
            }
        }
    }
    let mut members: Vec<u32> = sets.keys().copied().collect();
    members.sort_unstable();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    let mut number_of = HashMap::new();
    for vertex in members {
        let number = *number_of.entry(root(&mut sets, vertex)).or_insert(groups.len());
        if number == groups.len() {
            groups.push(Vec::new());
        }
        groups[number].push(vertex);
    }
    groups
}

/// Returns the smallest member of a set, with path halving.
fn root(sets: &mut HashMap<u32, u32>, mut member: u32) -> u32 {
    while sets[&member] != member {
        let above = sets[&sets[&member]];
        sets.insert(member, above);
        member = above;
    }
    member
}

/// Reports whether a triangle is proved to have an area: some component of its normal is larger
/// than its rounding error.
fn surely_has_area([a, b, c]: &Corners) -> bool {
    let (e, f) = (sub(b, a), sub(c, a));
    (0..3).any(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (forward, backward) = (e[i] * f[j], e[j] * f[i]);
        // Each product has an error of 2 u for its edges and u for itself, and the difference adds
        // u; products that underflow are below the smallest normal float.
        (forward - backward).abs() > 8.0 * f64::EPSILON * (forward.abs() + backward.abs()) + f64::MIN_POSITIVE
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_is_proved_or_not() {
        assert!(surely_has_area(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]]));
        assert!(!surely_has_area(&[[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0]]));
        assert!(!surely_has_area(&[[0.1, 0.2, 0.3], [0.1, 0.2, 0.3], [3.0, 4.0, 5.0]]));
        assert!(!surely_has_area(&[[0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]]));
    }
}
