//! The parts of a placed compound, found by where they are.

use std::ops::ControlFlow;

use crate::partition::{BoxTree, Partition};
use crate::volume::MinMax;

/// Compounds of fewer parts have no tree: their boxes are looked at one by one, which takes no longer.
const FEW: usize = 16;

/// The parts of a compound by their boxes in the world.
#[derive(Clone, Debug)]
pub(super) struct PartTree {
    tree: BoxTree,
    /// The part of each box of the tree.
    part_of: Vec<u32>,
    /// Parts that have no box, as half-spaces have none, ascending.
    boundless: Vec<u32>,
}

impl PartTree {
    /// The tree of parts with these boxes; none for a few parts.
    pub(super) fn of(parts: impl ExactSizeIterator<Item = Option<[[f64; 3]; 2]>>) -> Option<Self> {
        if parts.len() < FEW {
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

    /// The numbers of the parts that may be within a distance of a box, ascending; none where the box is out of range.
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

    /// A part whose box is as near to a point as any.
    pub(super) fn nearest(&self, point: [f64; 3]) -> Option<u32> {
        self.tree.nearest(point, 1).first().map(|found| self.part_of[found.key as usize])
    }
}
