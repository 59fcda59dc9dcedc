//! The part that the k-d tree and the BSP tree share: nodes that are split by planes across the axes, and boxes at nodes.

use super::Items;
use super::items::Held;
use crate::volume::MinMax;

/// The number of no child.
const NONE: u32 = u32::MAX;

/// A binary tree of nodes, each of which is split by a plane or is a leaf. `T` is what a kind of tree adds to each node.
#[derive(Clone, Debug)]
pub(super) struct PlaneTree<T> {
    /// In preorder, the root first.
    nodes: Vec<PlaneNode<T>>,
    /// The boxes of all nodes, in the order of the nodes.
    held: Vec<Held>,
    items: Items,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneNode<T> {
    pub(super) axis: usize,
    pub(super) plane: f64,
    /// The child above the plane; [`NONE`] for a leaf.
    above: u32,
    /// The first of the node's boxes, and their number.
    first: u32,
    count: u32,
    pub(super) own: T,
}

/// How a node is split: the axis, the plane across it, and the boxes for the children below and above.
pub(super) type Split = (usize, f64, [Vec<Held>; 2]);

impl<T: Copy> PlaneTree<T> {
    /// Returns the tree of these boxes, whose keys are their indices. `part` gets the boxes and the depth of a node, and
    /// returns the boxes that stay in the node, and how the rest is split. `own` returns what the tree adds to a node.
    pub(super) fn build(
        boxes: &[MinMax],
        own: impl Fn(&[Held]) -> T,
        mut part: impl FnMut(Vec<Held>, usize) -> (Vec<Held>, Option<Split>),
    ) -> Self {
        let mut tree = Self::default();
        let mut held = Vec::with_capacity(boxes.len());
        for (key, &bounds) in (0..).zip(boxes) {
            tree.items.insert(key, bounds);
            held.push(Held { bounds, key });
        }
        if !held.is_empty() {
            tree.grow(held, 0, &own, &mut part);
        }
        tree
    }

    fn grow(
        &mut self,
        held: Vec<Held>,
        depth: usize,
        own: &impl Fn(&[Held]) -> T,
        part: &mut impl FnMut(Vec<Held>, usize) -> (Vec<Held>, Option<Split>),
    ) {
        let (held, split) = part(held, depth);
        let (at, first, count) = (self.nodes.len(), self.held.len() as u32, held.len() as u32);
        self.nodes.push(PlaneNode { axis: 0, plane: 0.0, above: NONE, first, count, own: own(&held) });
        self.held.extend(held);
        if let Some((axis, plane, [below, above])) = split {
            self.grow(below, depth + 1, own, part);
            let place = self.nodes.len() as u32;
            self.nodes[at] = PlaneNode { axis, plane, above: place, ..self.nodes[at] };
            self.grow(above, depth + 1, own, part);
        }
    }

    /// Returns the number of the root; `None` if the tree is empty.
    pub(super) fn root(&self) -> Option<u32> {
        (!self.nodes.is_empty()).then_some(0)
    }

    #[inline]
    pub(super) fn node(&self, at: u32) -> &PlaneNode<T> {
        &self.nodes[at as usize]
    }

    /// Returns the children below and above the plane of a node; `None` for a leaf.
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
