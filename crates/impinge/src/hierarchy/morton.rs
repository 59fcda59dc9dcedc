//! The default builder: boxes sorted along a space-filling curve and split where its cells split, down to clusters that
//! are split by planes and at medians.
//!
//! Source: Lauterbach et al., *Fast BVH construction on GPUs*, Eurographics 2009; Karras, *Maximizing parallelism in the
//! construction of BVHs*, HPG 2012. Ours departs in three ways: a cell that holds more than a cluster gets a curve of its
//! own, so that small detail in a large scene keeps its order; a bounded depth, by halving ranges once the curve has
//! split often enough; and clusters at the bottom, whose leaves and nodes are full and compact where a curve would jump.

use std::num::NonZeroU32;
use std::sync::{Mutex, PoisonError};

use super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY};
use super::boxes::{Bounds, Boxes, Centre};
use super::cluster::{CLUSTER, Cluster};
use super::deals::Deals;
use crate::simd::{dispatch_widest, widest_level};
use crate::storage::Pages;
use crate::volume::Aabb;

/// Depth from which ranges are halved whatever the codes say: 2^32 boxes halved 19 times leave one cluster, which is at
/// most 17 deep, so that no leaf is deeper than 27 + 19 + 17, below [`MAX_DEPTH`](super::MAX_DEPTH).
const HALVE_FROM_DEPTH: usize = 27;

/// The most boxes of a task where there is more than one thread.
const LONGEST_TASK: usize = 1 << 15;

/// The tree of these boxes, none of which may be empty; the same for any number of threads.
///
/// # Complexity
/// O(n log n), depth at most [`MAX_DEPTH`](super::MAX_DEPTH) for any input: equal, nested or sorted boxes included.
#[must_use]
pub fn build_morton(boxes: &[Aabb]) -> BinaryTree {
    tree_along_curve(boxes, |group| {
        group.iter().fold(Aabb::EMPTY, |bounds, &index| bounds.union(boxes[index as usize]))
    })
}

/// The tree of these boxes, with what `bounds` keeps of the boxes of a group.
pub(crate) fn tree_along_curve<B: Bounds>(
    boxes: &(impl Boxes + ?Sized),
    bounds: impl Fn(&[u32]) -> B + Sync,
) -> BinaryTree<B> {
    let len = boxes.len();
    if len == 0 {
        return BinaryTree::default();
    }
    let mut centres = Pages::<Centre>::zeroed(len);
    let centres = centres.to_mut();
    let deals = Some(Deals::of(boxes, centres));
    let mut order = Pages::zeroed(len);
    let mut blocks = Vec::new();
    let task = if rayon::current_num_threads() == 1 { len } else { LONGEST_TASK };
    let builder = Builder { bounds, task, idle: Mutex::default() };
    builder.subtree(Range { centres, order: order.to_mut(), first: 0, depth: 0, deals }, &mut blocks);
    let nodes = if blocks.len() == 1 { blocks.swap_remove(0) } else { blocks.concat() };
    BinaryTree { nodes, order }
}

struct Builder<F> {
    bounds: F,
    /// Ranges longer than this are built as two tasks.
    task: usize,
    /// What no task uses at the time: as much as there are threads at most, as memory is dear when it is new.
    idle: Mutex<Vec<Passing>>,
}

/// A range of the centres, its part of the order, which is written, where it starts, and how deep its node lies.
struct Range<'a> {
    centres: &'a mut [Centre],
    order: &'a mut [u32],
    first: usize,
    depth: usize,
    /// How it lies on a curve; `None` where it is halved down to the clusters.
    deals: Option<Deals>,
}

impl Range<'_> {
    /// The two parts, neither of them empty, of a range longer than a cluster: as the curve's cells split. `spare` is for what is
    /// dealt out again.
    fn split(&mut self, spare: &mut Vec<Centre>) -> (Range<'_>, Range<'_>) {
        let deals = self.deals.take().filter(|_| self.depth < HALVE_FROM_DEPTH);
        let (middle, low_deals, high_deals) = match deals.and_then(|deals| deals.parted(self.centres, spare)) {
            Some(deals) => {
                let (middle, low, high) = deals.split();
                (middle, Some(low), Some(high))
            }
            None => (self.centres.len() / 2, None, None),
        };
        let (low_centres, high_centres) = self.centres.split_at_mut(middle);
        let (low_order, high_order) = self.order.split_at_mut(middle);
        let (first, depth) = (self.first, self.depth + 1);
        (
            Range { centres: low_centres, order: low_order, first, depth, deals: low_deals },
            Range { centres: high_centres, order: high_order, first: first + middle, depth, deals: high_deals },
        )
    }
}

/// Room for one range after another.
#[derive(Default)]
struct Passing {
    dealt: Vec<Centre>,
    cluster: Cluster,
}

impl<B: Bounds, F: Fn(&[u32]) -> B + Sync> Builder<F> {
    /// Appends the nodes of a range in preorder, in blocks, and returns its bounds and how many nodes there are.
    fn subtree(&self, mut range: Range<'_>, blocks: &mut Vec<Vec<BinaryNode<B>>>) -> (B, usize) {
        let (first, count) = (range.first as u32, range.centres.len());
        if count <= self.task {
            // Hardly a leaf is not full; to move all of it once there are more takes longer than some more room.
            let mut nodes = Vec::with_capacity(count / (LEAF_CAPACITY / 2) + count / (2 * LEAF_CAPACITY) + 1);
            let bounds = self.with_passing(|passing| self.emit(range, &mut nodes, passing));
            let len = nodes.len();
            blocks.push(nodes);
            return (bounds, len);
        }
        let (low, high) = self.with_passing(|passing| range.split(&mut passing.dealt));
        let (mut left_blocks, mut right_blocks) = (Vec::new(), Vec::new());
        let ((left, left_len), (right, right_len)) =
            rayon::join(|| self.subtree(low, &mut left_blocks), || self.subtree(high, &mut right_blocks));
        let bounds = left.union(right);
        let right = NonZeroU32::new(1 + left_len as u32);
        blocks.push(vec![BinaryNode { bounds, first, count: count as u32, right }]);
        blocks.append(&mut left_blocks);
        blocks.append(&mut right_blocks);
        (bounds, 1 + left_len + right_len)
    }

    /// Runs a task with room of its own.
    fn with_passing<R>(&self, task: impl FnOnce(&mut Passing) -> R) -> R {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let mut passing = idle().pop().unwrap_or_default();
        let result = task(&mut passing);
        idle().push(passing);
        result
    }

    /// Appends the nodes of a range, the root first, and returns its bounds.
    fn emit(&self, mut range: Range<'_>, nodes: &mut Vec<BinaryNode<B>>, passing: &mut Passing) -> B {
        let (first, count) = (range.first as u32, range.centres.len());
        if count <= CLUSTER {
            let Range { centres, order, .. } = range;
            let cluster = &mut passing.cluster;
            return dispatch_widest!(widest_level(), simd => cluster.emit(simd, centres, &self.bounds, order, first, nodes));
        }
        let (low, high) = range.split(&mut passing.dealt);
        let at = nodes.len();
        nodes.push(BinaryNode { bounds: B::EMPTY, first, count: count as u32, right: None });
        let left = self.emit(low, nodes, passing);
        let right_at = NonZeroU32::new((nodes.len() - at) as u32);
        let bounds = left.union(self.emit(high, nodes, passing));
        nodes[at].bounds = bounds;
        nodes[at].right = right_at;
        bounds
    }
}
