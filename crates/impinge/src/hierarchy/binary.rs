//! The neutral binary tree. Every builder emits it and the collapse to the wide layout reads it.

use std::num::NonZeroU32;

use crate::simd::LANES;
use crate::storage::Buffer;
use crate::volume::Aabb;

/// Maximum number of boxes in a leaf: one for each lane of a packet.
pub const LEAF_CAPACITY: usize = LANES;

/// Maximum number of boxes below a wide node whose children are all leaves. Builders fill such
/// nodes and the collapse keeps them whole. So leaves lie at one depth, and a descent of two trees
/// pairs leaves with leaves.
pub const NODE_OF_LEAVES: usize = LANES * LEAF_CAPACITY;

/// Maximum depth of a leaf in a [`BinaryTree`], in steps from the root, for any boxes. It
/// determines the size of a descent's stack.
pub const MAX_DEPTH: usize = 64;

/// A node of a [`BinaryTree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinaryNode<B = Aabb> {
    /// Bounds of all boxes below the node.
    pub bounds: B,
    /// Start of the range of [`BinaryTree::order`] that has the boxes below the node.
    pub first: u32,
    /// Number of boxes below the node; at most [`LEAF_CAPACITY`] in a leaf.
    pub count: u32,
    /// Offset from this node to its right child, or `None` for a leaf. The left child is the next
    /// node.
    pub right: Option<NonZeroU32>,
}

/// A binary tree in preorder over the boxes `order[..]`. It has no nodes if there are no boxes. Its
/// nodes have boxes, or `()` if only the layout is needed.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryTree<B = Aabb> {
    /// The nodes in preorder: the root is first, and a left child follows its parent.
    pub nodes: Vec<BinaryNode<B>>,
    /// The indices of the boxes, ordered so that the boxes below each node are a range.
    pub order: Buffer<u32>,
}

impl<B> Default for BinaryTree<B> {
    fn default() -> Self {
        Self { nodes: Vec::new(), order: Vec::new().into() }
    }
}

impl<B> BinaryTree<B> {
    /// Returns the indices of the boxes below a node.
    ///
    /// # Panics
    /// If there is no such node.
    #[must_use]
    pub fn held(&self, node: u32) -> &[u32] {
        let BinaryNode { first, count, .. } = self.nodes[node as usize];
        &self.order[first as usize..][..count as usize]
    }
}
