//! The cost of a tree: of its queries, `T = N_V C_V + N_P C_P + N_U C_U` (Gottschalk, Lin, Manocha,
//! *OBBTree*, SIGGRAPH 1996; Klosowski et al., TVCG 1998, added the updates), and statistics of the
//! tree itself.

use std::ops::AddAssign;

use super::area::{half_area, half_area_in_common};
use super::binary::{BinaryTree, LEAF_CAPACITY};
use super::wide::{Child, Node, WideTree};
use crate::simd::LANES;
use crate::volume::Aabb;

/// Numbers of operations that a traversal performed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// N_V: number of tests of two bounding volumes.
    pub volume_tests: u64,
    /// N_P: number of tests of two primitives.
    pub primitive_tests: u64,
    /// N_U: number of bounding volumes transformed from one frame to the other.
    pub updates: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.volume_tests += other.volume_tests;
        self.primitive_tests += other.primitive_tests;
        self.updates += other.updates;
    }
}

/// Duration of each operation on some machine, in seconds. The benchmark `hierarchies` measures
/// them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// C_V: duration of a test of two volumes.
    pub volume_secs: f64,
    /// C_P: duration of a test of two primitives.
    pub primitive_secs: f64,
    /// C_U: duration of transforming a volume from one frame to the other.
    pub update_secs: f64,
}

impl Costs {
    /// Returns the time of the counted operations in seconds: `N_V C_V + N_P C_P + N_U C_U`.
    ///
    /// ```
    /// use impinge::hierarchy::{Costs, Counters};
    ///
    /// let costs = Costs { volume_secs: 2e-9, primitive_secs: 50e-9, update_secs: 5e-9 };
    /// let work = Counters { volume_tests: 1_000_000, primitive_tests: 10_000, updates: 100_000 };
    /// assert!((costs.seconds(&work) - 3e-3).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn seconds(&self, work: &Counters) -> f64 {
        work.volume_tests as f64 * self.volume_secs
            + work.primitive_tests as f64 * self.primitive_secs
            + work.updates as f64 * self.update_secs
    }
}

/// Statistics of a tree. Areas are given as ratios, so they do not depend on the unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStatistics {
    /// Number of inner nodes.
    pub inner: usize,
    /// Number of leaves.
    pub leaves: usize,
    /// Number of steps from the root to the deepest leaf.
    pub depth: usize,
    /// Expected number of nodes, leaves included, that a small object inside the root's box
    /// overlaps: the sum of all areas divided by the area of the root. Zero if the root has no
    /// area.
    pub sah: f64,
    /// Overlap of siblings: the areas that pairs of children have in common, summed over all inner
    /// nodes and divided by the sum of the areas of the inner nodes. Zero if no children overlap.
    pub overlap: f64,
    /// Fraction of the slots for children that inner nodes use, from 0 to 1.
    pub node_fill: f64,
    /// Fraction of the slots for boxes that leaves use, from 0 to 1.
    pub leaf_fill: f64,
    /// Size of the nodes in bytes.
    pub bytes: usize,
}

impl BinaryTree {
    /// Returns the number of steps from the root to the deepest leaf, or zero if there are no
    /// boxes.
    #[must_use]
    pub fn depth(&self) -> usize {
        let mut deepest = 0;
        let mut pending = vec![(0_u32, 0)];
        while let Some((at, depth)) = pending.pop() {
            deepest = deepest.max(depth);
            if let Some(right) = self.nodes.get(at as usize).and_then(|node| node.right) {
                pending.extend([(at + 1, depth + 1), (at + right.get(), depth + 1)]);
            }
        }
        deepest
    }

    /// Computes the statistics of the tree.
    #[must_use]
    pub fn statistics(&self) -> TreeStatistics {
        let mut sums = Sums::default();
        for (at, node) in self.nodes.iter().enumerate() {
            match node.right {
                None => sums.leaf(&node.bounds, node.count as usize),
                Some(right) => {
                    let children = [at + 1, at + right.get() as usize].map(|child| self.nodes[child].bounds);
                    sums.inner(&node.bounds, &children);
                }
            }
        }
        sums.over(self.nodes.first().map(|root| &root.bounds), 2, self.depth(), size_of_val(&self.nodes[..]))
    }
}

impl WideTree {
    /// Computes the statistics of the tree. `held` returns the number of boxes in a leaf.
    #[must_use]
    pub fn statistics(&self, held: impl Fn(u32) -> usize) -> TreeStatistics {
        let mut sums = Sums::default();
        let mut deepest = 0;
        let root = self.nodes().first().map(Node::bounds);
        // The nodes to visit, each with its own box and depth.
        let mut pending: Vec<(u32, Aabb, usize)> = root.iter().map(|&bounds| (0, bounds, 0)).collect();
        while let Some((at, bounds, depth)) = pending.pop() {
            let node = &self.nodes()[at as usize];
            let boxes: [Aabb; LANES] = std::array::from_fn(|lane| node.lane_bounds(lane));
            sums.inner(&bounds, &boxes[..node.count()]);
            deepest = deepest.max(depth + 1);
            for lane in 0..node.count() {
                match node.child(lane) {
                    Child::Inner(child) => pending.push((child, boxes[lane], depth + 1)),
                    Child::Leaf(leaf) => sums.leaf(&boxes[lane], held(leaf)),
                }
            }
        }
        sums.over(root.as_ref(), LANES, deepest, size_of_val(self.nodes()))
    }

    /// Returns the boxes at a level: the root's own at level 0, its children's at level 1, and so
    /// on. They are in the frame of the tree's boxes. A leaf above the level stands for its missing
    /// descendants. Returns no boxes if the tree is empty.
    #[must_use]
    pub fn level(&self, level: usize) -> Vec<Aabb> {
        let mut found = Vec::new();
        let root = self.nodes().first().map(Node::bounds);
        let mut pending: Vec<(Child, Aabb, usize)> = root.iter().map(|&bounds| (Child::Inner(0), bounds, 0)).collect();
        while let Some((at, bounds, depth)) = pending.pop() {
            match at {
                Child::Inner(node) if depth < level => {
                    let node = &self.nodes()[node as usize];
                    let lanes = (0..node.count()).rev();
                    pending.extend(lanes.map(|lane| (node.child(lane), node.lane_bounds(lane), depth + 1)));
                }
                _ => found.push(bounds),
            }
        }
        found
    }
}

impl Node {
    /// Returns the box of one lane.
    #[inline(always)]
    pub(crate) fn lane_bounds(&self, lane: usize) -> Aabb {
        Aabb {
            min: crate::simd::by_axis!(axis => self.min[axis][lane]),
            max: crate::simd::by_axis!(axis => self.max[axis][lane]),
        }
    }

    /// Returns the box of all lanes. Unused lanes hold the empty box, so they do not matter.
    #[inline(always)]
    pub(super) fn bounds(&self) -> Aabb {
        Aabb { min: self.min.map(|lanes| least(&lanes)), max: self.max.map(|lanes| -least(&lanes.map(|x| -x))) }
    }
}

/// Returns the minimum of the lanes. It compares halves, which the vector unit does side by side.
#[inline(always)]
fn least(lanes: &[f32; LANES]) -> f32 {
    let lesser = |a: f32, b: f32| if a < b { a } else { b };
    let four: [f32; 4] = std::array::from_fn(|lane| lesser(lanes[lane], lanes[lane + 4]));
    lesser(lesser(four[0], four[2]), lesser(four[1], four[3]))
}

/// The sums from which the statistics are computed.
#[derive(Default)]
struct Sums {
    inner: usize,
    leaves: usize,
    children: usize,
    boxes: usize,
    inner_area: f64,
    leaf_area: f64,
    common_area: f64,
}

impl Sums {
    fn inner(&mut self, bounds: &Aabb, children: &[Aabb]) {
        self.inner += 1;
        self.children += children.len();
        self.inner_area += half_area(bounds);
        for (at, a) in children.iter().enumerate() {
            self.common_area += children[..at].iter().map(|b| half_area_in_common(a, b)).sum::<f64>();
        }
    }

    fn leaf(&mut self, bounds: &Aabb, held: usize) {
        self.leaves += 1;
        self.boxes += held;
        self.leaf_area += half_area(bounds);
    }

    fn over(self, root: Option<&Aabb>, degree: usize, depth: usize, bytes: usize) -> TreeStatistics {
        let ratio = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        TreeStatistics {
            inner: self.inner,
            leaves: self.leaves,
            depth,
            sah: root.map_or(0.0, |root| ratio(self.inner_area + self.leaf_area, half_area(root))),
            overlap: ratio(self.common_area, self.inner_area),
            node_fill: ratio(self.children as f64, (degree * self.inner) as f64),
            leaf_fill: ratio(self.boxes as f64, (LEAF_CAPACITY * self.leaves) as f64),
            bytes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Builder;

    fn unit_box_at(x: f32) -> Aabb {
        Aabb { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 1.0] }
    }

    #[test]
    fn two_groups_of_boxes_have_the_statistics_of_two_leaves() {
        for (second, overlap) in [(3.0, 0.0), (0.5, 2.0 / 4.0)] {
            let boxes: Vec<Aabb> = [0.0, second].iter().flat_map(|&x| [unit_box_at(x); LEAF_CAPACITY]).collect();
            let binary = Builder::Median.build(&boxes);
            let (wide, leaves) = WideTree::collapse(&binary);
            let held = |leaf: u32| binary.nodes[leaves[leaf as usize] as usize].count as usize;
            // Half areas: of the root, which is second + 1 long, of each leaf, and of their
            // intersection.
            let root = f64::from(2.0 * (second + 1.0) + 1.0);
            for (statistics, node_fill) in [(binary.statistics(), 1.0), (wide.statistics(held), 0.25)] {
                assert_eq!((statistics.inner, statistics.leaves, statistics.depth), (1, 2, 1));
                assert!((statistics.sah - (root + 6.0) / root).abs() < 1e-12, "{statistics:?}");
                assert!((statistics.overlap - overlap).abs() < 1e-12, "{statistics:?}");
                assert_eq!((statistics.node_fill, statistics.leaf_fill), (node_fill, 1.0));
            }
            assert_eq!(wide.level(0), [unit_box_at(0.0).union(unit_box_at(second))]);
            assert_eq!(wide.level(1), [unit_box_at(0.0), unit_box_at(second)]);
            assert_eq!(wide.level(9), wide.level(1));
        }
    }

    #[test]
    fn empty_and_flat_trees_have_finite_statistics() {
        let (wide, _) = WideTree::collapse(&BinaryTree::<Aabb>::default());
        assert_eq!(BinaryTree::default().statistics(), TreeStatistics::default());
        assert_eq!((wide.statistics(|_| 0), wide.level(3)), (TreeStatistics::default(), Vec::new()));
        let points = Builder::Ploc.build(&[Aabb { min: [1.0; 3], max: [1.0; 3] }; 20]);
        let statistics = points.statistics();
        assert!(statistics.sah == 0.0 && statistics.overlap == 0.0 && statistics.leaf_fill > 0.5, "{statistics:?}");
    }
}
