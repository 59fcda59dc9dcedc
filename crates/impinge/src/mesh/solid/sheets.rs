//! The faces that a winding number depends on, and the sheets that they form along shared edges
//! (docs/notes/proof.md, L19).
//!
//! A face without area adds nothing to any winding number. Faces with the same three corners add
//! nothing either if as many of them turn one way as the other. Such faces are the shared walls of
//! bodies that touch each other in one mesh, or membranes without thickness. All other faces
//! *count*. The winding numbers on both sides of a face that counts differ, unless other faces of
//! the mesh overlap it in part.
//!
//! A sheet is a set of faces that count and are connected along edges. Faces that share only a
//! vertex are not connected, because a contact with the other mesh in that vertex would separate
//! them.
//!
//! Guarded by `tests/it/solids/bricks.rs`.

use rayon::prelude::*;

use crate::budget::Budget;
use crate::exact::{Corners, PosedPoint, Spot};
use crate::math::Sign;
use crate::math::vec3::{cross, sub};
use crate::mesh::Mesh;
use crate::mesh::derived::topology::{Components, DisjointSets};

/// Number of faces between two checks of the budget.
const FACES_PER_CHECK: u32 = 1 << 9;

impl Mesh {
    /// Returns the names of a face's corners. The name of a corner is the first vertex at its
    /// position.
    pub(crate) fn corner_names(&self, face: u32) -> [u32; 3] {
        let first_at = &self.topology().first_at;
        self.faces()[face as usize].map(|vertex| first_at[vertex as usize])
    }

    /// Returns the name of an edge of a face: the names of its ends, the lesser one first.
    /// `corners` are the two corners of the edge.
    pub(crate) fn edge_name(&self, face: u32, corners: [usize; 2]) -> [u32; 2] {
        let names = self.corner_names(face);
        let [p, q] = corners.map(|corner| names[corner]);
        [p.min(q), p.max(q)]
    }

    /// Returns all faces of the mesh at an edge that count, in ascending order.
    ///
    /// # Complexity
    /// Linear in the faces at the end of the edge that has fewer faces.
    pub(crate) fn faces_at_edge(&self, edge: [u32; 2]) -> impl Iterator<Item = u32> {
        self.faces_with(edge).filter(|&face| self.counts(face))
    }

    /// Reports whether winding numbers depend on a face: it has area, and no faces with the same
    /// corners cancel it.
    ///
    /// # Complexity
    /// Linear in the faces at the corner that has the fewest faces.
    pub(crate) fn counts(&self, face: u32) -> bool {
        let names = self.corner_names(face);
        let net: i64 = self.faces_with(names).map(|other| parity(self.corner_names(other))).sum();
        net != 0 && turn_along_some_axis(&self.corners(face)).is_some()
    }

    /// Returns the sheets of the mesh, or `None` if the budget ended the computation. A face that
    /// does not count is in no sheet.
    ///
    /// # Complexity
    /// About linear in the faces the first time, then constant.
    pub(crate) fn sheets(&self, budget: &Budget<'_>) -> Option<&Components> {
        let slot = &self.0.derived.sheets;
        // No lock is held during the computation. A thread that waits in the parallel loop may
        // start another task that needs this slot, and would deadlock.
        if slot.get().is_none() {
            let _ = slot.set(self.connected_along_edges(budget)?);
        }
        slot.get()
    }

    fn connected_along_edges(&self, budget: &Budget<'_>) -> Option<Components> {
        let faces = self.faces().len() as u32;
        let must_end = |face: u32| face.is_multiple_of(FACES_PER_CHECK) && budget.is_spent();
        let counts = (0..faces).into_par_iter().map(|face| (!must_end(face)).then(|| self.counts(face)));
        let counts: Vec<bool> = counts.collect::<Option<_>>()?;
        let mut sets = DisjointSets::new(faces as usize);
        for face in 0..faces {
            if must_end(face) {
                return None;
            }
            for corner in (0..3).filter(|_| counts[face as usize]) {
                let edge = self.edge_name(face, [corner, (corner + 1) % 3]);
                let first = self.faces_with(edge).find(|&other| counts[other as usize]);
                sets.join(face, first.unwrap_or(face));
            }
        }
        let roots = (0..faces).map(|face| counts[face as usize].then(|| sets.root(face)));
        Some(Components::numbered(faces as usize, roots))
    }

    /// Returns all faces that have all these corner names and three different corner names, in
    /// ascending order.
    fn faces_with<const N: usize>(&self, names: [u32; N]) -> impl Iterator<Item = u32> {
        let lists = names.map(|name| self.faces_at(name));
        let shortest = lists.into_iter().min_by_key(|list| list.len()).unwrap_or_default();
        shortest.iter().copied().filter(move |&face| {
            let corners = self.corner_names(face);
            parity(corners) != 0 && names.iter().all(|name| corners.contains(name))
        })
    }
}

/// Returns 1 if the names are an even permutation of their ascending order, -1 if they are an odd
/// one, and 0 if two are equal.
fn parity([a, b, c]: [u32; 3]) -> i64 {
    let sign = |x: u32, y: u32| i64::from(x < y) - i64::from(x > y);
    sign(a, b) * sign(b, c) * sign(a, c)
}

/// Returns an axis and how the corners of a face turn, looking against that axis. It is the axis
/// along which the face appears largest, or another axis if the face appears as a line there.
/// Returns `None` if the face has no area.
pub(super) fn turn_along_some_axis(corners: &Corners) -> Option<(usize, Sign)> {
    let seen = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0])).map(f64::abs);
    let mut axes = [0, 1, 2];
    axes.sort_by(|&x, &y| seen[y].total_cmp(&seen[x]));
    axes.into_iter().find_map(|axis| match turn(corners, axis) {
        Sign::Zero => None,
        turn => Some((axis, turn)),
    })
}

/// Returns how the corners of a face turn, looking against an axis: positive if they are
/// counterclockwise.
pub(in crate::mesh) fn turn([a, b, c]: &Corners, axis: usize) -> Sign {
    PosedPoint::local(Spot::At(*c)).beside(axis, a, b)
}
