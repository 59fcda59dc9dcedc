//! The production tree: nodes of eight children whose boxes lie side by side for the vector unit.
//!
//! Source: Wald, Benthin, Boulos, *Getting rid of packets*, RT 2008; the collapse is the idea of Ericson, 6.7.2, and opens
//! the child that holds most. Nodes are plain bytes of four cache lines in preorder, so that children
//! come after parents and a reverse sweep refits.

use super::binary::{BinaryTree, NODE_OF_LEAVES};
use crate::simd::LANES;
use crate::storage::Buffer;
use crate::volume::Aabb;

/// What a lane of a [`Node`] leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// Another node.
    Inner(u32),
    /// A leaf, counted in the order of the tree's leaves.
    Leaf(u32),
}

/// Marks the reference to a leaf.
const LEAF_BIT: u32 = 1 << 31;

/// Eight children: their boxes by axis, then what they lead to. Lanes from `count` on hold the empty box.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(64))]
pub struct Node {
    /// `min[axis][lane]`: the least coordinate of the child's box.
    pub min: [[f32; LANES]; 3],
    /// `max[axis][lane]`: the greatest coordinate of the child's box.
    pub max: [[f32; LANES]; 3],
    references: [u32; LANES],
    count: u32,
    reserved: [u32; 7],
}

impl Node {
    const EMPTY: Self = Self {
        min: [[f32::INFINITY; LANES]; 3],
        max: [[f32::NEG_INFINITY; LANES]; 3],
        references: [0; LANES],
        count: 0,
        reserved: [0; 7],
    };

    /// How many lanes are in use.
    #[inline(always)]
    #[must_use]
    pub fn count(&self) -> usize {
        (self.count as usize).min(LANES)
    }

    /// What `lane` leads to.
    #[inline(always)]
    #[must_use]
    pub fn child(&self, lane: usize) -> Child {
        Child::from_reference(self.references[lane])
    }

    fn set(&mut self, lane: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.min[axis][lane] = bounds.min[axis];
            self.max[axis][lane] = bounds.max[axis];
        }
        self.references[lane] = child.reference();
    }
}

impl Child {
    #[inline(always)]
    fn from_reference(reference: u32) -> Self {
        if reference & LEAF_BIT == 0 { Self::Inner(reference) } else { Self::Leaf(reference & !LEAF_BIT) }
    }

    fn reference(self) -> u32 {
        match self {
            Self::Inner(node) => node,
            Self::Leaf(leaf) => leaf | LEAF_BIT,
        }
    }
}

/// The tree that queries descend; leaves are numbered in preorder and the caller keeps what they hold.
#[derive(Clone, Debug)]
pub struct WideTree {
    nodes: Buffer<Node>,
}

impl WideTree {
    /// Collapses a binary tree; also returns which of its nodes each leaf is.
    #[must_use]
    pub fn collapse(binary: &BinaryTree) -> (Self, Vec<u32>) {
        let mut collapse = Collapse { binary, nodes: Vec::new(), leaves: Vec::new() };
        if !binary.nodes.is_empty() {
            collapse.node(0);
        }
        (Self { nodes: collapse.nodes.into() }, collapse.leaves)
    }

    /// The nodes in preorder, the root first; none where there are no boxes.
    #[inline(always)]
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }
}

struct Collapse<'a> {
    binary: &'a BinaryTree,
    nodes: Vec<Node>,
    leaves: Vec<u32>,
}

impl Collapse<'_> {
    /// Appends the wide node that stands for binary node `root` and all below it. The recursion is at most as deep as
    /// the binary tree, whose depth is bounded.
    fn node(&mut self, root: u32) -> Child {
        let at = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let (lanes, count) = self.children(root);
        let mut node = Node { count: count as u32, ..Node::EMPTY };
        for (lane, &child) in lanes[..count].iter().enumerate() {
            let binary = &self.binary.nodes[child as usize];
            let wide = match binary.right {
                None => {
                    self.leaves.push(child);
                    Child::Leaf(self.leaves.len() as u32 - 1)
                }
                Some(_) => self.node(child),
            };
            node.set(lane, &binary.bounds, wide);
        }
        self.nodes[at] = node;
        Child::Inner(at as u32)
    }

    /// The binary nodes that become the children: the one that holds most is opened until the lanes are full, or until
    /// all of them fit a node of leaves. Their order in space is kept.
    fn children(&self, root: u32) -> ([u32; LANES], usize) {
        let held = |child: u32| self.binary.nodes[child as usize].count as usize;
        let mut lanes = [root; LANES];
        let mut count = 1;
        while count < LANES {
            let mut fullest = 0;
            for lane in 1..count {
                if held(lanes[lane]) > held(lanes[fullest]) {
                    fullest = lane;
                }
            }
            let opened = lanes[fullest];
            let Some(right) = self.binary.nodes[opened as usize].right else { break };
            if count > 1 && held(root) > NODE_OF_LEAVES && held(opened) <= NODE_OF_LEAVES {
                break;
            }
            lanes.copy_within(fullest + 1..count, fullest + 2);
            lanes[fullest] = opened + 1;
            lanes[fullest + 1] = opened + right.get();
            count += 1;
        }
        (lanes, count)
    }
}
