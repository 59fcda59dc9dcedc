//! Space partitioning: which of many boxes are where (*Notes on Real Time Collision Detection*, introduction; Ericson,
//! chapters 6 and 7). Nothing here knows what is in a box.
//!
//! A partition holds closed boxes, [`MinMax`], under keys that the caller chooses: dense numbers, as memory grows with the
//! greatest. Every kind answers the same questions with the same answers, to the bit; they differ in what they cost, and
//! in what they do to space, which [`Cells`] tells:
//!
//! | kind | space | boxes come and go | made for |
//! |---|---|---|---|
//! | [`BoxTree`] | volumes that may overlap | yes | anything; the fewest surprises |
//! | [`ColumnSweep`] | columns, made anew each time | no: all pairs and nothing else | scenes in which most boxes move |
//! | [`UniformGrid`] | disjoint cells in a block | yes | boxes of like size that fill a known space |
//! | [`HashedGrid`] | disjoint cells without an end | yes | boxes of like size anywhere |
//! | [`HierarchicalGrid`] | disjoint cells of many sizes | yes | boxes of unlike sizes, of which few move |
//! | [`Octree`] | disjoint cubes in cubes | yes | scenes that are dense here and empty there, boxes of unlike sizes |
//! | [`LooseOctree`] | loose cubes in cubes | yes | the same, where boxes lie across the middles of cells |
//! | [`KdTree`] | disjoint cells | no | points and small boxes that stand, and what is nearest |
//! | [`BspTree`] | disjoint cells, planes of the boxes' own | no | rooms and walls that stand |
//! | [`SweepOneAxis`], [`SweepThreeAxes`] | an order along axes | yes | few boxes, or such as move little in long scenes |
//!
//! Touching counts everywhere. Boxes are judged when they are made ([`MinMax::new`]), so that no question has errors; no
//! box is too large, too small or too far away, and any number of them may be equal. Pairs come sorted, each once, with
//! the lesser key first. The same calls give the same bytes on any machine.
//!
//! ```
//! use std::ops::ControlFlow;
//! use impinge::partition::{BoxTree, Changes, Dynamic, Move, Partition};
//! use impinge::volume::MinMax;
//!
//! let mut tree = BoxTree::new();
//! for key in 0..4 {
//!     let x = 2.0 * f64::from(key);
//!     tree.insert(key, MinMax::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])?);
//! }
//! assert!(tree.pairs().is_empty());
//! // Box 3 moves beside box 0, and box 2 leaves.
//! let beside = MinMax::new([1.0, 0.0, 0.0], [1.5, 1.0, 1.0])?;
//! let mut changes = Changes::default();
//! tree.step(&[Move { key: 3, to: Some(beside) }, Move { key: 2, to: None }], &mut changes);
//! assert_eq!((changes.began(), changes.ended()), (&[[0, 3]][..], &[][..]));
//! let mut met = Vec::new();
//! let _ = tree.at([1.0, 0.5, 0.5], &mut |key| {
//!     met.push(key);
//!     ControlFlow::Continue(())
//! });
//! met.sort();
//! assert_eq!(met, [0, 3]);
//! # Ok::<(), impinge::InputError>(())
//! ```

mod box_tree;
mod bsp_tree;
mod changes;
mod column_sweep;
mod grid;
mod items;
mod kd_tree;
mod march;
mod octree;
mod ray;
mod sort_and_sweep;

pub use box_tree::BoxTree;
pub use bsp_tree::BspTree;
pub use changes::{Changes, Move};
pub use column_sweep::ColumnSweep;
pub use grid::{HashedGrid, HierarchicalGrid, UniformGrid};
pub use kd_tree::KdTree;
pub use octree::{LooseOctree, Octree};
pub use ray::Ray;
pub use sort_and_sweep::{Axis, SweepOneAxis, SweepThreeAxes};

use std::ops::ControlFlow;

use crate::volume::{BoundingVolume, MinMax};
use items::{Holds, Items};

/// Called with the key of each box that is found; `Break` ends the search.
pub type Visitor<'v> = dyn FnMut(u32) -> ControlFlow<()> + 'v;

/// What a kind of partition does to space, and so where a box can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cells {
    /// Cells that share no inner point: a point is in one of them. A box is in each that it reaches into, or in the smallest
    /// that holds it, or at the plane that parts it.
    Disjoint,
    /// Cells that are enlarged until each box fits into one; neighbours overlap by what was added.
    Loose,
    /// Volumes about the boxes, which may overlap; a box is in one leaf.
    Volumes,
    /// No cells: the boxes in the order of their ends along axes.
    Order,
}

/// What a search touched, for judging how well a partition stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Nodes or cells.
    pub nodes: u64,
    /// Boxes that were compared with the one that is asked about.
    pub boxes: u64,
}

/// A box that is near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Of the box.
    pub key: u32,
    /// From the point to the nearest point of the box, zero inside.
    ///
    /// # Accuracy
    /// Three squares of rounded differences and two sums: within 2^-51 of itself.
    pub distance_squared: f64,
}

/// Boxes under keys, which can be asked where they are.
///
/// What is found comes in no order unless it is said, but in the same one for the same calls.
pub trait Partition: Holds {
    /// What this kind does to space.
    fn cells(&self) -> Cells;

    /// How many boxes there are.
    fn len(&self) -> usize {
        self.items().len()
    }

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The box of this key.
    fn get(&self, key: u32) -> Option<MinMax> {
        self.items().get(key).copied()
    }

    /// A box that holds all boxes, and may be larger than needed after some went; none where there are none.
    fn bounds(&self) -> Option<MinMax> {
        self.items().bounds()
    }

    /// Visits every box, by ascending keys.
    fn each(&self, visit: &mut dyn FnMut(u32, &MinMax)) {
        self.items().iter().for_each(|(key, bounds)| visit(key, bounds));
    }

    /// Visits each box that meets this one, once, and adds what was touched to `work`.
    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()>;

    /// Visits each box that meets this one, once. Exact.
    fn overlapping(&self, bounds: &MinMax, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        self.overlapping_counted(bounds, &mut Work::default(), visit)
    }

    /// Visits each box that holds this point, once. Exact; nothing holds a point that is not finite.
    fn at(&self, point: [f64; 3], visit: &mut Visitor<'_>) -> ControlFlow<()> {
        match MinMax::new(point, point) {
            Ok(bounds) => self.overlapping(&bounds, visit),
            Err(_) => ControlFlow::Continue(()),
        }
    }

    /// Visits each box that the ray meets, once, with where it enters: [`Ray::enters`]. The visitor returns how far along
    /// the ray to go on looking: what it was given as `reach` or less, so that a caller who wants the first hit looks no
    /// further than the best one, and a negative number to end the search.
    fn ray(&self, ray: &Ray, visit: &mut dyn FnMut(RayVisit) -> f64) {
        march::ray(self, ray, visit);
    }

    /// The `count` boxes that are nearest to the point, or all where there are fewer: by distance, equal ones by key.
    /// None for a point that is not finite or beyond 2^320.
    ///
    /// # Source
    /// A search in cubes that double, of which the first has about one box: ours, for partitions that have no better way.
    fn nearest(&self, point: [f64; 3], count: usize) -> Vec<Neighbour> {
        march::nearest(self, point, count)
    }

    /// All pairs of boxes that meet: sorted, each once, the lesser key first. Exact.
    fn pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        self.each(&mut |key, bounds| {
            let first = pairs.len();
            let _ = self.overlapping(bounds, &mut |other| {
                if other > key {
                    pairs.push([key, other]);
                }
                ControlFlow::Continue(())
            });
            pairs[first..].sort_unstable();
        });
        pairs
    }

    /// All pairs of a box of this partition and one of the other that meet, in this order: sorted. Exact.
    fn pairs_with(&self, other: &dyn Partition) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        self.each(&mut |key, bounds| {
            let first = pairs.len();
            let _ = other.overlapping(bounds, &mut |other| {
                pairs.push([key, other]);
                ControlFlow::Continue(())
            });
            pairs[first..].sort_unstable();
        });
        pairs
    }
}

/// A box that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayVisit {
    /// Of the box.
    pub key: u32,
    /// Where the ray enters it, in units of its direction; zero where it starts inside.
    pub t: f64,
    /// How far the ray is followed so far.
    pub reach: f64,
}

/// A partition whose boxes come, go and move.
pub trait Dynamic: Partition {
    /// Puts a box under a key, in place of the one that is there, which is returned: the way to move it, too.
    ///
    /// Memory grows with the greatest key that was ever used; keys are below 2^32 - 1.
    fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax>;

    /// Takes the box of a key away, and returns it.
    fn remove(&mut self, key: u32) -> Option<MinMax>;

    /// Does all these moves, and says which pairs meet that did not before them, and which no longer do.
    ///
    /// The answer does not depend on the order of moves of different keys; of several of one key the last holds.
    fn step(&mut self, moves: &[Move], changes: &mut Changes) {
        changes.clear();
        for step in moves {
            record(self, step, changes);
            match step.to {
                Some(bounds) => self.insert(step.key, bounds),
                None => self.remove(step.key),
            };
        }
        changes.settle();
    }
}

/// Notes which pairs of this box begin and end when it alone moves.
fn record<P: Partition + ?Sized>(partition: &P, step: &Move, changes: &mut Changes) {
    let key = step.key;
    let from = partition.get(key);
    let meets = |one: &Option<MinMax>, other: &MinMax| one.as_ref().is_some_and(|one| one.overlaps(other));
    let mut look = |around: &MinMax, begins: bool, ends: bool| {
        let _ = partition.overlapping(around, &mut |other| {
            if other != key
                && let Some(bounds) = partition.get(other)
            {
                let (before, after) = (meets(&from, &bounds), meets(&step.to, &bounds));
                if before != after && if after { begins } else { ends } {
                    changes.note(key, other, after);
                }
            }
            ControlFlow::Continue(())
        });
    };
    match (&from, &step.to) {
        // A short way: what is about both places is little more than what is about one.
        (Some(from), Some(to)) if from.overlaps(to) => look(&from.merged(to), true, true),
        (from, to) => {
            from.iter().for_each(|from| look(from, false, true));
            to.iter().for_each(|to| look(to, true, false));
        }
    }
}
