//! Builds the tree over all boxes at once: split at the median center along the longest axis.

use super::super::Dynamic;
use super::{BoxTree, MinMax};

impl BoxTree {
    /// Returns the tree of these boxes. The key of a box is its index in `boxes`. The tree is
    /// balanced, and building it is several times faster than inserting the boxes one by one.
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

    /// Rebuilds the tree over its boxes. After most of them moved far, rebuilding makes the tree as
    /// good as a new one.
    pub fn rebuild(&mut self) {
        let mut leaves: Vec<_> = self.items.iter().map(|(key, bounds)| (key, self.fattened(bounds))).collect();
        self.bvh.rebuild(&mut leaves, split_at_median);
    }
}

/// Moves the half of the boxes with the smallest centers, along the axis on which the centers
/// spread most, to the front.
fn split_at_median(leaves: &mut [(u32, MinMax)]) {
    let twice_center = |bounds: &MinMax, axis: usize| bounds.min()[axis] + bounds.max()[axis];
    let extent = |axis: usize| {
        let centers = leaves.iter().map(|leaf| twice_center(&leaf.1, axis));
        centers.clone().fold(f64::MIN, f64::max) - centers.fold(f64::MAX, f64::min)
    };
    let extents = [extent(0), extent(1), extent(2)];
    let axis = (0..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
    // Keys decide between equal centers, so that the tree is the same however the selection works.
    leaves.select_nth_unstable_by(leaves.len() / 2, |one, other| {
        twice_center(&one.1, axis).total_cmp(&twice_center(&other.1, axis)).then(one.0.cmp(&other.0))
    });
}

impl FromIterator<(u32, MinMax)> for BoxTree {
    /// Returns a tree into which the boxes were inserted one by one under their keys.
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
