//! Inserts, removes and moves boxes: the search for the place where the tree grows least, and
//! rotations on the way up.

use super::candidate::Candidate;
use super::{DynamicBvh, DynamicNode, Enclosable, MAX_LEAF_DEPTH, NONE};

/// Maximum number of nodes that a search visits. The first few dozen lead down to a leaf. Rotations
/// mostly repair what the search misses.
const MAX_VISITED: usize = 96;

impl<B: Enclosable, const THOROUGH: bool> DynamicBvh<B, THOROUGH> {
    /// Inserts a box under a key that no other box has.
    ///
    /// # Complexity
    /// O(1), apart from the memory for the key: at most about 100 nodes are visited and 48
    /// refitted.
    pub(crate) fn insert(&mut self, key: u32, bounds: B) {
        if key as usize >= self.leaves.len() {
            self.leaves.resize(key as usize + 1, NONE);
        }
        debug_assert_eq!(self.leaves[key as usize], NONE);
        let leaf = self.allocate(DynamicNode { bounds, parent: NONE, children: [key, NONE], height: 0, shallow: 0 });
        self.leaves[key as usize] = leaf;
        self.put(leaf);
    }

    /// Removes the box of a key and returns its bounds; `None` if there is no box with this key.
    ///
    /// # Complexity
    /// O(1): at most 48 nodes are refitted.
    pub(crate) fn remove(&mut self, key: u32) -> Option<B> {
        let leaf = self.leaf_of(key)?;
        self.take(leaf);
        self.free.push(leaf);
        self.leaves[key as usize] = NONE;
        Some(self.node(leaf).bounds)
    }

    /// Gives a leaf other bounds, and moves it where the tree grows least.
    pub(crate) fn reinsert(&mut self, leaf: u32, bounds: B) {
        self.take(leaf);
        self.nodes[leaf as usize].bounds = bounds;
        self.put(leaf);
    }

    /// Gives a leaf other bounds, and leaves it where it is.
    pub(crate) fn resize(&mut self, leaf: u32, bounds: B) {
        self.nodes[leaf as usize].bounds = bounds;
        self.refit_up(self.node(leaf).parent);
    }

    fn allocate(&mut self, node: DynamicNode<B>) -> u32 {
        if let Some(at) = self.free.pop() {
            self.nodes[at as usize] = node;
            return at;
        }
        self.nodes.push(node);
        (self.nodes.len() - 1) as u32
    }

    /// Detaches a leaf from the tree, and frees the node that joined it with its sibling.
    fn take(&mut self, leaf: u32) {
        let parent = self.node(leaf).parent;
        if parent == NONE {
            self.root = None;
            return;
        }
        let [one, other] = self.node(parent).children;
        let sibling = if one == leaf { other } else { one };
        let above = self.node(parent).parent;
        self.replace(above, parent, sibling);
        self.free.push(parent);
        self.refit_up(above);
    }

    /// Attaches a detached leaf where the tree grows least.
    fn put(&mut self, leaf: u32) {
        let Some(root) = self.root else {
            self.nodes[leaf as usize].parent = NONE;
            self.root = Some(leaf);
            return;
        };
        let bounds = self.node(leaf).bounds;
        let sibling = self.best_place(root, &bounds).unwrap_or_else(|| self.shallowest_leaf(root));
        let above = self.node(sibling).parent;
        let joint =
            self.allocate(DynamicNode { bounds, parent: above, children: [sibling, leaf], height: 1, shallow: 1 });
        self.replace(above, sibling, joint);
        self.nodes[sibling as usize].parent = joint;
        self.nodes[leaf as usize].parent = joint;
        self.pull(joint);
        self.refit_up(above);
    }

    /// Replaces the child `old` of `above`, or the root, by `new`.
    fn replace(&mut self, above: u32, old: u32, new: u32) {
        self.nodes[new as usize].parent = above;
        if above == NONE {
            self.root = Some(new);
            return;
        }
        let children = &mut self.nodes[above as usize].children;
        children[usize::from(children[1] == old)] = new;
    }

    /// Returns the node beside which the sum of all areas grows least, among the visited nodes that
    /// have room below.
    fn best_place(&mut self, root: u32, bounds: &B) -> Option<u32> {
        let own = bounds.area();
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.push(Candidate { grown: 0.0, depth: 0, node: root });
        let (mut best, mut place) = (f64::INFINITY, None);
        for _ in 0..MAX_VISITED {
            let Some(Candidate { grown, depth, node: at }) = candidates.pop() else { break };
            // Any place below adds a joint that is at least as large as the box itself.
            if grown + own >= best {
                break;
            }
            let node = self.node(at);
            let joint = node.bounds.enclosing(bounds).area();
            if grown + joint < best && depth + 1 + node.height <= MAX_LEAF_DEPTH {
                (best, place) = (grown + joint, Some(at));
            }
            if !node.is_leaf() {
                let grown = grown + (joint - node.bounds.area());
                if grown + own < best {
                    candidates.extend(node.children.map(|node| Candidate { grown, depth: depth + 1, node }));
                }
            }
        }
        candidates.clear();
        self.candidates = candidates;
        place
    }

    fn shallowest_leaf(&self, root: u32) -> u32 {
        let mut at = root;
        while !self.node(at).is_leaf() {
            let [one, other] = self.node(at).children;
            at = if self.node(one).shallow <= self.node(other).shallow { one } else { other };
        }
        at
    }

    /// Refits and rotates the nodes from here up: to the root if the rotations are thorough, else
    /// until a node does not change.
    fn refit_up(&mut self, from: u32) {
        let mut depth = if THOROUGH { self.depth(from) } else { 0 };
        let mut at = from;
        while at != NONE {
            let before = *self.node(at);
            self.pull(at);
            // A thorough rotation may raise the subtree as far as no leaf lies too deep.
            self.rotate(at, if THOROUGH { MAX_LEAF_DEPTH - depth } else { self.node(at).height });
            let after = self.node(at);
            let is_same = (after.bounds, after.height, after.shallow) == (before.bounds, before.height, before.shallow);
            if is_same && !THOROUGH {
                return;
            }
            at = after.parent;
            depth = depth.saturating_sub(1);
        }
    }

    /// Returns the number of steps from the root; zero for no node.
    fn depth(&self, at: u32) -> u16 {
        let parent = |&at: &u32| self.nodes.get(at as usize).map(|node| node.parent);
        std::iter::successors(parent(&at), parent).filter(|&at| at != NONE).count() as u16
    }

    /// Swaps a child with a child of the other child, if that makes the other child smaller and the
    /// subtree no higher than `highest`. The swap that saves the most area is made. Among equals it
    /// is the one that makes the subtree lowest, so that equal boxes do not form a list.
    fn rotate(&mut self, at: u32, highest: u16) {
        let node = *self.node(at);
        let (mut most, mut lowest, mut best) = (0.0, node.height, None);
        for side in 0..2 {
            let (lower, upper) = (node.children[side], node.children[1 - side]);
            let split = self.node(upper);
            if split.is_leaf() {
                continue;
            }
            let area = split.bounds.area();
            let lower = self.node(lower);
            for which in 0..2 {
                let [risen, kept] = [which, 1 - which].map(|which| self.node(split.children[which]));
                let height = 1 + (1 + lower.height.max(kept.height)).max(risen.height);
                let saved = area - lower.bounds.enclosing(&kept.bounds).area();
                if height <= highest && (saved > most || (saved == most && height < lowest)) {
                    (most, lowest, best) = (saved, height, Some((side, which)));
                }
            }
        }
        let Some((side, which)) = best else { return };
        let (lower, upper) = (node.children[side], node.children[1 - side]);
        let risen = self.node(upper).children[which];
        self.nodes[at as usize].children[side] = risen;
        self.nodes[risen as usize].parent = at;
        self.nodes[upper as usize].children[which] = lower;
        self.nodes[lower as usize].parent = upper;
        self.pull(upper);
        self.pull(at);
    }
}
