//! Builds a tree by insertion: boxes are inserted one at a time into a dynamic bounding volume
//! hierarchy.

use std::ops::ControlFlow;

use super::super::binary::{BinaryTree, LEAF_CAPACITY};
use super::super::dynamic::{DynamicBvh, DynamicNode};
use super::linked::{Below, Linked, LinkedNode};
use crate::volume::Aabb;

/// A tree into which boxes are inserted, and from which they are removed, one at a time. Each box
/// has a number that identifies it until it is removed.
///
/// ```
/// use impinge::hierarchy::DynamicTree;
/// use impinge::volume::Aabb;
///
/// let mut tree = DynamicTree::new();
/// let boxes = [0.0_f32, 1.0, 5.0].map(|x| tree.insert(Aabb { min: [x, 0.0, 0.0], max: [x + 2.0, 1.0, 1.0] }));
/// tree.remove(boxes[1]);
/// let mut found = Vec::new();
/// tree.for_each_overlapping(&Aabb { min: [1.0; 3], max: [2.0; 3] }, |number| found.push(number));
/// assert_eq!(found, [boxes[0]]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct DynamicTree {
    bvh: DynamicBvh<Aabb, true>,
    /// Numbers that removed boxes had, and that no box has now.
    free_numbers: Vec<u32>,
}

impl DynamicTree {
    /// Returns an empty tree.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the number of boxes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bvh.len()
    }

    /// Reports whether there are no boxes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bvh.root().is_none()
    }

    /// Returns the box with this number, or `None` if there is no such box.
    #[must_use]
    pub fn get(&self, number: u32) -> Option<&Aabb> {
        self.bvh.leaf_of(number).map(|leaf| &self.bvh.node(leaf).bounds)
    }

    /// Inserts a box, which must not be empty, and returns the number that identifies it. The
    /// number freed last is used again; if no number is free, the smallest unused number is taken.
    ///
    /// # Complexity
    /// A bounded number of steps.
    pub fn insert(&mut self, bounds: Aabb) -> u32 {
        // If no number is free, the boxes have the numbers below their count.
        let number = self.free_numbers.pop().unwrap_or(self.bvh.len() as u32);
        self.bvh.insert(number, bounds);
        number
    }

    /// Removes a box and returns it, or `None` if there is no box with this number.
    ///
    /// # Complexity
    /// A bounded number of steps.
    pub fn remove(&mut self, number: u32) -> Option<Aabb> {
        let bounds = self.bvh.remove(number)?;
        self.free_numbers.push(number);
        Some(bounds)
    }

    /// Gives a box other bounds, which must not be empty, and moves its leaf where the tree grows
    /// least. Returns its previous bounds, or `None` if there is no box with this number.
    ///
    /// # Complexity
    /// A bounded number of steps.
    pub fn replace(&mut self, number: u32, bounds: Aabb) -> Option<Aabb> {
        let leaf = self.bvh.leaf_of(number)?;
        let before = self.bvh.node(leaf).bounds;
        self.bvh.reinsert(leaf, bounds);
        Some(before)
    }

    /// Calls `visit` with the number of each box that has a point in common with `region`, in no
    /// particular order.
    pub fn for_each_overlapping(&self, region: &Aabb, mut visit: impl FnMut(u32)) {
        let _ = self.bvh.search(
            |bounds| bounds.overlaps(region),
            |leaf| {
                visit(leaf.key());
                ControlFlow::Continue(())
            },
        );
    }

    /// Returns the boxes as a [`BinaryTree`] with at most `capacity` boxes in a leaf. `capacity` is
    /// clamped to 1 to [`LEAF_CAPACITY`]. [`BinaryTree::order`] lists the numbers that identify the
    /// boxes.
    #[must_use]
    pub fn to_binary(&self, capacity: usize) -> BinaryTree {
        let Some(root) = self.bvh.root() else { return BinaryTree::default() };
        let linked = |node: &DynamicNode<Aabb>| LinkedNode {
            bounds: node.bounds,
            parent: node.parent,
            below: if node.is_leaf() {
                Below::Boxes { first: node.key(), count: 1 }
            } else {
                Below::Pair(node.children)
            },
        };
        let numbers: Vec<u32> = (0..self.bvh.keys()).collect();
        let linked = Linked { nodes: self.bvh.nodes().iter().map(linked).collect(), root };
        linked.to_binary(&numbers, capacity.clamp(1, LEAF_CAPACITY), |number| {
            self.get(number).copied().unwrap_or(Aabb::EMPTY)
        })
    }
}
