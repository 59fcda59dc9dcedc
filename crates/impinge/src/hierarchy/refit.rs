//! Refitting: new boxes and slabs for a tree that stays as it is, from the leaves up.
//!
//! Source: van den Bergen, *Efficient collision detection of complex deformable models using AABB trees*, Journal of Graphics
//! Tools 2(4), 1997 (Ericson, 6.6). Ours goes by patches, subtrees that one thread refits with what their leaves hold while
//! both are in its cache; nodes stand in preorder, so that a patch is one range of nodes and one of leaves.

use std::ops::Range;

use super::aging::cost;
use super::area::half_area;
use super::lanes::BoxLanes;
use super::slab::Slab;
use super::wide::{Node, PATCH, WideTree};
use crate::simd::{by_axis, prefetch};
use crate::volume::Aabb;

/// Nodes ahead that are asked for.
const AHEAD: usize = 2;

/// A subtree small enough to have slabs, whose parent is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Patch {
    pub(crate) nodes: Range<usize>,
    pub(crate) leaves: Range<usize>,
}

/// A tree taken apart: the patches in preorder, and the nodes above them in preorder.
#[derive(Debug, Default)]
pub(crate) struct Patches {
    pub(crate) patches: Vec<Patch>,
    above: Vec<usize>,
}

impl Patches {
    /// Of a sound tree with this many leaves.
    ///
    /// # Complexity
    /// The nodes above the patches, times the depth.
    pub(crate) fn of(tree: &WideTree, leaves: usize) -> Self {
        let nodes = tree.nodes();
        let mut found = Self::default();
        let mut pending = Vec::new();
        pending.extend((!nodes.is_empty()).then_some(Patch { nodes: 0..nodes.len(), leaves: 0..leaves }));
        while let Some(subtree) = pending.pop() {
            if subtree.leaves.len() <= PATCH {
                found.patches.push(subtree);
                continue;
            }
            let at = subtree.nodes.start;
            found.above.push(at);
            // The last child first, so that the first is taken next.
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

    /// Each patch with its own nodes.
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

    /// What the tree [costs](WideTree::cost), from what the areas below the nodes of each patch add up to.
    pub(crate) fn cost(&self, nodes: &[Node], of_patches: &[f64]) -> f64 {
        let Some(root) = nodes.first() else { return 1.0 };
        let above: f64 = self.above.iter().rev().map(|&at| nodes[at].area_below()).sum();
        let area = half_area(&root.bounds());
        cost(area + (of_patches.iter().sum::<f64>() + above), area)
    }

    /// Whether a refit would not change a bit of the nodes above the patches.
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

/// A patch to be worked on.
pub(crate) struct Work<'a> {
    pub(crate) patch: Patch,
    pub(crate) nodes: &'a mut [Node],
}

/// What the leaves of a patch hold, and where that is now. Leaves are counted from the patch's first.
pub(crate) trait Leaves {
    /// Looks at what the leaves of a node hold: returns their boxes, with anything in the lanes beyond them, and the direction in
    /// which it all faces, of which those of several nodes can be added up. The last leaves come first.
    fn fit(&mut self, leaves: Range<usize>) -> (BoxLanes, [f32; 3]);

    /// The slab about what some leaves hold, all of which were looked at, and of which this is the box.
    fn slab(&self, leaves: Range<usize>, bounds: &Aabb, facing: [f32; 3]) -> Slab;
}

/// What is below a node of a patch.
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
    /// Refits the patch's own `nodes` to what its leaves hold, each node right after what is below it. Returns what the areas below
    /// them add up to.
    #[inline(always)]
    pub(crate) fn refit(&self, nodes: &mut [Node], leaves: &mut impl Leaves) -> f64 {
        let mut area = 0.0;
        // Children come after their parents, and their leaves stand side by side.
        let mut below = vec![Below::NOTHING; nodes.len()];
        for at in (0..nodes.len()).rev() {
            if let Some(ahead) = at.checked_sub(AHEAD) {
                prefetch(&nodes[ahead]);
            }
            let node = &mut nodes[at];
            let count = node.count();
            let mut held = Below::NOTHING;
            if node.holds_leaves() {
                let first = node.index(0) as usize - self.leaves.start;
                let (boxes, facing) = leaves.fit(first..first + count);
                node.set_boxes(&boxes);
                (held.leaves, held.facing) = (first..first + count, facing);
            } else {
                for lane in 0..count {
                    let Below { leaves, bounds, facing } = &below[node.index(lane) as usize - self.nodes.start];
                    node.set_bounds(lane, bounds);
                    let first = if lane == 0 { leaves.start } else { held.leaves.start };
                    held.leaves = first..leaves.end;
                    held.facing = by_axis!(axis => held.facing[axis] + facing[axis]);
                }
            }
            held.bounds = node.bounds();
            node.set_extent(&held.bounds);
            node.slab = leaves.slab(held.leaves.clone(), &held.bounds, held.facing);
            area += node.area_below();
            below[at] = held;
        }
        area
    }
}

/// The first of the leaves below a node.
fn first_leaf(nodes: &[Node], mut at: usize) -> usize {
    while !nodes[at].holds_leaves() {
        at = nodes[at].index(0) as usize;
    }
    nodes[at].index(0) as usize
}
