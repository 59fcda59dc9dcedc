//! The neutral binary tree: what every builder emits and the collapse to the wide layout reads.

use std::num::NonZeroU32;

use crate::simd::LANES;
use crate::storage::Buffer;
use crate::volume::Aabb;

/// The most boxes that a leaf holds: one for each lane of a packet.
pub const LEAF_CAPACITY: usize = LANES;

/// What a wide node whose children are all leaves holds at most. Builders fill it and the collapse keeps it whole, so
/// that leaves stand side by side at one depth and a descent of two trees meets leaves with leaves.
pub const NODE_OF_LEAVES: usize = LANES * LEAF_CAPACITY;

/// No leaf lies deeper than this, whatever the boxes; a descent's stack is sized by it.
pub const MAX_DEPTH: usize = 64;

/// A node of a [`BinaryTree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinaryNode<B = Aabb> {
    /// Bounds every box below.
    pub bounds: B,
    /// Where the range of [`BinaryTree::order`] that is below starts.
    pub first: u32,
    /// How many boxes are below; at most [`LEAF_CAPACITY`] in a leaf.
    pub count: u32,
    /// How many nodes further on the right child of an inner node stands; the left one is the next node.
    pub right: Option<NonZeroU32>,
}

/// A binary tree in preorder over boxes `order[..]`; empty where there are no boxes. Its nodes have boxes, or `()` where
/// only the layout is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryTree<B = Aabb> {
    /// The root first; a left child follows its parent.
    pub nodes: Vec<BinaryNode<B>>,
    /// The boxes' indices, grouped so that each leaf is a range.
    pub order: Buffer<u32>,
}

impl<B> Default for BinaryTree<B> {
    fn default() -> Self {
        Self { nodes: Vec::new(), order: Vec::new().into() }
    }
}

impl<B> BinaryTree<B> {
    /// The boxes below a node.
    ///
    /// # Panics
    /// Where there is no such node.
    #[must_use]
    pub fn held(&self, node: u32) -> &[u32] {
        let BinaryNode { first, count, .. } = self.nodes[node as usize];
        &self.order[first as usize..][..count as usize]
    }
}
