//! Validates the structure of trees that were read from bytes. Every descent relies on this
//! structure. Builders always produce it.

use super::binary::MAX_DEPTH;
use super::wide::{LEAF_BIT, Node, WideTree};
use crate::simd::LANES;

impl WideTree {
    /// Reports whether the nodes form a valid tree with `leaves` leaves:
    /// - The nodes are in preorder, and each node but the root is the child of one node.
    /// - The children of a node are all nodes or all leaves.
    /// - No node is deeper than [`MAX_DEPTH`] and one more.
    /// - The leaves are `0..leaves` in that order.
    ///
    /// It does not validate boxes and slabs.
    ///
    /// # Complexity
    /// Linear, for any nodes.
    pub(crate) fn is_sound(&self, leaves: usize) -> bool {
        let nodes = self.nodes();
        if nodes.is_empty() {
            return leaves == 0;
        }
        // The children that must still come, each with its depth, the next one last.
        let mut awaited = vec![(0_u32, 0_usize)];
        let mut leaves_so_far = 0;
        for (at, node) in nodes.iter().enumerate() {
            let Some((expected, depth)) = awaited.pop() else { return false };
            // A wide tree may be one level deeper than the binary one, because a single leaf has a
            // node of its own.
            if expected as usize != at || depth > MAX_DEPTH || !node.is_well_formed() {
                return false;
            }
            if node.holds_leaves() {
                let is_next = |lane: usize| node.index(lane) as usize == leaves_so_far + lane;
                if !(0..LANES).fold(true, |all, lane| all & (is_next(lane) | (lane >= node.count()))) {
                    return false;
                }
                leaves_so_far += node.count();
            } else {
                awaited.extend((0..node.count()).rev().map(|lane| (node.index(lane), depth + 1)));
            }
        }
        awaited.is_empty() && leaves_so_far == leaves
    }
}

impl Node {
    /// Reports whether the lanes and references are as the collapse leaves them. The number of used
    /// lanes is unpredictable, so there is no branch on it.
    fn is_well_formed(&self) -> bool {
        let is_leaf = |lane: usize| self.references[lane] & LEAF_BIT;
        let is_empty = |lane: usize| {
            (0..3).fold(self.references[lane] == 0, |all, axis| {
                all & (self.min[axis][lane] == f32::INFINITY) & (self.max[axis][lane] == f32::NEG_INFINITY)
            })
        };
        let are_as_left = (0..LANES).fold(true, |all, lane| {
            let is_in_use = lane < self.count as usize;
            all & ((is_in_use & (is_leaf(lane) == is_leaf(0))) | (!is_in_use & is_empty(lane)))
        });
        are_as_left & (1..=LANES as u32).contains(&self.count) & (self.reserved == Self::EMPTY.reserved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Builder;
    use crate::volume::Aabb;
    use impinge_testkit::generate::Rng;

    #[test]
    fn built_trees_are_sound_and_corrupted_nodes_are_not() {
        let mut rng = Rng::new(71);
        let mut boxes_not_in_use = 0;
        let boxes: Vec<Aabb> = (0..3_000)
            .map(|_| {
                let min = [0; 3].map(|_| rng.integer(0, 40) as f32);
                Aabb { min, max: min.map(|x| x + 1.0) }
            })
            .collect();
        for builder in Builder::ALL {
            let (tree, leaves) = WideTree::collapse(&builder.build(&boxes));
            assert!(tree.is_sound(leaves.len()), "{}", builder.name());
            assert!(!tree.is_sound(leaves.len() + 1) && !tree.is_sound(leaves.len() - 1), "{}", builder.name());
            for _ in 0..300 {
                let mut nodes = tree.nodes().to_vec();
                let at = rng.integer(0, nodes.len() as i64 - 1) as usize;
                let lane = rng.integer(0, LANES as i64 - 1) as usize;
                match rng.integer(0, 4) {
                    0 => nodes[at].references[lane] ^= 1 << rng.integer(0, 31),
                    1 => nodes[at].count ^= 1 << rng.integer(0, 31),
                    2 => nodes[at].reserved ^= 1 << rng.integer(0, 31),
                    3 => {
                        let count = nodes[at].count();
                        if count == LANES {
                            continue;
                        }
                        let (lane, axis) = (rng.integer(count as i64, 7) as usize, rng.integer(0, 2) as usize);
                        let Node { min, max, .. } = &mut nodes[at];
                        [min, max][rng.integer(0, 1) as usize][axis][lane] = 0.0;
                        boxes_not_in_use += 1;
                    }
                    // The root as its own descendant.
                    _ => {
                        let node = nodes[at];
                        nodes[0] = Node { references: [at as u32; LANES], count: 1 + node.count % 8, ..node };
                    }
                }
                assert!(!WideTree::from_nodes(nodes.into()).is_sound(leaves.len()), "{}", builder.name());
            }
        }
        assert!(boxes_not_in_use > 100, "{boxes_not_in_use} of 2,100 changes are of a box not in use");
        assert!(WideTree::from_nodes(Vec::new().into()).is_sound(0));
        assert!(!WideTree::from_nodes(Vec::new().into()).is_sound(1));
    }
}
