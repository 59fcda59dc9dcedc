//! Which vertices of a mesh are inside another, as far as they hang together with the curves in which their surfaces meet.
//!
//! Along an edge that meets nothing of the other surface the winding number of a closed mesh stays what it is, so one corner tells for
//! the other. The faces that the curve goes through have such edges all along either side of it, and the faces that it does not go through
//! have no others: so a curve costs one exact question for each of its sides, however long it is.

use std::collections::HashMap;

use rayon::prelude::*;

use super::Met;
use crate::exact::{Corners, Crossing, Feature, Joint, Placement, PosedPoint, Spot};
use crate::math::vec3::sub;
use crate::mesh::{Containment, Judge, Mesh, PlacedMesh};

/// Questions below which threads cost more than they save.
const FEW: usize = 16;

/// A mesh beside another, with what is inside that where they meet.
pub(super) struct Interior<'m> {
    mesh: &'m Mesh,
    /// Which faces meet the other mesh.
    is_touched: Vec<bool>,
    /// Of those faces' corners, named by the first vertices at their positions, those inside, ascending.
    at_curves: Vec<u32>,
    /// The last region that each vertex was found for.
    found_for: Vec<u32>,
    /// How many regions were asked for.
    regions: u32,
}

impl<'m> Interior<'m> {
    /// Of the first mesh in the second (`side` 0), or the other way round (1), with all the pairs in which they meet.
    pub(super) fn new(placed: [PlacedMesh<'m>; 2], met: &[Met], side: usize) -> Self {
        let (own, other) = (placed[side], placed[1 - side]);
        let mesh = own.mesh;
        let mut is_touched = vec![false; mesh.faces().len()];
        met.iter().for_each(|met| is_touched[met.pair[side] as usize] = true);
        let placement = Placement::new(&other.world_from_mesh, &own.world_from_mesh);
        let groups = groups(mesh, edges_met(mesh, other.mesh, met, side));
        let is_inside = |judge: &mut Judge<'_>, group: &Vec<u32>| {
            let spot = Spot::At(mesh.positions().get(group[0] as usize));
            judge.containment(&PosedPoint::new(&placement, spot)) == Containment::Inside
        };
        let inside: Vec<bool> =
            groups.par_iter().with_min_len(FEW).map_init(|| Judge::new(other.mesh), is_inside).collect();
        let mut at_curves: Vec<u32> =
            groups.into_iter().zip(inside).filter(|(_, is_inside)| *is_inside).flat_map(|(group, _)| group).collect();
        at_curves.sort_unstable();
        Self { mesh, is_touched, at_curves, found_for: vec![0; mesh.positions().len()], regions: 0 }
    }

    /// The vertices inside the other mesh that hang together with these faces, which meet it, by faces that do not; ascending.
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

/// The faces that meet the other mesh, each with a bit for every edge that may meet it too: edge k runs from corner k to the next.
fn edges_met(mesh: &Mesh, other: &Mesh, met: &[Met], side: usize) -> HashMap<u32, u8> {
    const ALL: u8 = 0b111;
    // Round an open mesh the winding number passes one half off the surface too: there each vertex tells for itself.
    let start = if other.is_closed() { 0 } else { ALL };
    let mut edges = HashMap::new();
    for Met { pair, crossing } in met {
        let face = pair[side];
        // The parts of a face without area have several names, of which a crossing tells one.
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
            crossing => crossing.ends().fold(0, |met, end| met | of_end(on(end))),
        };
    }
    edges
}

/// The corners of some faces, in groups that edges join which meet nothing; sorted, so that nothing hangs on the order of a map.
fn groups(mesh: &Mesh, edges_met: HashMap<u32, u8>) -> Vec<Vec<u32>> {
    let first_at = &mesh.topology().first_at;
    let mut sets: HashMap<u32, u32> = HashMap::with_capacity(edges_met.len());
    for (face, met) in edges_met {
        let corners = mesh.faces()[face as usize].map(|vertex| first_at[vertex as usize]);
        for corner in corners {
            sets.entry(corner).or_insert(corner);
        }
        for edge in 0..3 {
            if met & 1 << edge == 0 {
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

/// The least member of a set, with path halving.
fn root(sets: &mut HashMap<u32, u32>, mut member: u32) -> u32 {
    while sets[&member] != member {
        let above = sets[&sets[&member]];
        sets.insert(member, above);
        member = above;
    }
    member
}

/// Whether a triangle is proved to have an area: some component of its normal is larger than its rounding.
fn surely_has_area([a, b, c]: &Corners) -> bool {
    let (e, f) = (sub(b, a), sub(c, a));
    (0..3).any(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (forward, backward) = (e[i] * f[j], e[j] * f[i]);
        // Each product is off by 2 u for its edges and u for itself, the difference by u; and what vanishes is below the least float.
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
