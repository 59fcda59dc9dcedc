//! What every partition can do, and how it does it if it has no better way.

use std::ops::ControlFlow;

use super::best::{Best, LIMIT, distance_squared, in_range};
use super::changes::{Changes, Move};
use super::items::Holds;
use super::neighbour::Neighbour;
use super::ray::Ray;
use crate::volume::{BoundingVolume, MinMax};

/// What places along a ray may be off by, of the sizes that they are sums of: far more than what they are, 2^-49.
const PLACES: f64 = 1.0 / (1_u64 << 40) as f64;

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
        march(self, ray, visit);
    }

    /// The `count` boxes that are nearest to the point, or all where there are fewer: by distance, equal ones by key.
    /// None for a point that is not finite or beyond 2^320.
    ///
    /// # Source
    /// A search in cubes that double, of which the first has about one box: ours, for partitions that have no better way.
    fn nearest(&self, point: [f64; 3], count: usize) -> Vec<Neighbour> {
        nearest_in_cubes(self, point, count)
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
pub(super) fn record<P: Partition + ?Sized>(partition: &P, step: &Move, changes: &mut Changes) {
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

/// How far apart boxes are, if they are spread evenly: the longest edge of the bounds over the cube root of their number.
fn spacing(bounds: &MinMax, len: usize) -> f64 {
    let extent = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
    extent / (len as f64).cbrt().max(1.0)
}

/// The nearest boxes, by cubes about the point that double until they hold enough.
fn nearest_in_cubes<P: Partition + ?Sized>(partition: &P, point: [f64; 3], count: usize) -> Vec<Neighbour> {
    let Some(bounds) = partition.bounds().filter(|_| in_range(&point) && count > 0) else { return Vec::new() };
    let mut radius = distance_squared(&point, &bounds).sqrt() + spacing(&bounds, partition.len());
    loop {
        let low = point.map(|x| (x - radius).next_down().max(-LIMIT));
        let high = point.map(|x| (x + radius).next_up().min(LIMIT));
        let cube = MinMax::from_ordered(low, high);
        let mut best = Best::new(count);
        let _ = partition.overlapping(&cube, &mut |key| {
            if let Some(bounds) = partition.get(key) {
                best.offer(key, distance_squared(&point, &bounds));
            }
            ControlFlow::Continue(())
        });
        // What is outside is farther than the radius along some axis, also after rounding.
        if best.limit() < radius * radius || cube.encloses(&bounds) {
            return best.into_sorted();
        }
        radius = 2.0 * radius + f64::MIN_POSITIVE;
    }
}

/// Follows the ray in as many steps as there are boxes along an edge, if they are spread evenly, and asks for what meets
/// the box about each step. A box is visited in the step in which the ray enters it.
fn march<P: Partition + ?Sized>(partition: &P, ray: &Ray, visit: &mut dyn FnMut(RayVisit) -> f64) {
    let Some(bounds) = partition.bounds() else { return };
    let Some([enter, leave]) = ray.through(&bounds) else { return };
    let mut reach = ray.reach().min(leave + f64::MIN_POSITIVE);
    let steps = (partition.len() as f64).cbrt().ceil();
    let length = (reach - enter) / steps;
    let mut step = 0.0;
    while step < steps {
        let [start, end] = [step, step + 1.0].map(|steps| enter + length * steps);
        if start > reach {
            return;
        }
        let (first, last) = (step == 0.0, step + 1.0 == steps);
        let _ = partition.overlapping(&about(ray, start, end), &mut |key| {
            let Some(t) = partition.get(key).and_then(|bounds| ray.enters(&bounds)) else {
                return ControlFlow::Continue(());
            };
            if t <= reach && (first || t >= start) && (last || t < end) {
                reach = reach.min(visit(RayVisit { key, t, reach }));
            }
            if reach < 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        step += 1.0;
    }
}

/// A box about the ray from `start` to `end`, and about what a box that it enters there may be off by.
fn about(ray: &Ray, start: f64, end: f64) -> MinMax {
    let (origin, direction) = (ray.origin(), ray.direction());
    let place = |axis: usize, t: f64| origin[axis] + direction[axis] * t;
    let slack = |axis: usize| PLACES * (origin[axis].abs() + direction[axis].abs() * end) + f64::MIN_POSITIVE;
    let low = [0, 1, 2].map(|axis| (place(axis, start).min(place(axis, end)) - slack(axis)).clamp(-LIMIT, LIMIT));
    let high = [0, 1, 2].map(|axis| (place(axis, start).max(place(axis, end)) + slack(axis)).clamp(-LIMIT, LIMIT));
    MinMax::from_ordered(low, high)
}
