//! Pairs of boxes in ascending order of the gap between them, for searches of the nearest or the
//! deepest pair of bodies.
//!
//! Source: the best-first descent of two trees (Ericson, 6.3.2, with a priority queue as in
//! Hjaltason, Samet, *Incremental distance join algorithms for spatial databases*, SIGMOD 1998).
//! Ours continues below zero: boxes that overlap are sorted by the translation that would separate
//! them.
//!
//! Tests: `tests/it/partition/gaps.rs`. Benchmark: `bench/doors.py`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::{BoxTree, MinMax};

/// Relative margin by which a gap is lowered, so that it is a lower bound. The rounding errors of a
/// gap are below 2^-50 of it.
const MARGIN: f64 = f64::EPSILON * 4.0;

/// Function that is called with the keys of a pair of boxes and with a lower bound of their gap. It
/// returns the reach: pairs whose gap is larger are skipped.
pub type GapVisitor<'v> = dyn FnMut([u32; 2], f64) -> f64 + 'v;

impl BoxTree {
    /// Visits pairs of boxes of this tree in ascending order of their gap, the smaller key first.
    /// Pairs with equal gaps come in ascending order of their keys.
    ///
    /// The gap of two boxes is the distance between them. If they overlap, it is minus the length
    /// of the shortest translation along an axis that separates them. So it is a lower bound of the
    /// signed distance of any two bodies in the boxes, up to a relative error of 2^-49.
    ///
    /// Pairs whose gap is larger than `reach` are skipped. The visitor returns the reach for the
    /// rest of the search: the smallest signed distance so far, or negative infinity to end the
    /// search.
    ///
    /// # Complexity
    /// O(n) to begin with. Each pair of nodes nearer than the reach takes O(log n).
    ///
    /// ```
    /// use impinge::partition::{BoxTree, Dynamic};
    /// use impinge::volume::MinMax;
    ///
    /// let mut tree = BoxTree::new();
    /// for (key, x) in [0.0, 5.0, 7.0].into_iter().enumerate() {
    ///     tree.insert(key as u32, MinMax::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])?);
    /// }
    /// let mut nearest = None;
    /// tree.for_each_pair_by_gap(f64::INFINITY, &mut |pair, gap| {
    ///     nearest = Some((pair, gap));
    ///     f64::NEG_INFINITY
    /// });
    /// let (pair, gap) = nearest.unwrap();
    /// assert!(pair == [1, 2] && gap <= 1.0 && 1.0 - gap < 1e-14);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    pub fn for_each_pair_by_gap(&self, reach: f64, visit: &mut GapVisitor<'_>) {
        let mut search = Search { trees: [self, self], is_own: true, queue: BinaryHeap::new(), reach };
        let mut selves: Vec<u32> = self.bvh.root().into_iter().collect();
        while let Some(at) = selves.pop() {
            let node = self.node(at);
            if !node.is_leaf() {
                selves.extend(node.children);
                search.offer(node.children);
            }
        }
        search.run(visit);
    }

    /// Visits pairs of a box of this tree and a box of `other` in ascending order of their gap, as
    /// [`for_each_pair_by_gap`](Self::for_each_pair_by_gap) does. The key of the box of this tree
    /// comes first.
    ///
    /// # Complexity
    /// Each pair of nodes nearer than the reach takes O(log n).
    pub fn for_each_pair_with_tree_by_gap(&self, other: &Self, reach: f64, visit: &mut GapVisitor<'_>) {
        let (Some(root), Some(other_root)) = (self.bvh.root(), other.bvh.root()) else { return };
        let mut search = Search { trees: [self, other], is_own: false, queue: BinaryHeap::new(), reach };
        search.offer([root, other_root]);
        search.run(visit);
    }
}

/// A best-first search over pairs of nodes.
struct Search<'t> {
    trees: [&'t BoxTree; 2],
    /// Whether both trees are the same, so that the order of a pair has no meaning.
    is_own: bool,
    queue: BinaryHeap<Entry>,
    reach: f64,
}

/// A pair of nodes, or a pair of boxes, that waits in the queue.
struct Entry {
    gap: f64,
    is_boxes: bool,
    /// Indices of two nodes, or the keys of two boxes.
    pair: [u32; 2],
}

impl Search<'_> {
    /// Queues a pair of nodes, unless it is out of reach.
    fn offer(&mut self, nodes: [u32; 2]) {
        let [a, b] = [self.trees[0].node(nodes[0]), self.trees[1].node(nodes[1])];
        let is_boxes = a.is_leaf() && b.is_leaf();
        let (gap, pair) = if is_boxes {
            let (one, other) = (a.key(), b.key());
            let keys = if self.is_own { [one.min(other), one.max(other)] } else { [one, other] };
            (gap(&self.trees[0].exact(a), &self.trees[1].exact(b)), keys)
        } else {
            (gap(&a.bounds, &b.bounds), nodes)
        };
        if gap <= self.reach {
            self.queue.push(Entry { gap, is_boxes, pair });
        }
    }

    fn run(mut self, visit: &mut GapVisitor<'_>) {
        while let Some(Entry { gap, is_boxes, pair }) = self.queue.pop() {
            if gap > self.reach {
                return;
            }
            if is_boxes {
                self.reach = self.reach.min(visit(pair, gap));
                continue;
            }
            let [a, b] = [self.trees[0].node(pair[0]), self.trees[1].node(pair[1])];
            if b.is_leaf() || (!a.is_leaf() && a.height >= b.height) {
                a.children.into_iter().for_each(|child| self.offer([child, pair[1]]));
            } else {
                b.children.into_iter().for_each(|child| self.offer([pair[0], child]));
            }
        }
    }
}

impl Ord for Entry {
    /// Compares so that the top of the heap has the smallest gap. Nodes come before boxes with an
    /// equal gap, so that all these boxes are in the queue before the first of them is visited.
    fn cmp(&self, other: &Self) -> Ordering {
        other.gap.total_cmp(&self.gap).then_with(|| (other.is_boxes, other.pair).cmp(&(self.is_boxes, self.pair)))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Entry {}

/// Returns a lower bound of the gap of two boxes. Every operation is monotone, so the result for a
/// box is never larger than the result for a box inside it.
fn gap(a: &MinMax, b: &MinMax) -> f64 {
    let (low, high) = ([a.min(), b.min()], [a.max(), b.max()]);
    let [x, y, z] = [0, 1, 2].map(|axis| (low[1][axis] - high[0][axis]).max(low[0][axis] - high[1][axis]));
    let widest = x.max(y).max(z);
    if widest <= 0.0 {
        return 0.0 + widest * (1.0 + MARGIN);
    }
    let squared = [x, y, z].map(|x| x.max(0.0) * x.max(0.0)).iter().sum::<f64>();
    // The squares of smaller numbers lose too many bits.
    if squared < f64::MIN_POSITIVE / f64::EPSILON { 0.0 } else { squared.sqrt() * (1.0 - MARGIN) }
}
