//! The interface of all partitions, with default implementations for kinds that have no faster way.

use std::ops::ControlFlow;

use super::best::{Best, LIMIT, distance_squared, in_range};
use super::changes::{Changes, Move};
use super::items::Holds;
use super::neighbor::Neighbor;
use super::pair_list::PairList;
use super::ray::Ray;
use crate::budget::{Budget, Stopped};
use crate::volume::{BoundingVolume, MinMax};

/// Bound on the error of a computed position along a ray, relative to the sum of the sizes of its
/// terms. The true error is at most 2^-49; 2^-40 is a generous margin that makes the searched boxes
/// only slightly larger.
const POSITION_ERROR: f64 = 1.0 / (1_u64 << 40) as f64;

/// Function that is called with the key of each box found. If it returns `Break`, the search ends.
pub type Visitor<'v> = dyn FnMut(u32) -> ControlFlow<()> + 'v;

/// Function that is called with the keys of each pair found. If it returns `Break`, the search
/// ends.
pub type PairVisitor<'v> = dyn FnMut([u32; 2]) -> ControlFlow<()> + 'v;

/// How a kind of partition divides space, and so in which cells a box is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cells {
    /// Disjoint cells: no two cells of one level share an inner point. A box is stored in every
    /// cell that it reaches into, in the smallest cell that contains it, or at the plane that it
    /// crosses.
    Disjoint,
    /// Loose cells, which are enlarged until each box fits into one cell. Neighboring cells overlap
    /// by the enlargement.
    Loose,
    /// Volumes around the boxes, which may overlap. Each box is in one leaf.
    Volumes,
    /// No cells: the boxes are sorted by their ends along one or three axes.
    Order,
}

/// Counters of the work of a search, for measuring how well a partition fits a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Number of nodes or cells visited.
    pub nodes: u64,
    /// Number of boxes compared with the query box.
    pub boxes: u64,
}

/// A set of boxes under keys, which can be searched by position. All boxes, points and rays are in
/// one frame and unit, which the caller chooses.
///
/// Results come in no particular order unless a method says otherwise, but the same calls return
/// them in the same order.
pub trait Partition: Holds {
    /// Returns how this kind of partition divides space.
    fn cells(&self) -> Cells;

    /// Returns the number of boxes.
    fn len(&self) -> usize {
        self.items().len()
    }

    /// Returns `true` if the partition holds no boxes.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the box under a key, or `None` if there is none.
    fn get(&self, key: u32) -> Option<MinMax> {
        self.items().get(key).copied()
    }

    /// Returns a box that contains all boxes, or `None` if the partition is empty. It may be larger
    /// than necessary after boxes were moved or removed.
    fn bounds(&self) -> Option<MinMax> {
        self.items().bounds()
    }

    /// Visits every box, in ascending order of keys.
    fn each(&self, visit: &mut dyn FnMut(u32, &MinMax)) {
        self.items().iter().for_each(|(key, bounds)| visit(key, bounds));
    }

    /// Visits each box that overlaps `bounds`, once, and adds the work done to `work`. The overlap
    /// test is exact. Returns `Break` if the visitor ended the search.
    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()>;

    /// Visits each box that overlaps `bounds`, once. The overlap test is exact. Returns `Break` if
    /// the visitor ended the search.
    fn overlapping(&self, bounds: &MinMax, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        self.overlapping_counted(bounds, &mut Work::default(), visit)
    }

    /// Visits each box that has the point inside or on its boundary, once. The test is exact; no
    /// box contains a point with a NaN or infinite coordinate. Returns `Break` if the visitor ended
    /// the search.
    fn at(&self, point: [f64; 3], visit: &mut Visitor<'_>) -> ControlFlow<()> {
        match MinMax::new(point, point) {
            Ok(bounds) => self.overlapping(&bounds, visit),
            Err(_) => ControlFlow::Continue(()),
        }
    }

    /// Visits each box that the ray enters according to [`Ray::enters`], once, with the parameter
    /// at which it does.
    ///
    /// The visitor returns how far along the ray to search on. It returns the `reach` that it
    /// received to continue, a smaller number to search less far (the `t` of the best hit so far,
    /// to find the first hit), or a negative number to end the search.
    fn ray(&self, ray: &Ray, visit: &mut dyn FnMut(RayVisit) -> f64) {
        march(self, ray, visit);
    }

    /// Returns the `count` boxes nearest to the point, or all boxes if there are fewer, sorted by
    /// distance and then by key. Returns an empty list if the point is not finite or has a
    /// coordinate beyond 2^320.
    ///
    /// # Source
    /// Ours, for partitions that have no faster way: a search in cubes that double in size. The
    /// first cube holds about one box.
    fn nearest(&self, point: [f64; 3], count: usize) -> Vec<Neighbor> {
        nearest_in_cubes(self, point, count)
    }

    /// Visits all pairs of boxes that overlap, each once, the smaller key first, in no particular
    /// order. Exact. Returns `Break` if the visitor ended the search.
    fn for_each_pair(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        self.each(&mut |key, bounds| {
            if flow.is_continue() {
                let mut visit = |other| if other > key { visit([key, other]) } else { ControlFlow::Continue(()) };
                flow = self.overlapping(bounds, &mut visit);
            }
        });
        flow
    }

    /// Returns all pairs of boxes that overlap: sorted, without duplicates, the smaller key first.
    /// Exact.
    ///
    /// The number of pairs can be as large as the square of the number of boxes. The process ends
    /// if there is not enough memory for them; [`try_pairs`](Self::try_pairs) returns an error
    /// instead.
    fn pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        let _ = self.for_each_pair(&mut |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        });
        pairs.sort_unstable();
        pairs
    }

    /// Returns all pairs of boxes that overlap, as [`pairs`](Self::pairs) does. Ends early, without
    /// pairs, if the budget is spent.
    ///
    /// # Errors
    /// Returns an error if the budget ended the search, or if there is not enough memory for the
    /// pairs.
    fn try_pairs(&self, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        let mut pairs = PairList::new(budget);
        let _ = self.for_each_pair(&mut |pair| pairs.push(pair));
        pairs.into_sorted()
    }

    /// Visits all pairs of a box of this partition and a box of `other` that overlap, each once, in
    /// no particular order. The key of the box of this partition comes first. Exact. Returns
    /// `Break` if the visitor ended the search.
    fn for_each_pair_with(&self, other: &dyn Partition, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        self.each(&mut |key, bounds| {
            if flow.is_continue() {
                flow = other.overlapping(bounds, &mut |other| visit([key, other]));
            }
        });
        flow
    }

    /// Returns all pairs of a box of this partition and a box of `other` that overlap, sorted. The
    /// key of the box of this partition comes first. Exact. The process ends if there is not enough
    /// memory for them.
    fn pairs_with(&self, other: &dyn Partition) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        let _ = self.for_each_pair_with(other, &mut |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        });
        pairs.sort_unstable();
        pairs
    }

    /// Returns all pairs of a box of this partition and a box of `other` that overlap, as
    /// [`pairs_with`](Self::pairs_with) does. Ends early, without pairs, if the budget is
    /// spent.
    ///
    /// # Errors
    /// As for [`try_pairs`](Self::try_pairs).
    fn try_pairs_with(&self, other: &dyn Partition, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        let mut pairs = PairList::new(budget);
        let _ = self.for_each_pair_with(other, &mut |pair| pairs.push(pair));
        pairs.into_sorted()
    }
}

/// A box that a ray enters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayVisit {
    /// Key of the box.
    pub key: u32,
    /// Ray parameter at which the ray enters the box, in multiples of the ray's direction. It is
    /// zero if the ray starts inside.
    pub t: f64,
    /// Ray parameter up to which the search currently continues.
    pub reach: f64,
}

/// A partition whose boxes can be inserted, removed and moved.
pub trait Dynamic: Partition {
    /// Stores a box under a key, and returns the box that was there before. This also moves a box.
    ///
    /// Memory grows with the largest key ever used. Keys must be below 2^32 - 1.
    fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax>;

    /// Removes the box under a key and returns it, or returns `None` if there is none.
    fn remove(&mut self, key: u32) -> Option<MinMax>;

    /// Applies all moves, and writes to `changes` which pairs began to overlap and which ceased to.
    ///
    /// If there is not enough memory for the pairs, [`Changes::check_complete`] returns an error.
    ///
    /// The result does not depend on the order of moves of different keys. If a key is moved
    /// several times, its last move counts.
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

/// Records in `changes` which pairs begin and end if one box alone moves.
pub(super) fn record<P: Partition + ?Sized>(partition: &P, step: &Move, changes: &mut Changes) {
    let key = step.key;
    let from = partition.get(key);
    let overlaps = |one: &Option<MinMax>, other: &MinMax| one.as_ref().is_some_and(|one| one.overlaps(other));
    let mut look = |around: &MinMax, begins: bool, ends: bool| {
        let _ = partition.overlapping(around, &mut |other| {
            if other != key
                && let Some(bounds) = partition.get(other)
            {
                let (before, after) = (overlaps(&from, &bounds), overlaps(&step.to, &bounds));
                if before != after && if after { begins } else { ends } {
                    changes.note(key, other, after);
                }
            }
            ControlFlow::Continue(())
        });
    };
    match (&from, &step.to) {
        // The move is short: one search around both positions costs little more than a search
        // around one.
        (Some(from), Some(to)) if from.overlaps(to) => look(&from.merged(to), true, true),
        (from, to) => {
            from.iter().for_each(|from| look(from, false, true));
            to.iter().for_each(|to| look(to, true, false));
        }
    }
}

/// Returns the distance between neighboring boxes if they were spread evenly: the longest edge of
/// the bounds divided by the cube root of the number of boxes.
fn spacing(bounds: &MinMax, len: usize) -> f64 {
    let extent = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
    extent / (len as f64).cbrt().max(1.0)
}

/// Returns the nearest boxes, by searching cubes around the point that double in size until they
/// hold enough boxes.
fn nearest_in_cubes<P: Partition + ?Sized>(partition: &P, point: [f64; 3], count: usize) -> Vec<Neighbor> {
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
        // A box outside the cube is farther than the radius along some axis, even after rounding.
        if best.limit() < radius * radius || cube.encloses(&bounds) {
            return best.into_sorted();
        }
        radius = 2.0 * radius + f64::MIN_POSITIVE;
    }
}

/// Follows the ray in steps and searches the bounding box of each step. The number of steps is the
/// cube root of the number of boxes, which is their number along an edge if they are spread evenly.
/// A box is visited in the step in which the ray enters it.
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

/// Returns a box around the ray from `start` to `end`, enlarged by the error bound of a computed
/// entry point.
fn about(ray: &Ray, start: f64, end: f64) -> MinMax {
    let (origin, direction) = (ray.origin(), ray.direction());
    let place = |axis: usize, t: f64| origin[axis] + direction[axis] * t;
    let slack = |axis: usize| POSITION_ERROR * (origin[axis].abs() + direction[axis].abs() * end) + f64::MIN_POSITIVE;
    let low = [0, 1, 2].map(|axis| (place(axis, start).min(place(axis, end)) - slack(axis)).clamp(-LIMIT, LIMIT));
    let high = [0, 1, 2].map(|axis| (place(axis, start).max(place(axis, end)) + slack(axis)).clamp(-LIMIT, LIMIT));
    MinMax::from_ordered(low, high)
}
