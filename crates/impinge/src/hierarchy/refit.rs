//! Refitting: new boxes and slabs for a tree that stays as it is, from the leaves up.
//!
//! Source: van den Bergen, *Efficient collision detection of complex deformable models using AABB trees*, Journal of Graphics
//! Tools 2(4), 1997 (Ericson, 6.6). Ours goes by patches, subtrees that one thread refits with what their leaves hold while
//! both are in its cache; nodes stand in preorder, so that a patch is one range of nodes and one of leaves.

use std::ops::Range;

use super::slab::Slab;
use super::wide::{Node, PATCH, WideTree};
use crate::volume::Aabb;

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

    /// Each patch with its own nodes and leaves.
    pub(crate) fn split<'a, L>(&self, mut nodes: &'a mut [Node], mut leaves: &'a mut [L]) -> Vec<Work<'a, L>> {
        let mut nodes_before = 0;
        let mut leaves_before = 0;
        let mut work = Vec::with_capacity(self.patches.len());
        for patch in &self.patches {
            let (own, rest) = nodes.split_at_mut(patch.nodes.end - nodes_before);
            let own = &mut own[patch.nodes.start - nodes_before..];
            let (held, others) = leaves.split_at_mut(patch.leaves.end - leaves_before);
            (nodes, leaves) = (rest, others);
            (nodes_before, leaves_before) = (patch.nodes.end, patch.leaves.end);
            work.push(Work { patch: patch.clone(), nodes: own, leaves: held });
        }
        work
    }

    /// Refits the nodes above the patches.
    pub(crate) fn refit_above(&self, nodes: &mut [Node]) {
        for &at in self.above.iter().rev() {
            nodes[at] = self.refitted_above(nodes, at);
        }
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
        node.set_extent();
        node
    }
}

/// A patch to be worked on.
pub(crate) struct Work<'a, L> {
    pub(crate) patch: Patch,
    pub(crate) nodes: &'a mut [Node],
    pub(crate) leaves: &'a mut [L],
}

/// What the leaves of a patch hold, and where that is now.
pub(crate) trait Leaves {
    /// Refits what a leaf holds, counted from the patch's first, and returns its box. The last leaf comes first.
    fn refit(&mut self, leaf: usize) -> Aabb;

    /// The slab about what some leaves hold, all of which were refitted.
    fn slab(&self, leaves: Range<usize>) -> Slab;
}

impl Patch {
    /// Refits the patch's own `nodes` and what its leaves hold, each node right after what is below it.
    #[inline(always)]
    pub(crate) fn refit(&self, nodes: &mut [Node], leaves: &mut impl Leaves) {
        // Children come after their parents, and their leaves stand side by side.
        let mut held = vec![0..0; nodes.len()];
        for at in (0..nodes.len()).rev() {
            let mut node = nodes[at];
            let (mut first, mut end) = (usize::MAX, 0);
            for lane in (0..node.count()).rev() {
                let below = node.index(lane) as usize;
                let (bounds, below) = if node.holds_leaves() {
                    let leaf = below - self.leaves.start;
                    (leaves.refit(leaf), leaf..leaf + 1)
                } else {
                    let child = below - self.nodes.start;
                    (nodes[child].bounds(), held[child].clone())
                };
                node.set_bounds(lane, &bounds);
                (first, end) = (first.min(below.start), end.max(below.end));
            }
            node.set_extent();
            node.slab = leaves.slab(first..end);
            nodes[at] = node;
            held[at] = first..end;
        }
    }
}

/// The first of the leaves below a node.
fn first_leaf(nodes: &[Node], mut at: usize) -> usize {
    while !nodes[at].holds_leaves() {
        at = nodes[at].index(0) as usize;
    }
    nodes[at].index(0) as usize
}
