//! The dynamic bounding-volume tree as a partition: the boxes by their keys beside the tree over them, and a margin about
//! each leaf.
//!
//! Source: Catto, *Dynamic bounding volume hierarchies*, GDC 2019 (fat leaves).

mod build;
mod moves;
mod pairs;
mod queries;

use super::Items;
use crate::hierarchy::{DynamicBvh, DynamicNode};
use crate::volume::{BoundingVolume, MinMax};

/// A tree of boxes that come, go and move: the kind to take where nothing is known of them.
///
/// A box that moves stays where it is in the tree while it is inside its leaf's or its parent's volume, and is put elsewhere
/// when it is not. With a margin, leaves are fat: a box that moves by less costs one comparison, and answers are as exact
/// as without.
///
/// # Complexity
/// A change O(log n) for boxes that are spread somehow, and never more than about 100 nodes looked at and 48 refitted;
/// a question O(log n + k) likewise. 64 bytes a node, two nodes a box, and 48 bytes a key.
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
    /// A tree of nothing, whose leaves are as large as their boxes.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A tree of nothing, whose leaves are larger than their boxes by `margin` on every side. A margin that is not above zero
    /// is none, and one beyond 2^320 is that.
    #[must_use]
    pub fn with_margin(margin: f64) -> Self {
        Self { margin: margin.clamp(0.0, super::best::LIMIT), ..Self::default() }
    }

    /// Steps from the root to the deepest leaf, at most 48; zero for fewer than two boxes.
    #[must_use]
    pub fn height(&self) -> usize {
        self.bvh.root().map_or(0, |root| usize::from(self.node(root).height))
    }

    /// The area of all inner nodes over that of the root, which is what a search costs (MacDonald, Booth, *Heuristics for ray
    /// tracing using space subdivision*, 1990); zero for fewer than two boxes, or where the root has no area.
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

    /// Whether leaves may be larger than their boxes.
    fn is_fat(&self) -> bool {
        self.margin > 0.0
    }

    /// What a leaf covers for a box.
    fn fattened(&self, bounds: &MinMax) -> MinMax {
        if !self.is_fat() {
            return *bounds;
        }
        MinMax::from_ordered(bounds.min().map(|x| x - self.margin), bounds.max().map(|x| x + self.margin))
    }
}
