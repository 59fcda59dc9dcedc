//! The structure shared by the k-d tree and the BSP tree: nodes split by axis-aligned planes, and
//! boxes at the nodes.

use super::Items;
use super::items::Held;
use crate::volume::MinMax;

/// Node number that stands for "no child".
const NONE: u32 = u32::MAX;

/// A binary tree of nodes, each of which is a leaf or is split by a plane. `T` is the data that a
/// kind of tree adds to each node.
#[derive(Clone, Debug)]
pub(super) struct PlaneTree<T> {
    /// Nodes in preorder, the root first.
    nodes: Vec<PlaneNode<T>>,
    /// Boxes of all nodes, in the order of the nodes.
    held: Vec<Held>,
    items: Items,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneNode<T> {
    pub(super) axis: usize,
    pub(super) plane: f64,
    /// Number of the child above the plane, or [`NONE`] for a leaf.
    above: u32,
    /// Index in `held` of the node's first box.
    first: u32,
    /// Number of boxes of the node.
    count: u32,
    pub(super) own: T,
}

/// How a node is split: the axis, the plane's coordinate along it, and the boxes for the children
/// below and above.
pub(super) type Split = (usize, f64, [Vec<Held>; 2]);

impl<T: Copy> PlaneTree<T> {
    /// Returns the tree of these boxes. The key of a box is its index.
    ///
    /// `split_node` receives the boxes and the depth of a node, and returns the boxes that stay in
    /// the node and how the others are split. `own` returns the data that the kind of tree adds to
    /// a node.
    pub(super) fn build(
        boxes: &[MinMax],
        own: impl Fn(&[Held]) -> T,
        mut split_node: impl FnMut(Vec<Held>, usize) -> (Vec<Held>, Option<Split>),
    ) -> Self {
        let mut tree = Self::default();
        let mut held = Vec::with_capacity(boxes.len());
        for (key, &bounds) in (0..).zip(boxes) {
            tree.items.insert(key, bounds);
            held.push(Held { bounds, key });
        }
        if !held.is_empty() {
            tree.grow(held, 0, &own, &mut split_node);
        }
        tree
    }

    fn grow(
        &mut self,
        held: Vec<Held>,
        depth: usize,
        own: &impl Fn(&[Held]) -> T,
        split_node: &mut impl FnMut(Vec<Held>, usize) -> (Vec<Held>, Option<Split>),
    ) {
        let (held, split) = split_node(held, depth);
        let (at, first, count) = (self.nodes.len(), self.held.len() as u32, held.len() as u32);
        self.nodes.push(PlaneNode { axis: 0, plane: 0.0, above: NONE, first, count, own: own(&held) });
        self.held.extend(held);
        if let Some((axis, plane, [below, above])) = split {
            self.grow(below, depth + 1, own, split_node);
            let place = self.nodes.len() as u32;
            self.nodes[at] = PlaneNode { axis, plane, above: place, ..self.nodes[at] };
            self.grow(above, depth + 1, own, split_node);
        }
    }

    /// Returns the number of the root, or `None` if the tree is empty.
    pub(super) fn root(&self) -> Option<u32> {
        (!self.nodes.is_empty()).then_some(0)
    }

    #[inline]
    pub(super) fn node(&self, at: u32) -> &PlaneNode<T> {
        &self.nodes[at as usize]
    }

    /// Returns the children below and above the plane of a node, or `None` for a leaf.
    #[inline]
    pub(super) fn children(&self, at: u32) -> Option<[u32; 2]> {
        let above = self.node(at).above;
        (above != NONE).then_some([at + 1, above])
    }

    /// Returns the boxes of a node.
    #[inline]
    pub(super) fn held(&self, at: u32) -> &[Held] {
        let node = self.node(at);
        &self.held[node.first as usize..(node.first + node.count) as usize]
    }

    pub(super) fn items(&self) -> &Items {
        &self.items
    }
}

impl<T> Default for PlaneTree<T> {
    fn default() -> Self {
        Self { nodes: Vec::new(), held: Vec::new(), items: Items::default() }
    }
}
