//! Insertion: boxes come and go one at a time, each beside the node where the tree grows least, and rotations on the way
//! up mend what earlier boxes could not know.
//!
//! Source: Bittner, Hapala, Havran, *Incremental BVH construction for ray tracing*, 2015 (the search); Kopta et al., *Fast,
//! effective BVH updates for animated scenes*, I3D 2012 (rotations). Ours departs in two bounds that keep any sequence
//! near-linear: a search visits a bounded number of nodes, and nothing is put where a leaf would come to lie deeper than
//! [`DEEPEST`]; where only such places were found, the way to the emptier side is taken.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::super::area::half_area;
use super::super::binary::{BinaryTree, LEAF_CAPACITY};
use super::linked::{Below, Linked, LinkedNode, NONE};
use crate::volume::Aabb;

/// No leaf lies deeper. Going down to the emptier side ends after 32 steps, below 2^32 boxes, so that there always is a
/// place; and it is less than what the neutral tree allows.
const DEEPEST: u32 = 48;

/// Nodes that a search visits at most. The first few dozen lead down to a leaf; what they miss, rotations mostly mend.
const MOST_VISITED: usize = 96;

/// A tree that boxes are put into and taken from, one at a time.
///
/// ```
/// use impinge::hierarchy::DynamicTree;
/// use impinge::volume::Aabb;
///
/// let mut tree = DynamicTree::new();
/// let boxes = [0.0_f32, 1.0, 5.0].map(|x| tree.insert(Aabb { min: [x, 0.0, 0.0], max: [x + 2.0, 1.0, 1.0] }));
/// tree.remove(boxes[1]);
/// let mut met = Vec::new();
/// tree.for_each_overlapping(&Aabb { min: [1.0; 3], max: [2.0; 3] }, |number| met.push(number));
/// assert_eq!(met, [boxes[0]]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct DynamicTree {
    nodes: Vec<Node>,
    /// Nodes out of use.
    free: Vec<u32>,
    /// None where the tree is empty.
    root: Option<u32>,
    /// The leaf of each box; [`NONE`] where there is no box of this number.
    leaves: Vec<u32>,
    /// Numbers out of use.
    free_numbers: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    parent: u32,
    /// The children of an inner node.
    children: Option<[u32; 2]>,
    /// How many boxes are below, or the number of the leaf's box.
    held: u32,
    /// Steps to the deepest leaf below.
    height: u32,
}

/// A node beside or below which a box may go. The boxes above it grow by `grown` then, so that it costs at least this and
/// the box's own area: the least is looked at first, and of several the deepest, which is nearest to a leaf.
struct Candidate {
    grown: f64,
    depth: u32,
    node: u32,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        other.grown.total_cmp(&self.grown).then(self.depth.cmp(&other.depth)).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

impl Node {
    fn count(&self) -> u32 {
        if self.children.is_some() { self.held } else { 1 }
    }
}

impl DynamicTree {
    /// A tree of nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// How many boxes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.leaves.len() - self.free_numbers.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// The box of this number.
    #[must_use]
    pub fn get(&self, number: u32) -> Option<&Aabb> {
        let leaf = *self.leaves.get(number as usize)?;
        self.nodes.get(leaf as usize).map(|node| &node.bounds)
    }

    /// Puts a box in, which may not be empty, and numbers it: the number that was freed last, or else the next.
    ///
    /// # Complexity
    /// A bounded number of steps.
    pub fn insert(&mut self, bounds: Aabb) -> u32 {
        let number = self.free_numbers.pop().unwrap_or_else(|| {
            self.leaves.push(NONE);
            self.leaves.len() as u32 - 1
        });
        self.put(number, bounds);
        number
    }

    /// Takes a box out; none where there is no box of this number.
    ///
    /// # Complexity
    /// A bounded number of steps.
    pub fn remove(&mut self, number: u32) -> Option<Aabb> {
        let bounds = self.take(number)?;
        self.free_numbers.push(number);
        Some(bounds)
    }

    /// Gives a box other bounds and its best place, and returns what it was; none where there is no box of this number.
    ///
    /// # Complexity
    /// A bounded number of steps.
    pub fn replace(&mut self, number: u32, bounds: Aabb) -> Option<Aabb> {
        let before = self.take(number)?;
        self.put(number, bounds);
        Some(before)
    }

    /// Shows the numbers of all boxes that have a point in common with `region`, in no particular order.
    pub fn for_each_overlapping(&self, region: &Aabb, mut visit: impl FnMut(u32)) {
        let mut pending: Vec<u32> = self.root.into_iter().collect();
        while let Some(at) = pending.pop() {
            let node = &self.nodes[at as usize];
            let overlaps = node.bounds.overlaps(region);
            match node.children {
                Some(children) if overlaps => pending.extend(children),
                None if overlaps => visit(node.held),
                _ => {}
            }
        }
    }

    /// The neutral tree of the boxes, with at most `capacity` in a leaf; its order lists their numbers.
    #[must_use]
    pub fn to_binary(&self, capacity: usize) -> BinaryTree {
        let Some(root) = self.root else { return BinaryTree::default() };
        let linked = |node: &Node| LinkedNode {
            bounds: node.bounds,
            parent: node.parent,
            below: match node.children {
                Some(children) => Below::Pair(children),
                None => Below::Boxes { first: node.held, count: 1 },
            },
        };
        let numbers: Vec<u32> = (0..self.leaves.len() as u32).collect();
        let linked = Linked { nodes: self.nodes.iter().map(linked).collect(), root };
        linked.to_binary(&numbers, capacity.clamp(1, LEAF_CAPACITY), |number| {
            self.get(number).copied().unwrap_or(Aabb::EMPTY)
        })
    }

    fn put(&mut self, number: u32, bounds: Aabb) {
        let leaf = self.occupy(Node { bounds, parent: NONE, children: None, held: number, height: 0 });
        self.leaves[number as usize] = leaf;
        let Some(root) = self.root else {
            self.root = Some(leaf);
            return;
        };
        let sibling = self.best_sibling(root, &bounds);
        let parent = self.nodes[sibling as usize].parent;
        let children = Some([sibling, leaf]);
        let joint = self.occupy(Node { bounds, parent, children, held: 0, height: 0 });
        self.replace_child(parent, sibling, joint);
        self.nodes[sibling as usize].parent = joint;
        self.nodes[leaf as usize].parent = joint;
        self.mend_upward(joint);
    }

    fn take(&mut self, number: u32) -> Option<Aabb> {
        let leaf = std::mem::replace(self.leaves.get_mut(number as usize)?, NONE);
        let Node { bounds, parent, .. } = *self.nodes.get(leaf as usize)?;
        self.free.push(leaf);
        if parent == NONE {
            self.root = None;
            return Some(bounds);
        }
        let [left, right] = self.nodes[parent as usize].children?;
        let sibling = if left == leaf { right } else { left };
        let above = self.nodes[parent as usize].parent;
        self.replace_child(above, parent, sibling);
        self.nodes[sibling as usize].parent = above;
        self.free.push(parent);
        if above != NONE {
            self.mend_upward(above);
        }
        Some(bounds)
    }

    /// The node beside which a box grows the tree least, among those that the search visits.
    fn best_sibling(&self, root: u32, own: &Aabb) -> u32 {
        let own_area = half_area(own);
        let mut best = (f64::INFINITY, NONE);
        let mut pending = BinaryHeap::from([Candidate { grown: 0.0, depth: 0, node: root }]);
        for _ in 0..MOST_VISITED {
            let Some(Candidate { grown, depth, node: at }) = pending.pop() else { break };
            if grown + own_area >= best.0 {
                break;
            }
            let node = &self.nodes[at as usize];
            let area = half_area(&node.bounds.union(*own));
            if grown + area < best.0 && depth + node.height < DEEPEST {
                best = (grown + area, at);
            }
            if let Some(children) = node.children {
                let grown = grown + area - half_area(&node.bounds);
                pending.extend(children.map(|node| Candidate { grown, depth: depth + 1, node }));
            }
        }
        if best.1 != NONE { best.1 } else { self.emptiest(root) }
    }

    /// The leaf that is reached by going to the side of fewer boxes; the deeper, the fewer by half.
    fn emptiest(&self, root: u32) -> u32 {
        let mut at = root;
        while let Some([left, right]) = self.nodes[at as usize].children {
            let count = |child: u32| self.nodes[child as usize].count();
            at = if count(left) <= count(right) { left } else { right };
        }
        at
    }

    /// Sets the boxes, counts and heights of a node and all above, and turns what is better turned.
    fn mend_upward(&mut self, from: u32) {
        let mut depth = 0;
        let mut at = from;
        while self.nodes[at as usize].parent != NONE {
            at = self.nodes[at as usize].parent;
            depth += 1;
        }
        let mut at = from;
        loop {
            self.mend(at);
            self.rotate(at, depth);
            at = self.nodes[at as usize].parent;
            if at == NONE {
                return;
            }
            depth -= 1;
        }
    }

    fn mend(&mut self, at: u32) {
        if let Some(children) = self.nodes[at as usize].children {
            let [left, right] = children.map(|child| self.nodes[child as usize]);
            let node = &mut self.nodes[at as usize];
            node.bounds = left.bounds.union(right.bounds);
            node.held = left.count() + right.count();
            node.height = 1 + left.height.max(right.height);
        }
    }

    /// Swaps a child with a child of the other one, where that makes the other one's box smaller and no leaf too deep.
    fn rotate(&mut self, at: u32, depth: u32) {
        let Some([left, right]) = self.nodes[at as usize].children else { return };
        let mut best = (0.0, None);
        for (child, other) in [(left, right), (right, left)] {
            let Some([first, second]) = self.nodes[other as usize].children else { continue };
            for (moved, stays) in [(first, second), (second, first)] {
                let [child_node, other_node, moved_node, stays_node] =
                    [child, other, moved, stays].map(|node| &self.nodes[node as usize]);
                let gain = half_area(&other_node.bounds) - half_area(&child_node.bounds.union(stays_node.bounds));
                let height = 1 + moved_node.height.max(1 + child_node.height.max(stays_node.height));
                if gain > best.0 && depth + height <= DEEPEST {
                    best = (gain, Some((child, other, moved)));
                }
            }
        }
        if let (_, Some((child, other, moved))) = best {
            self.replace_child(at, child, moved);
            self.replace_child(other, moved, child);
            self.nodes[moved as usize].parent = at;
            self.nodes[child as usize].parent = other;
            self.mend(other);
            self.mend(at);
        }
    }

    /// Puts `new` where `parent`, or the root, has `old`.
    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        match self.nodes.get_mut(parent as usize) {
            None => self.root = Some(new),
            Some(Node { children: Some(children), .. }) => {
                for child in children {
                    if *child == old {
                        *child = new;
                    }
                }
            }
            Some(_) => {}
        }
    }

    fn occupy(&mut self, node: Node) -> u32 {
        match self.free.pop() {
            Some(at) => {
                self.nodes[at as usize] = node;
                at
            }
            None => {
                self.nodes.push(node);
                self.nodes.len() as u32 - 1
            }
        }
    }
}
