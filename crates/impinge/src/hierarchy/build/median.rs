//! A top-down builder that splits at the median: half of the boxes go to either side of a plane
//! across the axis along which their centers spread most.
//!
//! Source: Ericson, 6.2.2. Ours rounds halves to whole leaves, so that all leaves but one are full.

use std::num::NonZeroU32;

use super::super::binary::{BinaryNode, BinaryTree};
use super::item::{Item, bounds, order, twice_center_bounds};
use super::top_down::{self, Choice, Range};
use crate::volume::Aabb;

/// Builds the tree of these boxes; there must be at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let mut items = Item::all(boxes);
    let nodes = top_down::nodes(Halved { items: &mut items, capacity }, capacity);
    BinaryTree { nodes, order: order(&items).into() }
}

/// Splits the leaves with more than `capacity` boxes at medians and returns the new tree.
pub(super) fn cut_leaves(tree: &BinaryTree, boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let (mut nodes, mut order) = (Vec::<BinaryNode>::new(), Vec::with_capacity(tree.order.len()));
    // The nodes to copy, each with its depth. Each right child also has the new index of its
    // parent.
    let mut pending: Vec<(u32, usize, Option<usize>)> = vec![(0, 0, None)];
    while let Some((at, depth, parent)) = pending.pop() {
        let node = tree.nodes[at as usize];
        let here = nodes.len();
        if let Some(parent) = parent {
            nodes[parent].right = NonZeroU32::new((here - parent) as u32);
        }
        match node.right {
            Some(right) => {
                nodes.push(node);
                pending.extend([(at + right.get(), depth + 1, Some(here)), (at + 1, depth + 1, None)]);
            }
            None => {
                let held = tree.held(at).iter().map(|&index| Item::new(&boxes[index as usize], index));
                append(&mut nodes, &mut order, &mut held.collect::<Vec<_>>(), capacity, depth);
            }
        }
    }
    BinaryTree { nodes, order: order.into() }
}

/// Appends the median tree of some boxes as a subtree at `depth`, and appends their order.
pub(super) fn append(
    nodes: &mut Vec<BinaryNode>,
    order: &mut Vec<u32>,
    items: &mut [Item],
    capacity: usize,
    depth: usize,
) {
    let halved = Halved { items: &mut *items, capacity };
    nodes.extend(top_down::nodes_from(halved, capacity, order.len(), depth));
    order.extend(items.iter().map(Item::index));
}

/// Splits items into halves along the widest axis of their centers. Returns the number of items in
/// the first half.
pub(super) fn halves(items: &mut [Item], centers: &Aabb, capacity: usize) -> usize {
    let middle = top_down::middle(items.len(), capacity);
    let axis = widest(centers);
    items.select_nth_unstable_by_key(middle, |item| item.key(axis));
    middle
}

/// Returns the axis along which a box is longest.
fn widest(bounds: &Aabb) -> usize {
    // Half extents do not overflow.
    let extent: [f32; 3] = std::array::from_fn(|axis| 0.5 * bounds.max[axis] - 0.5 * bounds.min[axis]);
    if extent[0] >= extent[1] && extent[0] >= extent[2] {
        0
    } else if extent[1] >= extent[2] {
        1
    } else {
        2
    }
}

struct Halved<'a> {
    items: &'a mut [Item],
    capacity: usize,
}

impl Range for Halved<'_> {
    fn len(&self) -> usize {
        self.items.len()
    }

    fn bounds(&self) -> Aabb {
        bounds(self.items)
    }

    fn split(self, _: Choice) -> (Self, Self) {
        let centers = twice_center_bounds(self.items);
        let middle = halves(self.items, &centers, self.capacity);
        let (low, high) = self.items.split_at_mut(middle);
        (Self { items: low, ..self }, Self { items: high, capacity: self.capacity })
    }
}
