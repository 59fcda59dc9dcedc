//! Whether nodes are a tree at all: what every descent relies on and no builder breaks, asked of nodes that were read
//! from somewhere.

use super::binary::MAX_DEPTH;
use super::wide::{Child, Node, WideTree};
use crate::simd::LANES;

impl WideTree {
    /// Whether the nodes stand in preorder, each but the root the child of one, with children all nodes or all leaves, no
    /// deeper than [`MAX_DEPTH`] and one more, and the leaves are `0..leaves` in that order. Says nothing about boxes and slabs.
    ///
    /// # Complexity
    /// Linear, whatever the nodes are.
    pub(crate) fn is_sound(&self, leaves: usize) -> bool {
        let nodes = self.nodes();
        if nodes.is_empty() {
            return leaves == 0;
        }
        // The children that are still to come, each with its depth, the next one last.
        let mut awaited = vec![(0_u32, 0_usize)];
        let mut leaves_so_far = 0;
        for (at, node) in nodes.iter().enumerate() {
            let Some((expected, depth)) = awaited.pop() else { return false };
            // A wide tree may be one level deeper than the binary one: a lone leaf has a node of its own.
            if expected as usize != at || depth > MAX_DEPTH || !node.is_well_formed() {
                return false;
            }
            if node.holds_leaves() {
                for lane in 0..node.count() {
                    if node.index(lane) as usize != leaves_so_far {
                        return false;
                    }
                    leaves_so_far += 1;
                }
            } else {
                awaited.extend((0..node.count()).rev().map(|lane| (node.index(lane), depth + 1)));
            }
        }
        awaited.is_empty() && leaves_so_far == leaves
    }
}

impl Node {
    /// Whether lanes and references are as the collapse leaves them.
    fn is_well_formed(&self) -> bool {
        let count = self.count as usize;
        let is_leaf = |lane: usize| matches!(self.child(lane), Child::Leaf(_));
        (1..=LANES).contains(&count)
            && (0..count).all(|lane| is_leaf(lane) == is_leaf(0))
            && self.references[count..].iter().all(|&reference| reference == 0)
            && self.reserved == Self::EMPTY.reserved
            && (0..3).all(|axis| {
                self.min[axis][count..].iter().all(|&min| min == f32::INFINITY)
                    && self.max[axis][count..].iter().all(|&max| max == f32::NEG_INFINITY)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Builder;
    use crate::volume::Aabb;
    use impinge_testkit::generate::Rng;

    #[test]
    fn builders_make_sound_trees_and_no_change_of_a_reference_leaves_them_sound() {
        let mut rng = Rng::new(71);
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
                match rng.integer(0, 3) {
                    0 => nodes[at].references[lane] ^= 1 << rng.integer(0, 31),
                    1 => nodes[at].count ^= 1 << rng.integer(0, 31),
                    2 => nodes[at].reserved ^= 1 << rng.integer(0, 31),
                    // The root as its own descendant.
                    _ => {
                        let node = nodes[at];
                        nodes[0] = Node { references: [at as u32; LANES], count: 1 + node.count % 8, ..node };
                    }
                }
                assert!(!WideTree::from_nodes(nodes.into()).is_sound(leaves.len()), "{}", builder.name());
            }
        }
        assert!(WideTree::from_nodes(Vec::new().into()).is_sound(0));
        assert!(!WideTree::from_nodes(Vec::new().into()).is_sound(1));
    }
}
