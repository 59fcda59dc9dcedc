//! An optimizer: it searches a better place for each subtree, and moves the subtrees that gain
//! most.
//!
//! Source: Meister, Bittner, *Parallel reinsertion for bounding volume hierarchy optimization*,
//! Eurographics 2018. All searches of a round run in parallel on the same tree. Then the moves are
//! made in the order of their gains. A move whose path touches the path of an earlier move waits
//! for the next round. So paths are disjoint, each move gains exactly the gain that was found, and
//! no two moves can form a cycle. Ours departs in two ways. Each search is bounded, because among
//! boxes that all overlap it would visit the whole tree. And the leaves of the tree are moved
//! whole.

use std::cmp::Reverse;

use rayon::prelude::*;

use super::super::area::half_area;
use super::super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY};
use super::linked::{Below, Linked, LinkedNode, NONE};
use crate::volume::Aabb;

/// Maximum number of rounds. The first round makes about half of the possible gain.
const MAX_ROUNDS: usize = 8;

/// Minimum gain of a round, relative to the cost. A round that gains less is the last.
const MIN_GAIN: f64 = 2e-3;

/// Maximum number of nodes that a search visits. Beyond it, a search seldom finds a better place.
const MAX_VISITED: usize = 512;

/// Returns the tree with subtrees moved to reduce the sum of the surface areas of the inner boxes,
/// which never increases. `boxes` must be the boxes from which the tree was built. The result is
/// the same for any number of threads. Sibling leaves are joined if together they hold at most
/// `capacity` boxes. `capacity` is clamped to 1 to [`LEAF_CAPACITY`].
///
/// # Complexity
/// A search of bounded length for each node, a bounded number of times, and O(n log n).
#[must_use]
pub fn optimize(tree: &BinaryTree, boxes: &[Aabb], capacity: usize) -> BinaryTree {
    if tree.nodes.is_empty() {
        return tree.clone();
    }
    let mut linked = linked(tree);
    for _ in 0..MAX_ROUNDS {
        let cost = cost(&linked);
        if improve(&mut linked) <= MIN_GAIN * cost {
            break;
        }
    }
    linked.to_binary(&tree.order, capacity.clamp(1, LEAF_CAPACITY), |index| boxes[index as usize])
}

/// Converts a tree to one with parents.
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

/// Returns half the surface area of all inner boxes, which moves reduce.
fn cost(tree: &Linked) -> f64 {
    let is_inner = |node: &&LinkedNode| matches!(node.below, Below::Pair(_));
    tree.nodes.iter().filter(is_inner).map(|node| half_area(&node.bounds)).sum()
}

/// A move of the subtree `node` beside `target`. `pivot` is their lowest common ancestor.
#[derive(Clone, Copy)]
struct Move {
    gain: f64,
    node: u32,
    target: u32,
    pivot: u32,
}

/// Runs one round and returns its gain.
fn improve(tree: &mut Linked) -> f64 {
    let shared = &*tree;
    let found = (0..tree.nodes.len() as u32).into_par_iter().with_min_len(64);
    let mut moves: Vec<Move> =
        found.map_init(Vec::new, |pending, node| best_move(shared, node, pending)).flatten().collect();
    moves.sort_unstable_by_key(|m| (Reverse(m.gain.to_bits()), m.node));

    let mut taken = vec![false; tree.nodes.len()];
    let mut gained = 0.0;
    let mut changed = Vec::new();
    for step in moves {
        tree.changed_nodes(&step, &mut changed);
        if changed.iter().all(|&node| !taken[node as usize]) {
            changed.iter().for_each(|&node| taken[node as usize] = true);
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

/// Returns the move of a subtree with the largest gain, or `None` if no move gains.
///
/// Removing the subtree removes its parent and shrinks the boxes above. Inserting it beside
/// `target` adds a parent there and grows the boxes above. The boxes above both places stay the
/// same. So the search climbs from the subtree and, at each pivot, descends on the other side.
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
    // The box that is left below the pivot once the subtree is removed.
    let mut rest = Aabb::EMPTY;
    let (mut from, mut pivot) = (node, parent);
    while pivot != NONE && visited < MAX_VISITED {
        let other = tree.sibling(from)?;
        pending.clear();
        pending.push((other, saved));
        while let Some((at, saved)) = pending.pop() {
            visited += 1;
            if saved - own_area <= best.gain || visited >= MAX_VISITED {
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
    /// Collects all nodes whose links or boxes a move changes.
    fn changed_nodes(&self, step: &Move, changed: &mut Vec<u32>) {
        changed.clear();
        let parent = self.nodes[step.node as usize].parent;
        changed.extend([step.node, step.target]);
        changed.extend(self.sibling(step.node));
        changed.push(self.nodes[parent as usize].parent);
        for end in [step.node, step.target] {
            let mut at = end;
            while at != step.pivot && at != NONE {
                at = self.nodes[at as usize].parent;
                changed.push(at);
            }
        }
        changed.retain(|&node| node != NONE);
    }

    /// Makes a move: the sibling of the subtree replaces their parent, and the parent is reused
    /// above the target and the subtree. Boxes are not updated.
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
