//! A tree that finds the parts of a placed compound by their boxes.

use std::ops::ControlFlow;

use crate::partition::{BoxTree, Partition};
use crate::volume::MinMax;

/// Minimum number of parts of a compound for which a tree is built. For fewer parts it takes no
/// longer to test their boxes one by one.
const MIN_TREE_PARTS: usize = 16;

/// Tree over the parts of a compound by their boxes in the world.
#[derive(Clone, Debug)]
pub(super) struct PartTree {
    tree: BoxTree,
    /// Index of the part that each box of the tree bounds.
    part_of: Vec<u32>,
    /// Parts without a box, such as half-spaces, in ascending order.
    boundless: Vec<u32>,
}

impl PartTree {
    /// Returns the tree of parts with these boxes, or `None` if there are few parts.
    pub(super) fn of(parts: impl ExactSizeIterator<Item = Option<[[f64; 3]; 2]>>) -> Option<Self> {
        if parts.len() < MIN_TREE_PARTS {
            return None;
        }
        let (mut boxes, mut part_of, mut boundless) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in (0..).zip(parts) {
            match part.and_then(|[min, max]| MinMax::new(min, max).ok()) {
                Some(bounds) => {
                    boxes.push(bounds);
                    part_of.push(number);
                }
                None => boundless.push(number),
            }
        }
        Some(Self { tree: BoxTree::build(&boxes), part_of, boundless })
    }

    /// Returns the indices of the parts that may be within `reach` of a box, in ascending order.
    /// Returns `None` if there is no box or if it is out of range.
    pub(super) fn near(&self, bounds: Option<[[f64; 3]; 2]>, reach: f64) -> Option<Vec<u32>> {
        let Self { tree, part_of, boundless } = self;
        let enlarged = bounds.and_then(|[min, max]| {
            MinMax::new(min.map(|x| (x - reach).next_down()), max.map(|x| (x + reach).next_up())).ok()
        })?;
        let mut near = boundless.clone();
        let mut visit = |at: u32| {
            near.push(part_of[at as usize]);
            ControlFlow::Continue(())
        };
        let _: ControlFlow<()> = tree.overlapping(&enlarged, &mut visit);
        near.sort_unstable();
        Some(near)
    }

    /// Returns a part whose box is nearest to a point. Returns `None` if no part has a box.
    pub(super) fn nearest(&self, point: [f64; 3]) -> Option<u32> {
        self.tree.nearest(point, 1).first().map(|found| self.part_of[found.key as usize])
    }
}
