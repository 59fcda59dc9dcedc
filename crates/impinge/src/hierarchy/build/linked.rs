//! A binary tree whose subtrees can be moved. All builders but the top-down ones work on it. It is
//! then converted to the neutral tree, with full leaves and a bounded depth.

use std::num::NonZeroU32;

use super::super::binary::{BinaryNode, BinaryTree, MAX_DEPTH};
use super::item::Item;
use super::median;
use super::top_down::HALVE_FROM_DEPTH;
use crate::volume::Aabb;

/// The index of no node: the parent of the root.
pub(super) const NONE: u32 = u32::MAX;

/// A node with a reference to its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkedNode {
    pub(super) bounds: Aabb,
    pub(super) parent: u32,
    pub(super) below: Below,
}

/// The content of a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Below {
    /// Two nodes.
    Pair([u32; 2]),
    /// A range of boxes, in the order passed to [`Linked::to_binary`].
    Boxes { first: u32, count: u32 },
}

/// A tree whose nodes are in no particular order.
#[derive(Clone, Debug)]
pub(super) struct Linked {
    pub(super) nodes: Vec<LinkedNode>,
    pub(super) root: u32,
}

impl Linked {
    /// Returns the other child of the node's parent, or `None` for the root.
    pub(super) fn sibling(&self, node: u32) -> Option<u32> {
        match self.nodes.get(self.nodes[node as usize].parent as usize)?.below {
            Below::Pair([left, right]) => Some(if left == node { right } else { left }),
            Below::Boxes { .. } => None,
        }
    }

    /// Replaces the child `old` of `parent` by `new`.
    pub(super) fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        if let Below::Pair(children) = &mut self.nodes[parent as usize].below {
            for child in children {
                if *child == old {
                    *child = new;
                }
            }
        }
        self.nodes[new as usize].parent = parent;
    }

    /// Returns all nodes: parents before children, left before right.
    pub(super) fn preorder(&self) -> Vec<u32> {
        let mut found = Vec::with_capacity(self.nodes.len());
        let mut pending = vec![self.root];
        while let Some(node) = pending.pop() {
            found.push(node);
            if let Below::Pair([left, right]) = self.nodes[node as usize].below {
                pending.extend([right, left]);
            }
        }
        found
    }

    /// Converts the tree to the neutral tree. Subtrees of at most `capacity` boxes become leaves.
    /// Subtrees that would exceed [`MAX_DEPTH`] are rebuilt by medians. The ranges of boxes refer
    /// to `order`; `bounds_of` returns the box of each of its entries.
    pub(super) fn to_binary(&self, order: &[u32], capacity: usize, bounds_of: impl Fn(u32) -> Aabb) -> BinaryTree {
        let sizes = self.sizes(capacity);
        let (mut nodes, mut ordered) = (Vec::<BinaryNode>::new(), Vec::with_capacity(order.len()));
        // The nodes to convert, each with its depth. Each right child also has the new index of its
        // parent.
        let mut pending: Vec<(u32, usize, Option<usize>)> = vec![(self.root, 0, None)];
        while let Some((at, depth, parent)) = pending.pop() {
            let here = nodes.len();
            if let Some(parent) = parent {
                nodes[parent].right = NonZeroU32::new((here - parent) as u32);
            }
            let (node, size) = (&self.nodes[at as usize], sizes[at as usize]);
            let is_too_deep = depth >= HALVE_FROM_DEPTH && depth + size.height as usize > MAX_DEPTH;
            match node.below {
                Below::Pair([left, right]) if size.count as usize > capacity && !is_too_deep => {
                    let first = ordered.len() as u32;
                    nodes.push(BinaryNode { bounds: node.bounds, first, count: size.count, right: None });
                    pending.extend([(right, depth + 1, Some(here)), (left, depth + 1, None)]);
                }
                _ => {
                    let mut items = self.held(at, order, &bounds_of);
                    median::append(&mut nodes, &mut ordered, &mut items, capacity, depth);
                }
            }
        }
        BinaryTree { nodes, order: ordered.into() }
    }

    /// Returns the boxes below a node.
    fn held(&self, root: u32, order: &[u32], bounds_of: impl Fn(u32) -> Aabb) -> Vec<Item> {
        let mut items = Vec::new();
        let mut pending = vec![root];
        while let Some(node) = pending.pop() {
            match self.nodes[node as usize].below {
                Below::Pair([left, right]) => pending.extend([right, left]),
                Below::Boxes { first, count } => {
                    let held = &order[first as usize..][..count as usize];
                    items.extend(held.iter().map(|&index| Item::new(&bounds_of(index), index)));
                }
            }
        }
        items
    }

    /// Returns the size of each subtree. Subtrees that fit a leaf have height zero.
    fn sizes(&self, capacity: usize) -> Vec<Size> {
        let mut sizes = vec![Size { count: 0, height: 0 }; self.nodes.len()];
        for &at in self.preorder().iter().rev() {
            sizes[at as usize] = match self.nodes[at as usize].below {
                Below::Boxes { count, .. } => Size { count, height: 0 },
                Below::Pair([left, right]) => {
                    let (left, right) = (sizes[left as usize], sizes[right as usize]);
                    let count = left.count + right.count;
                    let is_leaf = count as usize <= capacity;
                    Size { count, height: if is_leaf { 0 } else { 1 + left.height.max(right.height) } }
                }
            };
        }
        sizes
    }
}

#[derive(Clone, Copy)]
struct Size {
    count: u32,
    height: u32,
}
