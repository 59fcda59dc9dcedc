//! The neutral binary tree: what every builder emits and the collapse to the wide layout reads.

use std::num::NonZeroU32;

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
    /// Where the range of [`BinaryTree::order`] that is below starts.
    pub first: u32,
    /// How many boxes are below; at most [`LEAF_CAPACITY`] in a leaf.
    pub count: u32,
    /// Index of the right child of an inner node; the left one is the next node.
    pub right: Option<NonZeroU32>,
}

/// A binary tree in preorder over boxes `order[..]`; empty where there are no boxes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryTree {
    /// The root first; a left child follows its parent.
    pub nodes: Vec<BinaryNode>,
    /// The boxes' indices, grouped so that each leaf is a range.
    pub order: Vec<u32>,
}
