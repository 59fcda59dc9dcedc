//! The default builder. It sorts boxes along a space-filling curve and splits them at the
//! boundaries of its cells, down to clusters, which are split by planes and at medians.
//!
//! Source: Lauterbach et al., *Fast BVH construction on GPUs*, Eurographics 2009; Karras,
//! *Maximizing parallelism in the construction of BVHs*, HPG 2012. Ours departs in three ways:
//! - A cell that holds more than a cluster gets a curve of its own, so small detail in a large
//!   scene keeps its order.
//! - The depth is bounded: once the curve has split often enough, ranges are halved.
//! - The bottom consists of clusters. Their leaves and nodes are full and compact where the curve
//!   would jump.
//!
//! Tests: `hierarchy/tests.rs`. Benchmark: `hierarchies`.

use std::num::NonZeroU32;
use std::sync::{Mutex, PoisonError};

use super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY};
use super::boxes::{Bounds, Boxes, Center};
use super::cluster::{Cluster, MAX_CLUSTER};
use super::digit_order::DigitOrder;
use crate::simd::{dispatch_widest, widest_level};
use crate::storage::Pages;
use crate::volume::Aabb;

/// Depth from which ranges are halved, whatever their codes are. 2^32 boxes halved 19 times leave
/// one cluster, which is at most 17 deep. So no leaf is deeper than 27 + 19 + 17, which is below
/// [`MAX_DEPTH`](super::MAX_DEPTH).
const HALVE_FROM_DEPTH: usize = 27;

/// Maximum number of boxes of a task if there is more than one thread.
const MAX_TASK: usize = 1 << 15;

/// Builds the tree of these boxes by splitting them along a Morton curve; no box may be empty.
/// Returns an empty tree for no boxes. The tree is the same for any number of threads.
///
/// # Complexity
/// O(n log n), depth at most [`MAX_DEPTH`](super::MAX_DEPTH) for any input: equal, nested or sorted
/// boxes included.
#[must_use]
pub fn build_morton(boxes: &[Aabb]) -> BinaryTree {
    tree_along_curve(boxes, |group| {
        group.iter().fold(Aabb::EMPTY, |bounds, &index| bounds.union(boxes[index as usize]))
    })
}

/// Builds the tree of these boxes. `bounds` computes the bounds of a group of boxes from their
/// indices.
pub(crate) fn tree_along_curve<B: Bounds>(
    boxes: &(impl Boxes + ?Sized),
    bounds: impl Fn(&[u32]) -> B + Sync,
) -> BinaryTree<B> {
    let len = boxes.len();
    if len == 0 {
        return BinaryTree::default();
    }
    let mut centers = Pages::<Center>::zeroed(len);
    let centers = centers.to_mut();
    let digits = Some(DigitOrder::of(boxes, centers));
    let mut order = Pages::zeroed(len);
    let mut blocks = Vec::new();
    let task = if rayon::current_num_threads() == 1 { len } else { MAX_TASK };
    let builder = Builder { bounds, task, idle: Mutex::default() };
    builder.subtree(Range { centers, order: order.to_mut(), first: 0, depth: 0, digits }, &mut blocks);
    let nodes = if blocks.len() == 1 { blocks.swap_remove(0) } else { blocks.concat() };
    BinaryTree { nodes, order }
}

struct Builder<F> {
    bounds: F,
    /// Maximum number of boxes of a task. Longer ranges are built as two tasks.
    task: usize,
    /// Scratch memory that no task uses at the moment, at most one for each thread. It is reused
    /// because new memory costs time.
    idle: Mutex<Vec<Scratch>>,
}

/// A range of centers and the part of the order that it writes. `first` is its start, and `depth`
/// the depth of its node.
struct Range<'a> {
    centers: &'a mut [Center],
    order: &'a mut [u32],
    first: usize,
    depth: usize,
    /// The order of the centers along a curve, or `None` if the range is halved down to clusters.
    digits: Option<DigitOrder>,
}

impl Range<'_> {
    /// Splits a range longer than a cluster into two nonempty parts, at a boundary of the curve's
    /// cells. `spare` is scratch memory for sorting.
    fn split(&mut self, spare: &mut Vec<Center>) -> (Range<'_>, Range<'_>) {
        let digits = self.digits.take().filter(|_| self.depth < HALVE_FROM_DEPTH);
        let (middle, low_digits, high_digits) = match digits.and_then(|digits| digits.refined(self.centers, spare)) {
            Some(digits) => {
                let (middle, low, high) = digits.split();
                (middle, Some(low), Some(high))
            }
            None => (self.centers.len() / 2, None, None),
        };
        let (low_centers, high_centers) = self.centers.split_at_mut(middle);
        let (low_order, high_order) = self.order.split_at_mut(middle);
        let (first, depth) = (self.first, self.depth + 1);
        (
            Range { centers: low_centers, order: low_order, first, depth, digits: low_digits },
            Range { centers: high_centers, order: high_order, first: first + middle, depth, digits: high_digits },
        )
    }
}

/// Scratch memory that is reused for one range after another.
#[derive(Default)]
struct Scratch {
    spare: Vec<Center>,
    cluster: Cluster,
}

impl<B: Bounds, F: Fn(&[u32]) -> B + Sync> Builder<F> {
    /// Appends the nodes of a range in preorder, in blocks. Returns its bounds and its number of
    /// nodes.
    fn subtree(&self, mut range: Range<'_>, blocks: &mut Vec<Vec<BinaryNode<B>>>) -> (B, usize) {
        let (first, count) = (range.first as u32, range.centers.len());
        if count <= self.task {
            // Nearly all leaves are full. Some spare capacity costs less than moving all nodes when
            // they exceed it.
            let mut nodes = Vec::with_capacity(count / (LEAF_CAPACITY / 2) + count / (2 * LEAF_CAPACITY) + 1);
            let bounds = self.with_scratch(|scratch| self.emit(range, &mut nodes, scratch));
            let len = nodes.len();
            blocks.push(nodes);
            return (bounds, len);
        }
        let (low, high) = self.with_scratch(|scratch| range.split(&mut scratch.spare));
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

    /// Runs a task with scratch memory of its own.
    fn with_scratch<R>(&self, task: impl FnOnce(&mut Scratch) -> R) -> R {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = idle().pop().unwrap_or_default();
        let result = task(&mut scratch);
        idle().push(scratch);
        result
    }

    /// Appends the nodes of a range, the root first, and returns its bounds.
    fn emit(&self, mut range: Range<'_>, nodes: &mut Vec<BinaryNode<B>>, scratch: &mut Scratch) -> B {
        let (first, count) = (range.first as u32, range.centers.len());
        if count <= MAX_CLUSTER {
            let Range { centers, order, .. } = range;
            let cluster = &mut scratch.cluster;
            return dispatch_widest!(widest_level(), simd => cluster.emit(simd, centers, &self.bounds, order, first, nodes));
        }
        let (low, high) = range.split(&mut scratch.spare);
        let at = nodes.len();
        nodes.push(BinaryNode { bounds: B::EMPTY, first, count: count as u32, right: None });
        let left = self.emit(low, nodes, scratch);
        let right_at = NonZeroU32::new((nodes.len() - at) as u32);
        let bounds = left.union(self.emit(high, nodes, scratch));
        nodes[at].bounds = bounds;
        nodes[at].right = right_at;
        bounds
    }
}
