//! Sort-and-sweep along all three axes, with the pairs kept.
//!
//! Source: Cohen, Lin, Manocha, Ponamgi, *I-COLLIDE*, I3D 1995, 4; Terdiman, *Sweep-and-prune*,
//! 2007. Ours departs in two ways: an end finds its place by bisection and passes all ends between
//! at once, and ends do not store their positions.

use std::ops::ControlFlow;

use super::super::{Cells, Changes, Dynamic, Holds, Items, Move, PairVisitor, Partition, Visitor, Work};
use super::{Widest, reorder};
use crate::volume::{BoundingVolume, MinMax};

/// The ends of boxes, sorted along each axis, and the overlapping pairs, kept up to date. A pair
/// begins or ends when ends pass each other, so a step looks at nothing else.
///
/// Steps of this kind cost least if most boxes rest and few pairs change, provided that the ends
/// lie apart. If many boxes stand on one plane, every small move passes many ends along its normal.
///
/// # Complexity
/// A move takes O(log n + number of ends passed on the three axes) and shifts the ends it passes by
/// one place. Inserting or removing a box shifts up to all ends. Each pair is stored for both of
/// its boxes, in 8 bytes.
///
/// ```
/// use impinge::partition::{Changes, Dynamic, Move, Partition, SweepThreeAxes};
/// use impinge::volume::MinMax;
///
/// let cube = |x: f64| MinMax::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
/// let mut sweep = SweepThreeAxes::build(&[cube(0.0)?, cube(3.0)?]);
/// let mut changes = Changes::default();
/// sweep.step(&[Move { key: 1, to: Some(cube(1.0)?) }], &mut changes);
/// assert_eq!(changes.began(), [[0, 1]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SweepThreeAxes {
    /// Ends of all boxes by axis, sorted.
    ends: [Vec<End>; 3],
    widest: [Widest; 3],
    items: Items,
    /// Keys of the boxes that overlap the box of each key, sorted.
    partners: Vec<Vec<u32>>,
}

/// The beginning or the end of a box along an axis.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Coordinate. It is never -0, so that equal coordinates compare equal in the sort order.
    place: f64,
    key: u32,
    /// `true` if the box ends here. Beginnings precede ends at the same coordinate, because boxes
    /// that touch overlap.
    is_last: bool,
}

impl End {
    fn of(bounds: &MinMax, axis: usize, key: u32, is_last: bool) -> Self {
        let place = if is_last { bounds.max() } else { bounds.min() }[axis] + 0.0;
        Self { place, key, is_last }
    }

    fn precedes(&self, other: &Self) -> bool {
        self.place < other.place || (self.place == other.place && (self.is_last, self.key) < (other.is_last, other.key))
    }
}

impl SweepThreeAxes {
    /// Returns an empty partition.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the partition of these boxes. The key of a box is its index in `boxes`.
    ///
    /// # Complexity
    /// O(n log n), and one search per box along the axis on which the fewest ends are in range.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        let mut sweep = Self::new();
        for (key, bounds) in boxes.iter().enumerate() {
            let key = key as u32;
            sweep.items.insert(key, *bounds);
            for axis in 0..3 {
                sweep.ends[axis].extend([false, true].map(|is_last| End::of(bounds, axis, key, is_last)));
                sweep.widest[axis].include(bounds, axis);
            }
        }
        for ends in &mut sweep.ends {
            let rank = |end: &End| (end.is_last, end.key);
            ends.sort_unstable_by(|one, other| one.place.total_cmp(&other.place).then(rank(one).cmp(&rank(other))));
        }
        sweep.partners.resize(boxes.len(), Vec::new());
        for (key, bounds) in boxes.iter().enumerate() {
            let mut partners = Vec::new();
            let _ = sweep.overlapping(bounds, &mut |other| {
                if other != key as u32 {
                    partners.push(other);
                }
                ControlFlow::Continue(())
            });
            partners.sort_unstable();
            sweep.partners[key] = partners;
        }
        sweep
    }

    /// Stores (`overlap` is `true`) or deletes a pair. Returns `true` if that changed anything.
    fn pair(&mut self, key: u32, other: u32, overlap: bool) -> bool {
        let mut changed = false;
        for (key, other) in [(key, other), (other, key)] {
            let partners = &mut self.partners[key as usize];
            match (partners.binary_search(&other), overlap) {
                (Err(at), true) => {
                    partners.insert(at, other);
                    changed = true;
                }
                (Ok(at), false) => {
                    partners.remove(at);
                    changed = true;
                }
                _ => {}
            }
        }
        changed
    }

    /// Moves the ends of a box to their new places, and updates its pairs. Calls `note` for each
    /// pair that began or ended.
    fn relocate(&mut self, key: u32, from: &MinMax, to: &MinMax, note: &mut dyn FnMut(u32, u32, bool)) {
        for axis in 0..3 {
            self.widest[axis].include(to, axis);
            for is_last in [false, true] {
                let (old, new) = (End::of(from, axis, key, is_last), End::of(to, axis, key, is_last));
                let ends = &mut self.ends[axis];
                let before = ends.partition_point(|end| end.precedes(&old));
                let after = reorder(ends, before, new, End::precedes);
                // Beginning later than another box ends, or ending before it begins, separates the
                // two.
                let ascends = after > before;
                let parts = ascends != is_last;
                let (low, high) = if ascends { (before, after) } else { (after + 1, before + 1) };
                for at in low..high {
                    let passed = self.ends[axis][at];
                    if passed.is_last == is_last || passed.key == key {
                        continue;
                    }
                    let overlap = !parts && self.items.get(passed.key).is_some_and(|bounds| bounds.overlaps(to));
                    if (overlap || parts) && self.pair(key, passed.key, overlap) {
                        note(key, passed.key, overlap);
                    }
                }
            }
        }
        self.age();
    }

    fn age(&mut self) {
        for axis in 0..3 {
            if self.widest[axis].aged(self.items.len()) {
                self.items.iter().for_each(|(_, bounds)| self.widest[axis].include(bounds, axis));
            }
        }
    }

    fn change(&mut self, key: u32, to: Option<MinMax>, note: &mut dyn FnMut(u32, u32, bool)) -> Option<MinMax> {
        let from = self.items.get(key).copied();
        match (from, to) {
            (Some(from), Some(to)) => {
                self.items.insert(key, to);
                self.relocate(key, &from, &to, note);
            }
            (None, Some(to)) => self.insert_new(key, &to, note),
            (Some(from), None) => self.remove_held(key, &from, note),
            (None, None) => {}
        }
        from
    }

    fn insert_new(&mut self, key: u32, to: &MinMax, note: &mut dyn FnMut(u32, u32, bool)) {
        if key as usize >= self.partners.len() {
            self.partners.resize(key as usize + 1, Vec::new());
        }
        let mut found = Vec::new();
        let _ = self.overlapping(to, &mut |other| {
            found.push(other);
            ControlFlow::Continue(())
        });
        for other in found {
            self.pair(key, other, true);
            note(key, other, true);
        }
        self.items.insert(key, *to);
        for axis in 0..3 {
            self.widest[axis].include(to, axis);
            for is_last in [false, true] {
                let end = End::of(to, axis, key, is_last);
                let ends = &mut self.ends[axis];
                ends.insert(ends.partition_point(|other| other.precedes(&end)), end);
            }
        }
    }

    fn remove_held(&mut self, key: u32, from: &MinMax, note: &mut dyn FnMut(u32, u32, bool)) {
        for other in self.partners[key as usize].clone() {
            self.pair(key, other, false);
            note(key, other, false);
        }
        for axis in 0..3 {
            for is_last in [false, true] {
                let end = End::of(from, axis, key, is_last);
                let ends = &mut self.ends[axis];
                ends.remove(ends.partition_point(|other| other.precedes(&end)));
            }
        }
        self.items.remove(key);
        self.age();
    }
}

impl Holds for SweepThreeAxes {
    fn items(&self) -> &Items {
        &self.items
    }
}

impl Partition for SweepThreeAxes {
    fn cells(&self) -> Cells {
        Cells::Order
    }

    /// Searches along the axis on which the fewest ends are in range.
    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let range = |axis: usize| {
            let (ends, before) = (&self.ends[axis], self.widest[axis].before(bounds.min()[axis]));
            let first = ends.partition_point(|end| end.place < before);
            &ends[first..first + ends[first..].partition_point(|end| end.place <= bounds.max()[axis])]
        };
        work.nodes += 1;
        let [x, y, z] = [range(0), range(1), range(2)];
        let shorter = if y.len() < x.len() { y } else { x };
        let shortest = if z.len() < shorter.len() { z } else { shorter };
        for end in shortest.iter().filter(|end| !end.is_last) {
            work.boxes += 1;
            if self.items.get(end.key).is_some_and(|other| other.overlaps(bounds)) {
                visit(end.key)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns the stored pairs; nothing is compared.
    fn for_each_pair(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        (0..).zip(&self.partners).try_for_each(|(key, partners)| {
            let above = &partners[partners.partition_point(|&other| other < key)..];
            above.iter().try_for_each(|&other| visit([key, other]))
        })
    }
}

impl Dynamic for SweepThreeAxes {
    fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
        self.change(key, Some(bounds), &mut |_, _, _| {})
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        self.change(key, None, &mut |_, _, _| {})
    }

    /// Records the changes while ends of boxes pass each other.
    fn step(&mut self, moves: &[Move], changes: &mut Changes) {
        changes.clear();
        for step in moves {
            self.change(step.key, step.to, &mut |key, other, overlap| changes.note(key, other, overlap));
        }
        changes.settle();
    }
}
