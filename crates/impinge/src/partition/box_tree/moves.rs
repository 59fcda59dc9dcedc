//! Inserts, removes and moves boxes.

use super::super::{Dynamic, Partition};
use super::{BoxTree, MinMax};

/// Maximum excess of a leaf's extent over that of its box, in margins. If it is smaller, boxes that
/// slow down are reinserted more often; if it is larger, leaves stay large when their boxes shrink.
const MAX_MARGINS: f64 = 4.0;

impl Dynamic for BoxTree {
    fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
        let before = self.items.insert(key, bounds);
        match self.bvh.leaf_of(key) {
            Some(leaf) => self.move_leaf(leaf, &bounds),
            None => self.bvh.insert(key, self.fattened(&bounds)),
        }
        before
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        self.bvh.remove(key)?;
        let before = self.items.remove(key);
        debug_assert_eq!(self.is_empty(), self.bvh.root().is_none());
        before
    }
}

impl BoxTree {
    /// Updates the leaf of a box that moved. While the leaf encloses the box and is not too large,
    /// nothing changes. While the parent encloses the new leaf, the leaf is only resized. Otherwise
    /// it is reinserted.
    fn move_leaf(&mut self, leaf: u32, bounds: &MinMax) {
        let held = self.node(leaf).bounds;
        let stays = self.is_fat() && held.encloses(bounds) && !self.is_too_fat(&held, bounds);
        if stays || held == *bounds {
            return;
        }
        let bounds = self.fattened(bounds);
        if self.bvh.parent_of(leaf).is_none_or(|parent| parent.bounds.encloses(&bounds)) {
            self.bvh.resize(leaf, bounds);
        } else {
            self.bvh.reinsert(leaf, bounds);
        }
    }

    fn is_too_fat(&self, held: &MinMax, bounds: &MinMax) -> bool {
        let most = MAX_MARGINS * self.margin;
        let (held_extent, extent) = ([held.min(), held.max()], [bounds.min(), bounds.max()]);
        (0..3).any(|k| held_extent[1][k] - held_extent[0][k] > extent[1][k] - extent[0][k] + most)
    }

    /// Checks the invariants of the tree.
    #[cfg(test)]
    pub(super) fn check(&self) {
        self.bvh.check();
        assert_eq!(self.bvh.len(), self.items.len());
        for (key, bounds) in self.items.iter() {
            assert!(self.bvh.leaf_of(key).is_some_and(|leaf| self.node(leaf).bounds.encloses(bounds)));
        }
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
            assert!(tree.is_empty() && tree.bvh.nodes().len() < 2100, "{} nodes were made", tree.bvh.nodes().len());
        }
    }
}
