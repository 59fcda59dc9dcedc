//! An optimiser: each subtree in turn is looked for a better place, and those that gain most are moved there.
//!
//! Source: Meister, Bittner, *Parallel reinsertion for bounding volume hierarchy optimization*, Eurographics 2018. All
//! searches of a round run at once on the same tree; then the moves are made in the order of what they gain, and one
//! whose path touches that of an earlier one waits for the next round. Paths are disjoint, so each move gains exactly what
//! was found and no two can make a circle. Ours departs in bounding each search, since among boxes that all overlap it
//! would visit the whole tree, and in moving the leaves of the tree whole.

use std::cmp::Reverse;

use rayon::prelude::*;

use super::super::area::half_area;
use super::super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY};
use super::linked::{Below, Linked, LinkedNode, NONE};
use crate::volume::Aabb;

/// Rounds at most. The first gains about half of what can be had.
const MOST_ROUNDS: usize = 8;

/// A round that gains less than this part of the cost is the last.
const LEAST_GAIN: f64 = 2e-3;

/// Nodes that a search visits at most: past these it seldom finds anything better.
const MOST_VISITED: usize = 512;

/// The tree with subtrees moved to where the surface area of its inner boxes is less, and never more than before. The same
/// for any number of threads. Leaves that come to stand side by side are joined where `capacity` boxes hold both.
///
/// # Complexity
/// A search of bounded length for each node, a bounded number of times, and O(n log n).
#[must_use]
pub fn optimise(tree: &BinaryTree, boxes: &[Aabb], capacity: usize) -> BinaryTree {
    if tree.nodes.is_empty() {
        return tree.clone();
    }
    let mut linked = linked(tree);
    for _ in 0..MOST_ROUNDS {
        let cost = cost(&linked);
        if improve(&mut linked) <= LEAST_GAIN * cost {
            break;
        }
    }
    linked.to_binary(&tree.order, capacity.clamp(1, LEAF_CAPACITY), |index| boxes[index as usize])
}

/// The same tree with parents.
fn linked(tree: &BinaryTree) -> Linked {
    let node = |node: &BinaryNode, at: u32| {
        let below = match node.right {
            Some(right) => Below::Pair([at + 1, at + right.get()]),
            None => Below::Boxes { first: node.first, count: node.count },
        };
        LinkedNode { bounds: node.bounds, parent: NONE, below }
    };
    let mut nodes: Vec<LinkedNode> = tree.nodes.iter().zip(0..).map(|(n, at)| node(n, at)).collect();
    for at in 0..nodes.len() {
        if let Below::Pair(children) = nodes[at].below {
            for child in children {
                nodes[child as usize].parent = at as u32;
            }
        }
    }
    Linked { nodes, root: 0 }
}

/// Half the area of all inner boxes: what a move may lessen.
fn cost(tree: &Linked) -> f64 {
    let is_inner = |node: &&LinkedNode| matches!(node.below, Below::Pair(_));
    tree.nodes.iter().filter(is_inner).map(|node| half_area(&node.bounds)).sum()
}

/// A subtree, where it should go, and where the way there turns downward.
#[derive(Clone, Copy)]
struct Move {
    gain: f64,
    node: u32,
    target: u32,
    pivot: u32,
}

/// One round; returns what it gained.
fn improve(tree: &mut Linked) -> f64 {
    let shared = &*tree;
    let found = (0..tree.nodes.len() as u32).into_par_iter().with_min_len(64);
    let mut moves: Vec<Move> =
        found.map_init(Vec::new, |pending, node| best_move(shared, node, pending)).flatten().collect();
    moves.sort_unstable_by_key(|m| (Reverse(m.gain.to_bits()), m.node));

    let mut taken = vec![false; tree.nodes.len()];
    let mut gained = 0.0;
    let mut way = Vec::new();
    for step in moves {
        tree.way(&step, &mut way);
        if way.iter().all(|&node| !taken[node as usize]) {
            way.iter().for_each(|&node| taken[node as usize] = true);
            tree.make(&step);
            gained += step.gain;
        }
    }
    for &at in tree.preorder().iter().rev() {
        if let Below::Pair([left, right]) = tree.nodes[at as usize].below {
            tree.nodes[at as usize].bounds = tree.nodes[left as usize].bounds.union(tree.nodes[right as usize].bounds);
        }
    }
    gained
}

/// Where a subtree would gain most; none where it is best off where it is.
///
/// Taking it away removes its parent and shrinks the boxes above; putting it beside `target` makes a new parent there and
/// grows the boxes above that. Those above both stay as they are, so the search climbs from the subtree and, at each
/// pivot, goes down on the other side.
fn best_move(tree: &Linked, node: u32, pending: &mut Vec<(u32, f64)>) -> Option<Move> {
    let nodes = &tree.nodes;
    let parent = nodes[node as usize].parent;
    if parent == NONE || nodes[parent as usize].parent == NONE {
        return None;
    }
    let own = nodes[node as usize].bounds;
    let own_area = half_area(&own);
    let mut best = Move { gain: 0.0, node, target: NONE, pivot: NONE };
    let mut visited = 0;
    let mut saved = half_area(&nodes[parent as usize].bounds);
    // What is left below the pivot once the subtree is gone.
    let mut rest = Aabb::EMPTY;
    let (mut from, mut pivot) = (node, parent);
    while pivot != NONE && visited < MOST_VISITED {
        let other = tree.sibling(from)?;
        pending.clear();
        pending.push((other, saved));
        while let Some((at, saved)) = pending.pop() {
            visited += 1;
            if saved - own_area <= best.gain || visited >= MOST_VISITED {
                continue;
            }
            let LinkedNode { bounds, below, .. } = nodes[at as usize];
            let grown = half_area(&bounds.union(own));
            if saved - grown > best.gain {
                best = Move { gain: saved - grown, target: at, pivot, ..best };
            }
            if let Below::Pair(children) = below {
                let saved = saved - (grown - half_area(&bounds));
                pending.extend(children.map(|child| (child, saved)));
            }
        }
        rest = rest.union(nodes[other as usize].bounds);
        if pivot != parent {
            saved += half_area(&nodes[pivot as usize].bounds) - half_area(&rest);
        }
        (from, pivot) = (pivot, nodes[pivot as usize].parent);
    }
    (best.target != NONE).then_some(best)
}

impl Linked {
    /// All nodes whose links or boxes a move changes.
    fn way(&self, step: &Move, way: &mut Vec<u32>) {
        way.clear();
        let parent = self.nodes[step.node as usize].parent;
        way.extend([step.node, step.target]);
        way.extend(self.sibling(step.node));
        way.push(self.nodes[parent as usize].parent);
        for end in [step.node, step.target] {
            let mut at = end;
            while at != step.pivot && at != NONE {
                at = self.nodes[at as usize].parent;
                way.push(at);
            }
        }
        way.retain(|&node| node != NONE);
    }

    /// Takes the subtree from its parent, which its sibling replaces, and puts it beside the target, with the same parent
    /// node above both. Boxes are left as they are.
    fn make(&mut self, step: &Move) {
        let Move { node, target, .. } = *step;
        let parent = self.nodes[node as usize].parent;
        let Some(sibling) = self.sibling(node) else { return };
        self.replace_child(self.nodes[parent as usize].parent, parent, sibling);
        self.replace_child(self.nodes[target as usize].parent, target, parent);
        self.nodes[parent as usize].below = Below::Pair([target, node]);
        self.nodes[target as usize].parent = parent;
    }
}
