//! How boxes come, move and go: the search for the place where the tree grows least, and rotations on the way up.

use super::super::{Dynamic, Partition};
use super::candidate::Candidate;
use super::{BoxTree, DEEPEST, MinMax, NONE, Node};
use crate::volume::BoundingVolume;

/// Nodes that a search visits at most. The first few dozen lead down to a leaf; what they miss, rotations mostly mend.
const MOST_VISITED: usize = 96;

/// How much larger than needed, in margins, a leaf may be and stay: fewer would put back those that slow down, more keep
/// the fat of boxes that shrank.
const MOST_MARGINS: f64 = 4.0;

impl Dynamic for BoxTree {
    fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
        let before = self.items.insert(key, bounds);
        if let Some(leaf) = self.leaf_of(key) {
            self.move_leaf(leaf, &bounds);
            return before;
        }
        if key as usize >= self.leaves.len() {
            self.leaves.resize(key as usize + 1, NONE);
        }
        let bounds = self.fattened(&bounds);
        let leaf = self.allocate(Node { bounds, parent: NONE, children: [key, NONE], height: 0, shallow: 0 });
        self.leaves[key as usize] = leaf;
        self.put(leaf);
        before
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        let leaf = self.leaf_of(key)?;
        self.take(leaf);
        self.free.push(leaf);
        self.leaves[key as usize] = NONE;
        let before = self.items.remove(key);
        debug_assert_eq!(self.is_empty(), self.root.is_none());
        before
    }
}

impl BoxTree {
    fn allocate(&mut self, node: Node) -> u32 {
        if let Some(at) = self.free.pop() {
            self.nodes[at as usize] = node;
            return at;
        }
        self.nodes.push(node);
        (self.nodes.len() - 1) as u32
    }

    /// Follows a box that moved: the leaf stays as it is, or where it is, or goes elsewhere.
    fn move_leaf(&mut self, leaf: u32, bounds: &MinMax) {
        let held = self.node(leaf).bounds;
        let stays = self.is_fat() && held.encloses(bounds) && !self.is_too_fat(&held, bounds);
        if stays || held == *bounds {
            return;
        }
        let bounds = self.fattened(bounds);
        let parent = self.node(leaf).parent;
        if parent == NONE || self.node(parent).bounds.encloses(&bounds) {
            self.nodes[leaf as usize].bounds = bounds;
            self.refit_up(parent);
        } else {
            self.take(leaf);
            self.nodes[leaf as usize].bounds = bounds;
            self.put(leaf);
        }
    }

    fn is_too_fat(&self, held: &MinMax, bounds: &MinMax) -> bool {
        let most = MOST_MARGINS * self.margin;
        let (held_extent, extent) = ([held.min(), held.max()], [bounds.min(), bounds.max()]);
        (0..3).any(|k| held_extent[1][k] - held_extent[0][k] > extent[1][k] - extent[0][k] + most)
    }

    /// Takes a leaf out of the tree; the node that joined it with its sibling goes.
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

    /// Puts a leaf that is in no tree where the tree grows least.
    fn put(&mut self, leaf: u32) {
        let Some(root) = self.root else {
            self.nodes[leaf as usize].parent = NONE;
            self.root = Some(leaf);
            return;
        };
        let bounds = self.node(leaf).bounds;
        let sibling = self.best_place(root, &bounds).unwrap_or_else(|| self.shallowest_leaf(root));
        let above = self.node(sibling).parent;
        let joint = self.allocate(Node { bounds, parent: above, children: [sibling, leaf], height: 1, shallow: 1 });
        self.replace(above, sibling, joint);
        self.nodes[sibling as usize].parent = joint;
        self.nodes[leaf as usize].parent = joint;
        self.pull(joint);
        self.refit_up(above);
    }

    /// Puts `new` where `old` is below `above`, or at the root.
    fn replace(&mut self, above: u32, old: u32, new: u32) {
        self.nodes[new as usize].parent = above;
        if above == NONE {
            self.root = Some(new);
            return;
        }
        let children = &mut self.nodes[above as usize].children;
        children[usize::from(children[1] == old)] = new;
    }

    /// The node beside which the areas of all nodes grow least in sum, among those that were looked at and have room below.
    fn best_place(&mut self, root: u32, bounds: &MinMax) -> Option<u32> {
        let own = bounds.surface_area();
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.push(Candidate { grown: 0.0, depth: 0, node: root });
        let (mut best, mut place) = (f64::INFINITY, None);
        for _ in 0..MOST_VISITED {
            let Some(Candidate { grown, depth, node: at }) = candidates.pop() else { break };
            // Wherever it goes below, a joint at least as large as the box itself is added.
            if grown + own >= best {
                break;
            }
            let node = self.node(at);
            let joint = node.bounds.merged(bounds).surface_area();
            if grown + joint < best && depth + 1 + node.height <= DEEPEST {
                (best, place) = (grown + joint, Some(at));
            }
            if !node.is_leaf() {
                let grown = grown + (joint - node.bounds.surface_area());
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

    /// Makes the nodes from here up anew and rotates where that makes one smaller, as far as anything changes.
    fn refit_up(&mut self, from: u32) {
        let mut at = from;
        while at != NONE {
            let before = *self.node(at);
            self.pull(at);
            self.rotate(at);
            let after = self.node(at);
            if (after.bounds, after.height, after.shallow) == (before.bounds, before.height, before.shallow) {
                return;
            }
            at = after.parent;
        }
    }

    /// Swaps a child with a grandchild on the other side where that makes the other child smallest, if it does and the tree
    /// does not grow higher; among equals where the tree grows lower, so that boxes in one place make no list.
    fn rotate(&mut self, at: u32) {
        let node = *self.node(at);
        let (mut most, mut lowest, mut best) = (0.0, node.height, None);
        for side in 0..2 {
            let (lower, upper) = (node.children[side], node.children[1 - side]);
            let split = self.node(upper);
            if split.is_leaf() {
                continue;
            }
            let area = split.bounds.surface_area();
            let lower = self.node(lower);
            for which in 0..2 {
                let [risen, kept] = [which, 1 - which].map(|which| self.node(split.children[which]));
                let height = 1 + (1 + lower.height.max(kept.height)).max(risen.height);
                let saved = area - lower.bounds.merged(&kept.bounds).surface_area();
                if height <= node.height && (saved > most || (saved == most && height < lowest)) {
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

    /// What the tree says of itself is true: for tests.
    #[cfg(test)]
    pub(super) fn check(&self) {
        let Some(root) = self.root else {
            assert!(self.is_empty());
            return;
        };
        assert_eq!(self.node(root).parent, NONE);
        assert!(self.node(root).height <= DEEPEST);
        let (mut stack, mut leaves) = (vec![root], 0);
        while let Some(at) = stack.pop() {
            let node = self.node(at);
            if node.is_leaf() {
                let key = node.children[0];
                leaves += 1;
                assert_eq!(self.leaf_of(key), Some(at));
                assert!(self.items.get(key).is_some_and(|bounds| node.bounds.encloses(bounds)));
                continue;
            }
            let [one, other] = node.children.map(|child| self.node(child));
            assert_eq!((one.parent, other.parent), (at, at));
            assert_eq!(node.bounds, one.bounds.merged(&other.bounds));
            assert_eq!(node.height, 1 + one.height.max(other.height));
            assert_eq!(node.shallow, 1 + one.shallow.min(other.shallow));
            stack.extend(node.children);
        }
        assert_eq!(leaves, self.items.len());
        assert_eq!(self.nodes.len() - self.free.len(), 2 * leaves - 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    #[test]
    fn the_tree_stays_sound_and_low_under_hostile_orders() {
        let mut rng = Rng::new(71);
        for margin in [0.0, 0.25] {
            let mut tree = BoxTree::with_margin(margin);
            for step in 0..6000_u32 {
                let key = rng.integer(0, 999) as u32;
                let x = match step / 1500 {
                    0 => f64::from(step),                   // sorted
                    1 => 2.0_f64.powi((step % 300) as i32), // nested, ever larger
                    2 => 0.0,                               // all the same
                    _ => rng.uniform(-50.0, 50.0).round(),
                };
                if rng.one_in(4) {
                    tree.remove(key);
                } else {
                    let low = if step / 1500 == 1 { [0.0; 3] } else { [x; 3] };
                    tree.insert(key, MinMax::new(low, [x + 1.0; 3]).unwrap());
                }
                if step % 50 == 0 {
                    tree.check();
                }
            }
            tree.check();
            assert!(tree.height() <= 32, "{} high with {} boxes", tree.height(), tree.len());
            for key in 0..1000 {
                tree.remove(key);
            }
            tree.check();
            assert!(tree.is_empty() && tree.nodes.len() < 2100, "{} nodes were made", tree.nodes.len());
        }
    }
}
