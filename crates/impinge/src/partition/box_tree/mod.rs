//! The dynamic bounding-volume tree as a partition: a tree with a margin around each leaf, and the
//! exact boxes by key.
//!
//! Source: Catto, *Dynamic bounding volume hierarchies*, GDC 2019 (fat leaves).

mod build;
mod by_gap;
mod moves;
mod pairs;
mod queries;

pub use by_gap::GapVisitor;

use super::Items;
use crate::hierarchy::{DynamicBvh, DynamicNode};
use crate::volume::{BoundingVolume, MinMax};

/// A tree of boxes that can be inserted, removed and moved. Use it if you know nothing about the
/// boxes.
///
/// A box that moves keeps its place in the tree while it stays inside its leaf's or its parent's
/// volume, and is reinserted otherwise. With a margin, leaves are larger than their boxes: a box
/// that moves by less than the margin costs one comparison. Results are exact with and without a
/// margin.
///
/// # Complexity
/// A change takes O(log n) for boxes that are spread in space, and always visits at most about 100
/// nodes and refits at most 48. A query with k results takes O(log n + k) for such boxes. Memory:
/// 64 bytes per node, two nodes per box, and 48 bytes per key.
///
/// ```
/// use impinge::partition::{BoxTree, Dynamic, Partition};
/// use impinge::volume::MinMax;
///
/// let mut tree = BoxTree::with_margin(0.1);
/// tree.insert(0, MinMax::new([0.0; 3], [1.0; 3])?);
/// tree.insert(7, MinMax::new([1.05; 3], [2.0; 3])?);
/// assert!(tree.pairs().is_empty(), "margins are no part of an answer");
/// tree.insert(7, MinMax::new([1.0; 3], [2.0; 3])?);
/// assert_eq!(tree.pairs(), [[0, 7]]);
/// assert_eq!(tree.nearest([3.0; 3], 1)[0].key, 7);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct BoxTree {
    bvh: DynamicBvh<MinMax, false>,
    items: Items,
    margin: f64,
}

impl BoxTree {
    /// Returns an empty tree whose leaves are as large as their boxes.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns an empty tree whose leaves extend beyond their boxes by `margin` on every side, in
    /// the unit of the boxes. A negative or NaN margin counts as zero, and a margin beyond 2^320 as
    /// 2^320.
    #[must_use]
    pub fn with_margin(margin: f64) -> Self {
        Self { margin: margin.clamp(0.0, super::best::LIMIT), ..Self::default() }
    }

    /// Returns the number of steps from the root to the deepest leaf, at most 48. It is zero for
    /// fewer than two boxes.
    #[must_use]
    pub fn height(&self) -> usize {
        self.bvh.root().map_or(0, |root| usize::from(self.node(root).height))
    }

    /// Returns the summed surface area of all inner nodes divided by that of the root, which
    /// estimates the cost of a search (MacDonald, Booth, *Heuristics for ray tracing using space
    /// subdivision*, 1990). It is zero for fewer than two boxes, or if the root has no area.
    #[must_use]
    pub fn cost(&self) -> f64 {
        let Some(root) = self.bvh.root() else { return 0.0 };
        let whole = self.node(root).bounds.surface_area();
        let mut sum = 0.0;
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let node = self.node(node);
            if !node.is_leaf() {
                sum += node.bounds.surface_area();
                stack.extend(node.children);
            }
        }
        if whole > 0.0 { sum / whole } else { 0.0 }
    }

    fn node(&self, at: u32) -> &DynamicNode<MinMax> {
        self.bvh.node(at)
    }

    /// Reports whether leaves may be larger than their boxes.
    fn is_fat(&self) -> bool {
        self.margin > 0.0
    }

    /// Returns the volume of the leaf for a box: the box enlarged by the margin.
    fn fattened(&self, bounds: &MinMax) -> MinMax {
        if !self.is_fat() {
            return *bounds;
        }
        MinMax::from_ordered(bounds.min().map(|x| x - self.margin), bounds.max().map(|x| x + self.margin))
    }
}
