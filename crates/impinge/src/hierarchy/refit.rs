//! Refitting: computes new boxes and slabs for a tree whose nodes stay, from the leaves up.
//!
//! Source: van den Bergen, *Efficient collision detection of complex deformable models using AABB
//! trees*, Journal of Graphics Tools 2(4), 1997 (Ericson, 6.6). Ours works in patches: subtrees
//! that one thread refits together with the items in their leaves, while both are in its cache.
//! Nodes are in preorder, so a patch is one range of nodes and one range of leaves.
//!
//! Benchmark: `refit`.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x4};

use super::area::{cost, half_area};
use super::lanes::BoxLanes;
use super::slab::Slab;
use super::wide::{MAX_PATCH_LEAVES, Node, WideTree};
use crate::simd::{LANES, Lanes3, across3, by_axis, load3, prefetch, store3};
use crate::volume::Aabb;

/// Number of nodes by which the prefetch runs ahead.
const PREFETCH_AHEAD: usize = 2;

const LANE_NUMBERS: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The nodes and leaves of a subtree with at most [`MAX_PATCH_LEAVES`] leaves, whose parent, if
/// any, has more. Only nodes of patches have slabs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Patch {
    pub(crate) nodes: Range<usize>,
    pub(crate) leaves: Range<usize>,
}

/// A partition of a tree: the patches in preorder, and the nodes above them in preorder.
#[derive(Debug, Default)]
pub(crate) struct Patches {
    pub(crate) patches: Vec<Patch>,
    above: Vec<usize>,
}

impl Patches {
    /// Partitions a sound tree with this many leaves.
    ///
    /// # Complexity
    /// O(number of nodes above the patches, times the depth).
    pub(crate) fn of(tree: &WideTree, leaves: usize) -> Self {
        let nodes = tree.nodes();
        let mut found = Self::default();
        let mut pending = Vec::new();
        pending.extend((!nodes.is_empty()).then_some(Patch { nodes: 0..nodes.len(), leaves: 0..leaves }));
        while let Some(subtree) = pending.pop() {
            if subtree.leaves.len() <= MAX_PATCH_LEAVES {
                found.patches.push(subtree);
                continue;
            }
            let at = subtree.nodes.start;
            found.above.push(at);
            // Push the last child first, so that the first child is popped next.
            let Range { end: mut nodes_end, .. } = subtree.nodes;
            let Range { end: mut leaves_end, .. } = subtree.leaves;
            for lane in (0..nodes[at].count()).rev() {
                let child = nodes[at].index(lane) as usize;
                let first_leaf = first_leaf(nodes, child);
                pending.push(Patch { nodes: child..nodes_end, leaves: first_leaf..leaves_end });
                (nodes_end, leaves_end) = (child, first_leaf);
            }
        }
        found
    }

    /// Returns each patch with its own nodes.
    pub(crate) fn split<'a>(&self, mut nodes: &'a mut [Node]) -> Vec<Work<'a>> {
        let mut before = 0;
        let mut work = Vec::with_capacity(self.patches.len());
        for patch in &self.patches {
            let (own, rest) = nodes.split_at_mut(patch.nodes.end - before);
            work.push(Work { patch: patch.clone(), nodes: &mut own[patch.nodes.start - before..] });
            (nodes, before) = (rest, patch.nodes.end);
        }
        work
    }

    /// Refits the nodes above the patches.
    pub(crate) fn refit_above(&self, nodes: &mut [Node]) {
        for &at in self.above.iter().rev() {
            nodes[at] = self.refitted_above(nodes, at);
        }
    }

    /// Returns the [cost](WideTree::cost) of the tree, given the sum of the areas below the nodes
    /// of each patch.
    pub(crate) fn cost(&self, nodes: &[Node], of_patches: &[f64]) -> f64 {
        let Some(root) = nodes.first() else { return 1.0 };
        let above: f64 = self.above.iter().rev().map(|&at| nodes[at].area_below()).sum();
        let area = half_area(&root.bounds());
        cost(area + (of_patches.iter().sum::<f64>() + above), area)
    }

    /// Reports whether a refit would leave the nodes above the patches unchanged, to the bit.
    pub(crate) fn are_fitted_above(&self, nodes: &[Node]) -> bool {
        self.above
            .iter()
            .all(|&at| bytemuck::bytes_of(&self.refitted_above(nodes, at)) == bytemuck::bytes_of(&nodes[at]))
    }

    fn refitted_above(&self, nodes: &[Node], at: usize) -> Node {
        let mut node = Node { slab: Slab::ALL, ..nodes[at] };
        for lane in 0..node.count() {
            node.set_bounds(lane, &nodes[node.index(lane) as usize].bounds());
        }
        node.set_extent(&node.bounds());
        node
    }
}

/// A patch to refit, with its nodes.
pub(crate) struct Work<'a> {
    pub(crate) patch: Patch,
    pub(crate) nodes: &'a mut [Node],
}

/// The current items in the leaves of a patch. Leaves are counted from the patch's first.
pub(crate) trait Leaves {
    /// Reads the items of a node's leaves. Returns their boxes, with arbitrary boxes in the unused
    /// lanes, and the direction that the items face. Directions of several nodes can be added up.
    /// Calls start with the last leaves.
    fn fit(&mut self, leaves: Range<usize>) -> (BoxLanes, [f32; 3]);

    /// Returns the slab around the items of some leaves. All of them have been read by `fit`;
    /// `bounds` is their box.
    fn slab(&self, leaves: Range<usize>, bounds: &Aabb, facing: [f32; 3]) -> Slab;
}

/// The summary of the subtree below a node of a patch.
#[derive(Clone)]
struct Below {
    leaves: Range<usize>,
    bounds: Aabb,
    facing: [f32; 3],
}

impl Below {
    const NOTHING: Self = Self { leaves: 0..0, bounds: Aabb::EMPTY, facing: [0.0; 3] };
}

impl Patch {
    /// Refits `nodes`, the nodes of the patch, to the items in its leaves, each node right after
    /// its descendants. Returns the sum of the areas of all nodes' children.
    #[inline(always)]
    pub(crate) fn refit<S: Simd>(&self, simd: S, nodes: &mut [Node], leaves: &mut impl Leaves) -> f64 {
        let mut area = 0.0;
        // Children come after their parents, and their leaves are consecutive.
        let mut below = vec![Below::NOTHING; nodes.len()];
        for at in (0..nodes.len()).rev() {
            if let Some(ahead) = at.checked_sub(PREFETCH_AHEAD) {
                prefetch(&nodes[ahead]);
            }
            let node = &mut nodes[at];
            let count = node.count();
            let mut held = Below::NOTHING;
            let mut boxes = BoxLanes::default();
            if node.holds_leaves() {
                let first = node.index(0) as usize - self.leaves.start;
                held.leaves = first..first + count;
                (boxes, held.facing) = leaves.fit(held.leaves.clone());
            } else {
                for lane in 0..count {
                    let Below { leaves, bounds, facing } = &below[node.index(lane) as usize - self.nodes.start];
                    boxes.set_lane(lane, bounds);
                    let first = if lane == 0 { leaves.start } else { held.leaves.start };
                    held.leaves = first..leaves.end;
                    held.facing = by_axis!(axis => held.facing[axis] + facing[axis]);
                }
            }
            let (bounds, area_below) = node.fit(simd, &boxes);
            node.slab = leaves.slab(held.leaves.clone(), &bounds, held.facing);
            area += area_below;
            below[at] = Below { bounds, ..held };
        }
        area
    }
}

impl Node {
    /// Sets the boxes of the used lanes. Returns the box around them all, and the [sum of their
    /// areas](Self::area_below).
    ///
    /// The number of used lanes is unpredictable, so there is no branch on it.
    #[inline(always)]
    fn fit<S: Simd>(&mut self, simd: S, boxes: &BoxLanes) -> (Aabb, f64) {
        let number = f32x8::from_slice(simd, &LANE_NUMBERS);
        let is_in_use = number.simd_lt(f32x8::splat(simd, self.count() as f32));
        let (min, max): (Lanes3<S>, Lanes3<S>) = (load3(simd, &boxes.min), load3(simd, &boxes.max));
        let none = f32x8::splat(simd, f32::INFINITY);
        let held_min: Lanes3<S> = by_axis!(axis => is_in_use.select(min[axis], none));
        let held_max: Lanes3<S> = by_axis!(axis => is_in_use.select(max[axis], -none));
        store3(&held_min, &mut self.min);
        store3(&held_max, &mut self.max);
        let bounds = Aabb {
            min: across3(
                &held_min,
                #[inline(always)]
                |a, b| a.min(b),
            ),
            max: across3(
                &held_max,
                #[inline(always)]
                |a, b| a.max(b),
            ),
        };
        self.set_extent(&bounds);
        let edges: [(f64x4<S>, f64x4<S>); 3] = by_axis!(axis => {
            // Unused lanes have zero extent.
            let (from, to) = (min[axis].widen(), is_in_use.select(max[axis], min[axis]).widen());
            (to.0 - from.0, to.1 - from.1)
        });
        let [(x, p), (y, q), (z, r)] = edges;
        let areas = (x * y + y * z + z * x) + (p * q + q * r + r * p);
        let [a, b, c, d] = <[f64; 4]>::from(areas);
        (bounds, (a + c) + (b + d))
    }
}

/// Returns the first leaf below a node.
fn first_leaf(nodes: &[Node], mut at: usize) -> usize {
    while !nodes[at].holds_leaves() {
        at = nodes[at].index(0) as usize;
    }
    nodes[at].index(0) as usize
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch_every;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::simd::kernel_levels;

    /// A node gets exactly the boxes of its children, whatever the unused lanes hold. The results
    /// for all lanes at once equal those lane by lane, to the bit and at every vector level.
    #[test]
    fn fitting_all_lanes_at_once_equals_fitting_each_lane() {
        let mut rng = Rng::new(172);
        let mut flat = 0;
        for round in 0..2_000 {
            let count = round % LANES + 1;
            let mut boxes = BoxLanes::default();
            for lane in 0..LANES {
                // On a grid, so that several boxes have the same minimum, and some have no extent.
                let [p, q] = [0; 2].map(|_| [0; 3].map(|_| rng.integer(-4, 4) as f32 + 0.25));
                flat += usize::from((0..3).any(|axis| p[axis] == q[axis]));
                boxes.set_lane(lane, &Aabb::of_points([p, q]));
            }
            let mut expected = Node { count: count as u32, ..Node::EMPTY };
            (0..count).for_each(|lane| expected.set_bounds(lane, &boxes.lane(lane)));
            expected.set_extent(&expected.bounds());
            for (name, level) in kernel_levels() {
                let mut node = Node { count: count as u32, ..Node::EMPTY };
                let (bounds, area) = dispatch_every!(level, simd => node.fit(simd, &boxes));
                assert_eq!(bytemuck::bytes_of(&node), bytemuck::bytes_of(&expected), "{name}, {count} boxes");
                assert_eq!((bounds, area.to_bits()), (expected.bounds(), expected.area_below().to_bits()), "{name}");
            }
        }
        assert!(flat > 3_000, "{flat} of 16,000 boxes are flat");
    }
}
