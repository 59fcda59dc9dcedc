//! The parts of a scene as obstacles of a robot: they stay in their places.

use std::collections::HashSet;
use std::ops::ControlFlow;

use super::cull::Limb;
use super::links::{PlacedLink, may_be_near};
use crate::partition::{BoxTree, Partition};
use crate::scene::{PartId, Scene};
use crate::volume::MinMax;

/// Maximum number of obstacles whose boxes are compared one by one. For more of them a tree finds
/// the boxes that are near.
const MAX_LISTED: usize = 16;

/// Obstacles at their places.
#[derive(Debug)]
pub(super) struct Obstacles {
    parts: Vec<(PartId, PlacedLink)>,
    /// Tree of the boxes of the bounded obstacles, if there are many. Keys are indices.
    tree: Option<BoxTree>,
    /// Indices of the obstacles without a box.
    unbounded: Vec<usize>,
    /// Pairs of a link and an obstacle that are not checked.
    ignored: HashSet<(usize, PartId)>,
}

impl Obstacles {
    pub(super) fn new(scene: Option<&Scene>, ignored: &[(usize, PartId)]) -> Self {
        let place = |scene: &Scene, part| PlacedLink::new(scene.shape(part), Some(*scene.pose(part)));
        let parts: Vec<(PartId, PlacedLink)> =
            scene.map(|scene| scene.parts().map(|part| (part, place(scene, part))).collect()).unwrap_or_default();
        let boxes = || parts.iter().map(|(_, placed)| placed.bounds());
        let unbounded = (0..parts.len()).filter(|&at| parts[at].1.bounds().is_none() && !parts[at].1.is_nowhere());
        let bounded = |(at, bounds): (usize, Option<[[f64; 3]; 2]>)| {
            let [min, max] = bounds?;
            Some((at as u32, MinMax::new(min, max).ok()?))
        };
        let tree = (parts.len() > MAX_LISTED).then(|| boxes().enumerate().filter_map(bounded).collect());
        let unbounded = unbounded.collect();
        Self { parts, tree, unbounded, ignored: ignored.iter().copied().collect() }
    }

    /// Calls `visit` with the index of each obstacle that is compared with a link and may be within
    /// a limit, and with a lower bound of its distance. `limbs` are the capsules about the link, if
    /// any are known, and the rounding of their places.
    pub(super) fn distances(
        &self,
        link: usize,
        limbs: Option<(&[Limb], f64)>,
        limit: f64,
        mut visit: impl FnMut(usize, f64),
    ) {
        for (at, (part, placed)) in self.parts.iter().enumerate() {
            if placed.is_nowhere() || self.ignored.contains(&(link, *part)) {
                continue;
            }
            let least = match (limbs, placed.bounds()) {
                (Some((limbs, slack)), Some(bounds)) => {
                    let gaps = limbs.iter().map(|limb| gap_of_box(limb, bounds));
                    (gaps.fold(f64::INFINITY, f64::min) - slack).max(0.0)
                }
                _ => 0.0,
            };
            if least <= limit {
                visit(at, least);
            }
        }
    }

    /// Finds the obstacles that may be within a clearance of a link, in the order of the scene.
    pub(super) fn near(&self, link: (usize, &PlacedLink), clearance: f64, found: &mut Vec<usize>) {
        found.clear();
        let (number, placed) = link;
        let is_near = |&at: &usize| {
            let (part, obstacle) = &self.parts[at];
            may_be_near(placed, obstacle, clearance) && !self.ignored.contains(&(number, *part))
        };
        match (&self.tree, grown(placed, clearance)) {
            (Some(tree), Some(bounds)) => {
                _ = tree.overlapping(&bounds, &mut |key| {
                    found.push(key as usize);
                    ControlFlow::Continue(())
                });
                found.extend(&self.unbounded);
                found.retain(|at| is_near(at));
                found.sort_unstable();
            }
            _ => found.extend((0..self.parts.len()).filter(is_near)),
        }
    }

    /// Reports whether capsules may be within a clearance of an obstacle, by the box of each.
    pub(super) fn may_be_near(&self, limbs: &[Limb], clearance: f64) -> bool {
        if !self.unbounded.is_empty() {
            return true;
        }
        limbs.iter().any(|limb| {
            let [start, end] = limb.ends;
            let reach = (limb.radius + clearance).next_up();
            let min = std::array::from_fn(|k| (start[k].min(end[k]) - reach).next_down());
            let max = std::array::from_fn(|k| (start[k].max(end[k]) + reach).next_up());
            // Bounds that are not numbers overlap everything.
            let overlaps = |[low, high]: [[f64; 3]; 2]| (0..3).all(|k| !(min[k] > high[k] || low[k] > max[k]));
            match (&self.tree, MinMax::new(min, max)) {
                (Some(tree), Ok(bounds)) => tree.overlapping(&bounds, &mut |_| ControlFlow::Break(())).is_break(),
                _ => self.parts.iter().any(|(_, placed)| placed.bounds().is_some_and(overlaps)),
            }
        })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Returns an obstacle.
    pub(super) fn part(&self, at: usize) -> (PartId, &PlacedLink) {
        let (part, placed) = &self.parts[at];
        (*part, placed)
    }
}

/// Returns a lower bound of the distance of a capsule and a box: that of the box about the capsule.
fn gap_of_box(limb: &Limb, [min, max]: [[f64; 3]; 2]) -> f64 {
    let [start, end] = limb.ends;
    let gap = |k: usize| (min[k] - start[k].max(end[k])).max(start[k].min(end[k]) - max[k]).max(0.0);
    let squared = (0..3).map(|k| gap(k) * gap(k)).sum::<f64>();
    squared.sqrt() * (1.0 - 16.0 * f64::EPSILON) - limb.radius
}

/// Returns the box about a link, grown by a clearance, rounded outwards.
fn grown(placed: &PlacedLink, clearance: f64) -> Option<MinMax> {
    let [min, max] = placed.bounds()?;
    let grow = |x: f64| if clearance > 0.0 { (x + clearance).next_up() } else { x };
    MinMax::new(min.map(|x| -grow(-x)), max.map(grow)).ok()
}
