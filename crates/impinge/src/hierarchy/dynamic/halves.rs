//! Builds the tree over all boxes at once, by halving their number.

use super::{DynamicBvh, DynamicNode, Enclosable, NONE};

impl<B: Enclosable, const THOROUGH: bool> DynamicBvh<B, THOROUGH> {
    /// Replaces the tree by a balanced one over these boxes and their keys. `split` reorders at
    /// least two boxes so that the first half of them, rounded down, goes to one side.
    ///
    /// # Complexity
    /// O(n log n) if `split` is linear.
    pub(crate) fn rebuild(&mut self, boxes: &mut [(u32, B)], split: impl Fn(&mut [(u32, B)])) {
        self.nodes.clear();
        self.free.clear();
        self.leaves.fill(NONE);
        self.root = None;
        self.leaves.resize(boxes.iter().map(|&(key, _)| key as usize + 1).max().unwrap_or(0), NONE);
        self.nodes.reserve(2 * boxes.len());
        if !boxes.is_empty() {
            self.root = Some(self.subtree(boxes, NONE, &split));
        }
    }

    /// Recurses at most 32 deep, because the number of boxes halves.
    fn subtree(&mut self, boxes: &mut [(u32, B)], parent: u32, split: &impl Fn(&mut [(u32, B)])) -> u32 {
        let at = self.nodes.len() as u32;
        let (key, bounds) = boxes[0];
        self.nodes.push(DynamicNode { bounds, parent, children: [key, NONE], height: 0, shallow: 0 });
        if boxes.len() == 1 {
            self.leaves[key as usize] = at;
            return at;
        }
        split(boxes);
        let (low, high) = boxes.split_at_mut(boxes.len() / 2);
        let children = [self.subtree(low, at, split), self.subtree(high, at, split)];
        self.nodes[at as usize].children = children;
        self.pull(at);
        at
    }
}
