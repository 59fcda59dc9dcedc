//! All boxes at once: split at the median centre along the longest axis.

use super::super::{Dynamic, Partition};
use super::{BoxTree, MinMax, NONE, Node};

impl BoxTree {
    /// The tree of these boxes, whose keys are their places: balanced, and several times quicker than inserting them.
    ///
    /// # Complexity
    /// O(n log n) for any boxes.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        let mut tree = Self::new();
        for (key, bounds) in boxes.iter().enumerate() {
            tree.items.insert(key as u32, *bounds);
        }
        tree.rebuild();
        tree
    }

    /// Builds the tree anew over the boxes that it holds: after most of them moved far, this makes it what it was at first.
    pub fn rebuild(&mut self) {
        self.nodes.clear();
        self.free.clear();
        self.leaves.fill(NONE);
        self.root = None;
        let mut leaves = Vec::with_capacity(self.len());
        for (key, bounds) in self.items.iter() {
            leaves.push((key, self.fattened(bounds)));
        }
        self.leaves.resize(leaves.last().map_or(0, |leaf| leaf.0 as usize + 1), NONE);
        self.nodes.reserve(2 * leaves.len());
        if !leaves.is_empty() {
            self.root = Some(self.subtree(&mut leaves, NONE));
        }
    }

    /// Halving keeps it at most 32 deep, which is as deep as this calls itself.
    fn subtree(&mut self, leaves: &mut [(u32, MinMax)], parent: u32) -> u32 {
        let at = self.nodes.len() as u32;
        let (key, bounds) = leaves[0];
        self.nodes.push(Node { bounds, parent, children: [key, NONE], height: 0, shallow: 0 });
        if leaves.len() == 1 {
            self.leaves[key as usize] = at;
            return at;
        }
        let twice_centre = |bounds: &MinMax, axis: usize| bounds.min()[axis] + bounds.max()[axis];
        let extent = |axis: usize| {
            let centres = leaves.iter().map(|leaf| twice_centre(&leaf.1, axis));
            centres.clone().fold(f64::MIN, f64::max) - centres.fold(f64::MAX, f64::min)
        };
        let extents = [extent(0), extent(1), extent(2)];
        let axis = (0..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
        let middle = leaves.len() / 2;
        // Keys decide between equal centres, so that the tree is the same however the selection works.
        leaves.select_nth_unstable_by(middle, |one, other| {
            twice_centre(&one.1, axis).total_cmp(&twice_centre(&other.1, axis)).then(one.0.cmp(&other.0))
        });
        let (low, high) = leaves.split_at_mut(middle);
        let children = [self.subtree(low, at), self.subtree(high, at)];
        self.nodes[at as usize].children = children;
        self.pull(at);
        at
    }
}

impl FromIterator<(u32, MinMax)> for BoxTree {
    /// Boxes with their keys, put in one after the other.
    fn from_iter<I: IntoIterator<Item = (u32, MinMax)>>(boxes: I) -> Self {
        let mut tree = Self::new();
        for (key, bounds) in boxes {
            tree.insert(key, bounds);
        }
        tree
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    #[test]
    fn a_built_tree_is_sound_and_balanced() {
        let mut rng = Rng::new(72);
        for len in [0, 1, 2, 3, 100, 1000] {
            let boxes: Vec<MinMax> = (0..len)
                .map(|_| {
                    let low = [0; 3].map(|_: i32| rng.integer(0, 4) as f64);
                    MinMax::new(low, low).unwrap()
                })
                .collect();
            let mut tree = BoxTree::build(&boxes);
            tree.check();
            assert!(1 << tree.height() < 2 * len.max(1), "{len} boxes, {} high", tree.height());
            for key in 0..len as u32 / 2 {
                tree.remove(2 * key);
            }
            tree.rebuild();
            tree.check();
        }
    }
}
