//! The common part of all top-down builders. Ranges are split until they fit a leaf, on all cores.
//! From a fixed depth on they are halved, whatever the builder chooses, so that no input makes a
//! deep tree.

use std::num::NonZeroU32;

use super::super::binary::{BinaryNode, MAX_DEPTH};
use crate::volume::Aabb;

/// Depth from which ranges are halved. There are fewer than 2^32 boxes, so 32 halvings leave single
/// boxes.
pub(super) const HALVE_FROM_DEPTH: usize = MAX_DEPTH - u32::BITS as usize;

/// Maximum length of a range that is built as one task. For shorter ranges, waking a thread costs
/// more than it saves.
const SPLIT_TASKS_ABOVE: usize = 1 << 13;

/// The rule that determines where a range is split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Choice {
    /// The builder's own rule.
    Builder,
    /// Halves of equal size.
    Halves,
}

/// Boxes that become a subtree. Splitting rearranges the borrowed boxes, so that they finally are
/// in the order of the leaves.
pub(super) trait Range: Sized + Send {
    /// Returns the number of boxes, which is at least one.
    fn len(&self) -> usize;
    /// Returns the box around all boxes.
    fn bounds(&self) -> Aabb;
    /// Splits the range into two nonempty parts. It is called for more boxes than a leaf holds.
    /// With [`Choice::Halves`], no part exceeds half of the leaves, rounded up.
    fn split(self, choice: Choice) -> (Self, Self);
}

/// Returns the nodes of a tree over a range, in preorder, with at most `capacity` boxes in a leaf.
pub(super) fn nodes<R: Range>(range: R, capacity: usize) -> Vec<BinaryNode> {
    nodes_from(range, capacity, 0, 0)
}

/// Returns the nodes as [`nodes`] does, for a subtree at `depth` whose first box is box `first` of
/// its tree.
pub(super) fn nodes_from<R: Range>(range: R, capacity: usize, first: usize, depth: usize) -> Vec<BinaryNode> {
    let mut blocks = Vec::new();
    Subtree { capacity }.in_tasks(range, first, depth, &mut blocks);
    blocks.concat()
}

/// Returns the number of boxes in the first half if `count` boxes are halved in whole leaves.
pub(super) fn middle(count: usize, capacity: usize) -> usize {
    count.div_ceil(capacity).div_ceil(2) * capacity
}

/// Returns the number of leaves that `count` boxes fill. It is the cost factor of a subtree,
/// because the boxes of a leaf are processed together.
pub(super) fn leaves(count: usize, capacity: usize) -> f64 {
    count.div_ceil(capacity) as f64
}

struct Subtree {
    capacity: usize,
}

impl Subtree {
    /// Appends the nodes in blocks. Large ranges become two tasks. Returns the bounds and the
    /// number of nodes.
    fn in_tasks<R: Range>(
        &self,
        range: R,
        first: usize,
        depth: usize,
        blocks: &mut Vec<Vec<BinaryNode>>,
    ) -> (Aabb, usize) {
        let count = range.len();
        if count <= SPLIT_TASKS_ABOVE {
            let mut nodes = Vec::with_capacity(4 * count.div_ceil(self.capacity));
            let bounds = self.in_one(range, first, depth, &mut nodes);
            let len = nodes.len();
            blocks.push(nodes);
            return (bounds, len);
        }
        let (low, high) = range.split(choice(depth));
        let middle = low.len();
        let (mut left_blocks, mut right_blocks) = (Vec::new(), Vec::new());
        let ((left, left_len), (right, right_len)) = rayon::join(
            || self.in_tasks(low, first, depth + 1, &mut left_blocks),
            || self.in_tasks(high, first + middle, depth + 1, &mut right_blocks),
        );
        let bounds = left.union(right);
        let right = NonZeroU32::new(1 + left_len as u32);
        blocks.push(vec![BinaryNode { bounds, first: first as u32, count: count as u32, right }]);
        blocks.append(&mut left_blocks);
        blocks.append(&mut right_blocks);
        (bounds, 1 + left_len + right_len)
    }

    /// Appends the nodes, the root first, and returns the bounds.
    fn in_one<R: Range>(&self, range: R, first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) -> Aabb {
        let count = range.len();
        let at = nodes.len();
        let mut node = BinaryNode { bounds: Aabb::EMPTY, first: first as u32, count: count as u32, right: None };
        nodes.push(node);
        if count <= self.capacity {
            node.bounds = range.bounds();
        } else {
            let (low, high) = range.split(choice(depth));
            let middle = low.len();
            let left = self.in_one(low, first, depth + 1, nodes);
            node.right = NonZeroU32::new((nodes.len() - at) as u32);
            node.bounds = left.union(self.in_one(high, first + middle, depth + 1, nodes));
        }
        nodes[at] = node;
        node.bounds
    }
}

fn choice(depth: usize) -> Choice {
    if depth < HALVE_FROM_DEPTH { Choice::Builder } else { Choice::Halves }
}
