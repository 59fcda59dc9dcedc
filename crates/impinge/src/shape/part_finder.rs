//! Finds the parts of a placed compound by their boxes, with a tree if it is asked often.

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::partition::{BoxTree, Partition};
use crate::volume::MinMax;

/// Minimum number of parts of a compound whose boxes are compared at all. Callers compare the boxes
/// of fewer parts themselves.
const MIN_PARTS: usize = 16;

/// Number of questions that are answered by a list of all boxes before a tree is built. A tree
/// takes as long as about 20 of them, and a compound at one of many poses is asked once or twice.
const MAX_LISTED: u32 = 8;

/// Box of a part in the world, if it has one.
type PartBox = Option<[[f64; 3]; 2]>;

/// Finds the parts of a placed compound that are near a box or a point.
#[derive(Debug, Default)]
pub(super) struct PartFinder {
    /// Number of questions so far, while there is no tree.
    asked: AtomicU32,
    tree: OnceLock<PartTree>,
}

impl Clone for PartFinder {
    /// Returns a finder without a tree, as the parts of a clone can be moved.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Tree over the parts of a compound by their boxes in the world.
#[derive(Debug)]
struct PartTree {
    tree: BoxTree,
    /// Index of the part that each box of the tree bounds.
    part_of: Vec<u32>,
    /// Parts without a box, such as half-spaces, in ascending order.
    boundless: Vec<u32>,
}

impl PartFinder {
    /// Returns the indices of the parts that may be within `reach` of a box, in ascending order.
    /// Returns `None` if there are few parts, if there is no box, or if it is out of range.
    pub(super) fn near(
        &self,
        parts: impl ExactSizeIterator<Item = PartBox>,
        bounds: PartBox,
        reach: f64,
    ) -> Option<Vec<u32>> {
        if parts.len() < MIN_PARTS {
            return None;
        }
        let enlarged = bounds.and_then(|[min, max]| {
            MinMax::new(min.map(|x| (x - reach).next_down()), max.map(|x| (x + reach).next_up())).ok()
        })?;
        Some(match self.tree(parts) {
            Ok(tree) => tree.near(&enlarged),
            Err(parts) => {
                let [low, high] = [enlarged.min(), enlarged.max()];
                let is_near = |[min, max]: [[f64; 3]; 2]| (0..3).all(|k| min[k] <= high[k] && low[k] <= max[k]);
                let all = (0..).zip(parts).filter(|(_, part)| part.is_none_or(is_near));
                all.map(|(number, _)| number).collect()
            }
        })
    }

    /// Returns a part whose box is nearest to a point. Returns `None` if there are few parts, or if
    /// no part has a box.
    pub(super) fn nearest(&self, parts: impl ExactSizeIterator<Item = PartBox>, point: [f64; 3]) -> Option<u32> {
        if parts.len() < MIN_PARTS {
            return None;
        }
        let parts = match self.tree(parts) {
            Ok(tree) => return tree.nearest(point),
            Err(parts) => parts,
        };
        let gap = |[min, max]: [[f64; 3]; 2]| {
            (0..3).map(|k| (min[k] - point[k]).max(point[k] - max[k]).max(0.0).powi(2)).sum::<f64>()
        };
        let gaps = (0..).zip(parts).filter_map(|(number, part)| Some((gap(part?), number)));
        gaps.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number)| number)
    }

    /// Returns the tree, or the boxes if there were few questions.
    fn tree<P: Iterator<Item = PartBox>>(&self, parts: P) -> Result<&PartTree, P> {
        if self.tree.get().is_none() && self.asked.fetch_add(1, Ordering::Relaxed) < MAX_LISTED {
            return Err(parts);
        }
        Ok(self.tree.get_or_init(|| PartTree::of(parts)))
    }
}

impl PartTree {
    fn of(parts: impl Iterator<Item = PartBox>) -> Self {
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
        Self { tree: BoxTree::build(&boxes), part_of, boundless }
    }

    fn near(&self, enlarged: &MinMax) -> Vec<u32> {
        let Self { tree, part_of, boundless } = self;
        let mut near = boundless.clone();
        let mut visit = |at: u32| {
            near.push(part_of[at as usize]);
            ControlFlow::Continue(())
        };
        let _: ControlFlow<()> = tree.overlapping(enlarged, &mut visit);
        near.sort_unstable();
        near
    }

    fn nearest(&self, point: [f64; 3]) -> Option<u32> {
        self.tree.nearest(point, 1).first().map(|found| self.part_of[found.key as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::shape::{PlacedShape, Shape};
    use impinge_testkit::generate::Rng;

    /// Boxes on a grid, which touch each other, and a half-space.
    #[test]
    fn a_list_and_a_tree_find_the_same_parts() {
        let mut rng = Rng::new(51);
        let cube = Shape::cuboid([0.5; 3]).expect("a cube");
        let place = |at: [i64; 3]| Pose::from_translation(at.map(|x| x as f64)).expect("a pose");
        let mut outside = 0;
        for _ in 0..200 {
            let count = rng.integer(16, 40);
            let mut shapes: Vec<_> =
                (0..count).map(|_| (cube.clone(), place([0; 3].map(|_| rng.integer(-3, 3))))).collect();
            shapes.push((Shape::half_space([0.0, 0.0, 1.0], -9.0).expect("a half-space"), Pose::IDENTITY));
            let compound = Shape::compound(&shapes).expect("a compound").at(Pose::IDENTITY).expect("a place");
            let parts = compound.parts();
            let boxes = || parts.iter().map(PlacedShape::bounds);
            let (list, tree) = (PartFinder::default(), PartTree::of(boxes()));
            let low = [0; 3].map(|_| 0.5 * rng.integer(-8, 8) as f64);
            let high = low.map(|x| x + rng.integer(0, 2) as f64);
            let reach = 0.5 * rng.integer(0, 2) as f64;
            let of_list = list.near(boxes(), Some([low, high]), reach).expect("many parts");
            let enlarged = MinMax::new(low.map(|x| (x - reach).next_down()), high.map(|x| (x + reach).next_up()));
            assert_eq!(of_list, tree.near(&enlarged.expect("a box")));
            assert!(list.tree.get().is_none() && of_list.contains(&(count as u32)));
            let gap = |number: u32| {
                let [min, max] = parts[number as usize].bounds().expect("a box");
                (0..3).map(|k| (min[k] - low[k]).max(low[k] - max[k]).max(0.0).powi(2)).sum::<f64>()
            };
            let [of_list, of_tree] =
                [list.nearest(boxes(), low), tree.nearest(low)].map(|found| found.expect("a part"));
            assert!(gap(of_list) == gap(of_tree));
            outside += u32::from(gap(of_list) > 0.0);
        }
        assert!((100..190).contains(&outside), "{outside}");
    }

    #[test]
    fn a_compound_that_is_asked_often_gets_a_tree() {
        let sphere = Shape::sphere([0.0; 3], 0.5).expect("a sphere");
        for (count, asked, has_tree) in [(15, 100, false), (16, MAX_LISTED, false), (16, MAX_LISTED + 1, true)] {
            let parts = vec![(sphere.clone(), Pose::IDENTITY); count];
            let compound = Shape::compound(&parts).expect("a compound").at(Pose::IDENTITY).expect("a place");
            let finder = PartFinder::default();
            for _ in 0..asked {
                let near = finder.near(compound.parts().iter().map(PlacedShape::bounds), Some([[0.0; 3]; 2]), 0.0);
                assert_eq!(near.map(|near| near.len()), (count > 15).then_some(count));
            }
            assert_eq!(finder.tree.get().is_some(), has_tree);
            assert!(finder.clone().tree.get().is_none());
        }
    }
}
