//! The production tree. Its nodes have eight children whose boxes are stored by axis for the vector
//! unit.
//!
//! Source: Wald, Benthin, Boulos, *Getting rid of packets*, RT 2008. The collapse is the idea of
//! Ericson, 6.7.2; it opens the child that holds most boxes. Nodes are plain data of four cache
//! lines, in preorder. Children so come after their parents, and a refit is a reverse sweep.
//!
//! Tests: `hierarchy/tests.rs`.

use super::binary::BinaryTree;
use super::boxes::Bounds;
#[cfg(test)]
use super::lanes::BoxLanes;
use super::slab::Slab;
use crate::simd::LANES;
use crate::storage::{Buffer, Growing};
use crate::volume::Aabb;

/// The target of a lane of a [`Node`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// The index of another node.
    Inner(u32),
    /// The index of a leaf, in the order of the tree's leaves.
    Leaf(u32),
}

/// Maximum number of leaves of a patch, a subtree whose nodes have slabs: those of three full
/// levels. Larger regions of a surface are too curved for a thin slab.
pub(super) const MAX_PATCH_LEAVES: usize = LANES * LANES * LANES;

/// The bit that marks the reference to a leaf.
pub(super) const LEAF_BIT: u32 = 1 << 31;

/// A node with up to eight children, either all nodes or all leaves. It holds their boxes by axis,
/// references to them, and a slab around all of their content. Lanes from `count` on hold the empty
/// box.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(64))]
pub struct Node {
    /// `min[axis][lane]`: the minimum coordinate of the child's box, in the frame of the tree's
    /// boxes.
    pub min: [[f32; LANES]; 3],
    /// `max[axis][lane]`: the maximum coordinate of the child's box, in the frame of the tree's
    /// boxes.
    pub max: [[f32; LANES]; 3],
    pub(super) references: [u32; LANES],
    /// A slab that contains all items below the node.
    pub slab: Slab,
    pub(super) count: u32,
    /// Longest edge of the box around everything below.
    pub(crate) extent: f32,
    pub(super) reserved: u32,
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        min: [[f32::INFINITY; LANES]; 3],
        max: [[f32::NEG_INFINITY; LANES]; 3],
        references: [0; LANES],
        slab: Slab::ALL,
        count: 0,
        extent: 0.0,
        reserved: 0,
    };

    /// Returns the number of lanes in use.
    #[inline(always)]
    #[must_use]
    pub fn count(&self) -> usize {
        (self.count as usize).min(LANES)
    }

    /// Reports whether the children are leaves.
    #[inline(always)]
    #[must_use]
    pub fn holds_leaves(&self) -> bool {
        self.references[0] & LEAF_BIT != 0
    }

    /// Returns the index of the node or leaf in `lane`.
    #[inline(always)]
    pub(crate) fn index(&self, lane: usize) -> u32 {
        self.references[lane] & !LEAF_BIT
    }

    /// Returns the child in `lane`. The result is meaningless for lanes from [`count`](Self::count)
    /// on.
    ///
    /// # Panics
    /// If `lane` is 8 or more.
    #[inline(always)]
    #[must_use]
    pub fn child(&self, lane: usize) -> Child {
        Child::from_reference(self.references[lane])
    }

    pub(super) fn set_bounds(&mut self, lane: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.min[axis][lane] = bounds.min[axis];
            self.max[axis][lane] = bounds.max[axis];
        }
    }

    /// Sets the extent, given the box of everything below.
    #[inline(always)]
    pub(super) fn set_extent(&mut self, Aabb { min, max }: &Aabb) {
        self.extent = (0..3).fold(0.0, |extent, axis| extent.max(max[axis] - min[axis]));
    }

    /// Returns a node of eight leaves with these boxes.
    #[cfg(test)]
    pub(crate) fn of_leaves(boxes: &BoxLanes) -> Self {
        let BoxLanes { min, max } = *boxes;
        Self { min, max, references: [LEAF_BIT; LANES], count: LANES as u32, ..Self::EMPTY }
    }

    pub(super) fn set_child(&mut self, lane: usize, child: Child) {
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

/// The bounding volume hierarchy that queries descend, with up to eight children per node. Leaves
/// are numbered in preorder; the caller stores their content.
#[derive(Debug)]
pub struct WideTree {
    nodes: Buffer<Node>,
}

impl WideTree {
    /// Collapses a binary tree. Also returns, for each leaf, the index of its node in the binary
    /// tree.
    #[must_use]
    pub fn collapse<B: Bounds>(binary: &BinaryTree<B>) -> (Self, Vec<u32>) {
        let mut collapse = Collapse {
            binary,
            // Builders that split at medians give one wide node for ten binary nodes. Reserve some
            // more.
            nodes: Growing::with_capacity(binary.nodes.len() / 8 + 1),
            leaves: Vec::with_capacity(binary.nodes.len() / 2 + 1),
        };
        if !binary.nodes.is_empty() {
            collapse.node(Subtree { root: 0, len: binary.nodes.len() as u32 });
        }
        (Self { nodes: collapse.nodes.into_buffer() }, collapse.leaves)
    }

    /// Wraps nodes without validating them.
    pub(crate) fn from_nodes(nodes: Buffer<Node>) -> Self {
        Self { nodes }
    }

    pub(crate) fn nodes_mut(&mut self) -> &mut [Node] {
        self.nodes.to_mut()
    }

    /// Returns the nodes in preorder, the root first. There are none if there are no boxes.
    #[inline(always)]
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }
}

/// A node of the binary tree and all nodes below it, which follow it.
#[derive(Clone, Copy)]
struct Subtree {
    root: u32,
    len: u32,
}

impl Subtree {
    /// Reports whether the subtree has at most eight leaves. If every inner node has two children,
    /// there is one leaf more than inner nodes.
    fn fits_a_node_of_leaves(self) -> bool {
        (self.len as usize) < 2 * LANES
    }
}

struct Collapse<'a, B> {
    binary: &'a BinaryTree<B>,
    nodes: Growing<Node>,
    leaves: Vec<u32>,
}

impl<B: Bounds> Collapse<'_, B> {
    /// Appends the wide node for a binary node and all below it, and returns its index. The
    /// recursion is at most as deep as the binary tree, whose depth is bounded.
    fn node(&mut self, subtree: Subtree) -> u32 {
        let at = self.nodes.len();
        if subtree.fits_a_node_of_leaves() {
            let node = self.node_of_leaves(subtree);
            self.nodes.push(node);
            return at as u32;
        }
        self.nodes.push(Node::EMPTY);
        let (lanes, count) = self.children(subtree);
        let mut node = Node { count: count as u32, ..Node::EMPTY };
        for (lane, &child) in lanes[..count].iter().enumerate() {
            let wide = self.node(child);
            node.set_bounds(lane, &self.binary.nodes[child.root as usize].bounds.aabb());
            node.set_child(lane, Child::Inner(wide));
        }
        node.set_extent(&node.bounds());
        self.nodes[at] = node;
        at as u32
    }

    /// Returns the node of leaves for a subtree that fits one. Even a single leaf becomes a node,
    /// so that a descent of two trees pairs leaves with leaves.
    fn node_of_leaves(&mut self, Subtree { root, len }: Subtree) -> Node {
        let mut node = Node::EMPTY;
        let below = &self.binary.nodes[root as usize..][..len as usize];
        let leaves = (root..).zip(below).filter(|(_, below)| below.right.is_none());
        for (lane, (place, leaf)) in leaves.enumerate() {
            node.set_bounds(lane, &leaf.bounds.aabb());
            node.set_child(lane, Child::Leaf(self.leaves.len() as u32));
            node.count += 1;
            self.leaves.push(place);
        }
        node.set_extent(&node.bounds());
        node
    }

    /// Returns the binary nodes that become the children. The child that holds most boxes is opened
    /// until all lanes are used; among equals it is the first. A child that fits a node of leaves
    /// is not opened. The children keep their order.
    fn children(&self, subtree: Subtree) -> ([Subtree; LANES], usize) {
        let fullness = |child: Subtree| {
            if child.fits_a_node_of_leaves() { 0 } else { self.binary.nodes[child.root as usize].count }
        };
        let (mut lanes, mut held) = ([subtree; LANES], [0; LANES]);
        held[0] = fullness(subtree);
        let mut count = 1;
        while count < LANES {
            let mut fullest = 0;
            for lane in 1..count {
                let is_fuller = (held[lane], lanes[fullest].root) > (held[fullest], lanes[lane].root);
                fullest = if is_fuller { lane } else { fullest };
            }
            if held[fullest] == 0 {
                break;
            }
            let opened = lanes[fullest];
            let Some(right) = self.binary.nodes[opened.root as usize].right else { break };
            let low = Subtree { root: opened.root + 1, len: right.get() - 1 };
            let high = Subtree { root: opened.root + right.get(), len: opened.len - right.get() };
            (lanes[fullest], held[fullest]) = (low, fullness(low));
            (lanes[count], held[count]) = (high, fullness(high));
            count += 1;
        }
        lanes[..count].sort_unstable_by_key(|child| child.root);
        (lanes, count)
    }
}
