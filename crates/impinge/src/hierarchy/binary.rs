//! The neutral binary tree: what every builder emits and the collapse to the wide layout reads.

use crate::simd::LANES;
use crate::volume::Aabb;

/// The most boxes that a leaf holds: one for each lane of a packet.
pub const LEAF_CAPACITY: usize = LANES;

/// No leaf lies deeper than this, whatever the boxes; a descent's stack is sized by it.
pub const MAX_DEPTH: usize = 64;

/// A node of a [`BinaryTree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinaryNode {
    /// Bounds every box below.
    pub bounds: Aabb,
    /// What is below.
    pub below: Below,
}

/// What a [`BinaryNode`] holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Below {
    /// The left child is the next node; the right one stands at this index.
    Inner {
        /// Index of the right child.
        right: u32,
    },
    /// A range of [`BinaryTree::order`].
    Leaf {
        /// Where the range starts.
        first: u32,
        /// How many boxes, at least one and at most [`LEAF_CAPACITY`].
        count: u32,
    },
}

/// A binary tree in preorder over boxes `order[..]`; empty where there are no boxes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryTree {
    /// The root first; a left child follows its parent.
    pub nodes: Vec<BinaryNode>,
    /// The boxes' indices, grouped so that each leaf is a range.
    pub order: Vec<u32>,
}
