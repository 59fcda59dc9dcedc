//! The parts of a placed compound, found by where they are.

use std::ops::ControlFlow;

use super::PlacedShape;
use crate::partition::{BoxTree, Partition};
use crate::volume::MinMax;

/// Compounds of fewer parts have no tree: their boxes are looked at one by one, which takes no longer.
const FEW: usize = 16;

/// The parts of a placed compound, which are no compounds.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) all: Vec<PlacedShape>,
    tree: Option<PartTree>,
}

impl Parts {
    pub(super) fn new(all: Vec<PlacedShape>) -> Self {
        let tree = PartTree::of(&all);
        Self { all, tree }
    }
}

/// The parts of a compound by their boxes in the world.
#[derive(Clone, Debug)]
struct PartTree {
    tree: BoxTree,
    /// The part of each box of the tree.
    part_of: Vec<u32>,
    /// Parts that have no box, as half-spaces have none, ascending.
    boundless: Vec<u32>,
}

impl PartTree {
    /// None for a few parts.
    fn of(parts: &[PlacedShape]) -> Option<Self> {
        if parts.len() < FEW {
            return None;
        }
        let (mut boxes, mut part_of, mut boundless) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in (0..).zip(parts) {
            match part.bounds().and_then(|[min, max]| MinMax::new(min, max).ok()) {
                Some(bounds) => {
                    boxes.push(bounds);
                    part_of.push(number);
                }
                None => boundless.push(number),
            }
        }
        Some(Self { tree: BoxTree::build(&boxes), part_of, boundless })
    }
}

impl PlacedShape {
    /// The numbers of the parts that may be within a distance of a box, ascending; all of them for what has no box.
    pub(crate) fn parts_near(&self, bounds: Option<[[f64; 3]; 2]>, reach: f64) -> Vec<u32> {
        let all = || (0..self.parts().len() as u32).collect();
        let Some(PartTree { tree, part_of, boundless }) = self.part_tree() else { return all() };
        let enlarged = bounds.and_then(|[min, max]| {
            MinMax::new(min.map(|x| (x - reach).next_down()), max.map(|x| (x + reach).next_up())).ok()
        });
        let Some(enlarged) = enlarged else { return all() };
        let mut near = boundless.clone();
        let mut visit = |at: u32| {
            near.push(part_of[at as usize]);
            ControlFlow::Continue(())
        };
        let _: ControlFlow<()> = tree.overlapping(&enlarged, &mut visit);
        near.sort_unstable();
        near
    }

    /// A part whose box is as near to a point as any, where there is a tree to tell.
    pub(crate) fn part_nearest(&self, point: [f64; 3]) -> Option<u32> {
        let PartTree { tree, part_of, .. } = self.part_tree()?;
        tree.nearest(point, 1).first().map(|found| part_of[found.key as usize])
    }
    fn part_tree(&self) -> Option<&PartTree> {
        self.parts.as_deref()?.tree.as_ref()
    }
}
