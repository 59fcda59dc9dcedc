//! Which faces are copies of another face: the same corners in the same order.
//!
//! Copies have equal distances from everything, so a search may skip all of them but the first.

use std::collections::HashMap;

use crate::hierarchy::{Child, Node};
use crate::mesh::storage::leaf::Leaf;
use crate::simd::LANES;

/// The faces without a copy of smaller index, and where they are in the tree.
#[derive(Debug)]
pub(crate) struct Copies {
    /// For each face the number of its copies, itself included, if it is the first; else zero.
    of_first: Vec<u32>,
    /// For each node the children below which there are first faces, as bits.
    lanes: Vec<u8>,
}

impl Copies {
    /// Finds the copies. `first_at` maps each vertex to the first vertex at its position.
    ///
    /// # Complexity
    /// O(n).
    pub(in crate::mesh) fn of(first_at: &[u32], faces: &[[u32; 3]], nodes: &[Node], leaves: &[Leaf]) -> Self {
        let mut of_first = vec![0; faces.len()];
        let mut first_with: HashMap<[u32; 3], u32> = HashMap::with_capacity(faces.len());
        for (number, face) in (0_u32..).zip(faces) {
            let first = *first_with.entry(face.map(|vertex| first_at[vertex as usize])).or_insert(number);
            of_first[first as usize] += 1;
        }
        let mut copies = Self { of_first, lanes: vec![0; nodes.len()] };
        // Children come after their parents.
        for (index, node) in nodes.iter().enumerate().rev() {
            for lane in 0..node.count() {
                let has_first = match node.child(lane) {
                    Child::Inner(child) => copies.lanes[child as usize] != 0,
                    Child::Leaf(leaf) => copies.first_lanes(&leaves[leaf as usize].faces) != 0,
                };
                copies.lanes[index] |= u8::from(has_first) << lane;
            }
        }
        copies
    }

    /// Reports whether there is a first face below a child of a node.
    #[inline]
    pub(crate) fn has_first(&self, node: u32, lane: u8) -> bool {
        self.lanes[node as usize] >> lane & 1 == 1
    }

    /// Returns the lanes of a leaf that hold a first face, as bits. Unused lanes may be among them.
    #[inline]
    pub(crate) fn first_lanes(&self, faces: &[u32; LANES]) -> u32 {
        (0..LANES).fold(0, |lanes, lane| {
            lanes | u32::from(self.of_first.get(faces[lane] as usize).is_some_and(|&count| count > 0)) << lane
        })
    }

    /// Returns the number of copies of a face, itself included, if it is the first; else zero.
    #[inline]
    pub(crate) fn count(&self, face: u32) -> usize {
        self.of_first[face as usize] as usize
    }
}
