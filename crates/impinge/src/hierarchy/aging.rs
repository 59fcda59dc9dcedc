//! Aging of trees. A refit keeps all nodes, so boxes of items that have moved apart overlap more
//! and more. This module finds the subtrees that have aged, and replaces them.
//!
//! Source: Lauterbach, Yoon, Tuft, Manocha, *RT-DEFORM: interactive ray tracing of dynamic scenes
//! using BVHs*, RT 2006, which compares the areas of a tree now and when it was built. Ours uses
//! the surface area heuristic, and replaces the smallest subtrees that restore the cost of the
//! rest.

use std::ops::Range;

use rayon::prelude::*;

use super::area::{cost, half_area};
use super::refit::{Patch, Patches};
use super::wide::{Child, Node, WideTree};
use crate::simd::LANES;

/// A subtree that has aged: its nodes and its leaves.
pub(crate) type Aged = Patch;

/// A tree with replaced subtrees. Its boxes and slabs are still to be refitted.
pub(crate) struct Renewal {
    pub(crate) tree: WideTree,
    /// The origin of each leaf.
    pub(crate) leaves: Vec<Origin>,
    /// For each node the index of the node in the old tree, or `None` if the node is new.
    pub(crate) nodes: Vec<Option<u32>>,
}

/// The origin of a leaf: a leaf of the old tree, or a leaf of a replacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    Kept(u32),
    Replaced { replacement: u32, leaf: u32 },
}

impl WideTree {
    /// Returns the cost of each subtree by the surface area heuristic: the sum of the areas of its
    /// own box and all boxes below, divided by the area of its own box. It is the number of nodes
    /// that a descent into the subtree may expect to visit. It is 1 if a node has no area. The
    /// root's cost is the [`sah`](super::TreeStatistics::sah) of the tree.
    pub(crate) fn subtree_costs(&self) -> Vec<f64> {
        let mut below = vec![0.0; self.nodes().len()];
        let mut costs = vec![1.0; below.len()];
        // Children come after their parents.
        for (at, node) in self.nodes().iter().enumerate().rev() {
            let area = half_area(&node.bounds());
            below[at] = area + sum_below(node, |child| below[child as usize]);
            costs[at] = cost(below[at], area);
        }
        costs
    }

    /// Returns the cost of the whole tree, as [`subtree_costs`](Self::subtree_costs) defines it.
    /// The areas are summed in the order in which a refit visits the nodes.
    pub(crate) fn cost(&self, leaves: usize) -> f64 {
        let (nodes, patches) = (self.nodes(), Patches::of(self, leaves));
        let of_patch = |patch: &Patch| nodes[patch.nodes.clone()].iter().rev().map(Node::area_below).sum();
        let of_patches: Vec<f64> = patches.patches.par_iter().map(of_patch).collect();
        patches.cost(nodes, &of_patches)
    }

    /// Returns the smallest subtrees to rebuild, in preorder. Once each has its original cost again
    /// (`as_built`), no subtree costs more than `most` times its original cost.
    pub(crate) fn aged_subtrees(&self, as_built: &[f64], most: f64) -> Vec<Aged> {
        let nodes = self.nodes();
        let mut below = vec![0.0; nodes.len()];
        let mut is_aged = vec![false; nodes.len()];
        let mut subtrees = vec![Patch { nodes: 0..0, leaves: 0..0 }; nodes.len()];
        for (at, node) in nodes.iter().enumerate().rev() {
            let area = half_area(&node.bounds());
            below[at] = area + sum_below(node, |child| below[child as usize]);
            if cost(below[at], area) > most * as_built[at] {
                is_aged[at] = true;
                below[at] = as_built[at] * area;
            }
            let ends = [0, node.count().saturating_sub(1)].map(|lane| node.index(lane) as usize);
            subtrees[at] = if node.holds_leaves() {
                Patch { nodes: at..at + 1, leaves: ends[0]..ends[1] + 1 }
            } else {
                let [first, last] = ends.map(|child| &subtrees[child]);
                Patch { nodes: at..last.nodes.end, leaves: first.leaves.start..last.leaves.end }
            };
        }
        let mut aged = Vec::new();
        let mut at = 0;
        while at < nodes.len() {
            if is_aged[at] {
                aged.push(subtrees[at].clone());
                at = subtrees[at].nodes.end;
            } else {
                at += 1;
            }
        }
        aged
    }

    /// Returns the maximum number of nodes on a path from the root to a leaf.
    pub(crate) fn depth(&self) -> usize {
        let mut depths = vec![1; self.nodes().len()];
        for (at, node) in self.nodes().iter().enumerate() {
            for lane in 0..if node.holds_leaves() { 0 } else { node.count() } {
                depths[node.index(lane) as usize] = depths[at] + 1;
            }
        }
        depths.into_iter().max().unwrap_or(0)
    }

    /// Returns the tree with each subtree of `aged` replaced by a tree. The subtrees must be in
    /// preorder and disjoint.
    pub(crate) fn renewed(&self, aged: &[Aged], replacements: &[Self]) -> Renewal {
        let old = self.nodes();
        let mut renewed = Vec::with_capacity(old.len());
        let (mut leaves, mut origins) = (Vec::new(), Vec::new());
        let mut moved_to = vec![0_u32; old.len()];
        let mut pending = aged.iter().zip(replacements).zip(0..).peekable();
        let mut at = 0;
        while at < old.len() {
            moved_to[at] = renewed.len() as u32;
            if let Some(((subtree, replacement), number)) =
                pending.next_if(|((subtree, _), _)| subtree.nodes.start == at)
            {
                let (first_node, first_leaf) = (renewed.len() as u32, leaves.len() as u32);
                for node in replacement.nodes() {
                    let lanes = 0..if node.holds_leaves() { node.count() as u32 } else { 0 };
                    leaves.extend(
                        lanes.map(|lane| Origin::Replaced { replacement: number, leaf: node.index(lane as usize) }),
                    );
                    renewed.push(node.with_children(|child| match child {
                        Child::Inner(node) => Child::Inner(first_node + node),
                        Child::Leaf(leaf) => Child::Leaf(first_leaf + leaf),
                    }));
                    origins.push(None);
                }
                at = subtree.nodes.end;
                continue;
            }
            let mut node = old[at];
            if node.holds_leaves() {
                let first_leaf = leaves.len() as u32;
                leaves.extend((0..node.count()).map(|lane| Origin::Kept(node.index(lane))));
                let before = node.index(0);
                node = node.with_children(|child| match child {
                    Child::Leaf(leaf) => Child::Leaf(leaf - before + first_leaf),
                    inner @ Child::Inner(_) => inner,
                });
            }
            renewed.push(node);
            origins.push(Some(at as u32));
            at += 1;
        }
        for (node, _) in
            renewed.iter_mut().zip(&origins).filter(|(node, origin)| origin.is_some() && !node.holds_leaves())
        {
            *node = node.with_children(|child| match child {
                Child::Inner(child) => Child::Inner(moved_to[child as usize]),
                leaf @ Child::Leaf(_) => leaf,
            });
        }
        Renewal { tree: Self::from_nodes(renewed.into()), leaves, nodes: origins }
    }
}

impl Renewal {
    /// Returns the cost of each subtree when it was built: its cost in the old tree, `before`, or
    /// its cost now if any node below is new.
    pub(crate) fn costs_as_built(&self, before: &[f64]) -> Vec<f64> {
        let mut costs = self.tree.subtree_costs();
        let mut is_old = vec![true; costs.len()];
        for (at, node) in self.tree.nodes().iter().enumerate().rev() {
            let below = 0..if node.holds_leaves() { 0 } else { node.count() };
            match self.nodes[at] {
                Some(old) if below.clone().all(|lane| is_old[node.index(lane) as usize]) => {
                    costs[at] = before[old as usize]
                }
                _ => is_old[at] = false,
            }
        }
        costs
    }
}

impl Node {
    /// Returns the node with the references in its used lanes replaced.
    fn with_children(mut self, other: impl Fn(Child) -> Child) -> Self {
        for lane in 0..self.count() {
            self.set_child(lane, other(self.child(lane)));
        }
        self
    }

    /// Returns the sum of the areas of the children's boxes.
    #[inline(always)]
    pub(super) fn area_below(&self) -> f64 {
        let count = self.count();
        let mut areas = [0.0; LANES];
        for lane in 0..LANES {
            let area = half_area(&self.lane_bounds(lane));
            areas[lane] = if lane < count { area } else { 0.0 };
        }
        let [a, b, c, d, e, f, g, h] = areas;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }
}

/// Returns the sum over the children of a node: `inner(child)` for an inner node, half the surface
/// area of the box for a leaf.
fn sum_below(node: &Node, inner: impl Fn(u32) -> f64) -> f64 {
    let lanes: Range<usize> = 0..node.count();
    lanes
        .map(|lane| match node.child(lane) {
            Child::Inner(child) => inner(child),
            Child::Leaf(_) => half_area(&node.lane_bounds(lane)),
        })
        .sum()
}
