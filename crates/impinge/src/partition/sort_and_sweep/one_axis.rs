//! Sort-and-sweep along one axis.

use std::ops::ControlFlow;

use super::super::{Cells, Dynamic, Holds, Items, PairVisitor, Partition, Visitor, Work};
use super::{Axis, Widest, reorder};
use crate::volume::{BoundingVolume, MinMax};

/// Boxes sorted by their beginnings along one axis.
///
/// One sweep finds all pairs: it compares each box with the boxes that begin before it ends. That
/// is fast if boxes lie apart along the axis. Boxes that overlap along the axis are compared,
/// however far apart they are along the others.
///
/// # Complexity
/// A change finds its position in O(log n) and shifts the boxes between the old and the new
/// position: few for boxes that move little, at most n. A query looks at the boxes that begin
/// between its own end and its beginning minus the maximum extent of all boxes. One long box
/// therefore slows down all queries.
///
/// ```
/// use impinge::partition::{Axis, Dynamic, Partition, SweepOneAxis};
/// use impinge::volume::MinMax;
///
/// let mut sweep = SweepOneAxis::along(Axis::X);
/// for key in 0..3 {
///     let x = f64::from(key);
///     sweep.insert(key, MinMax::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])?);
/// }
/// assert_eq!(sweep.pairs(), [[0, 1], [1, 2]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SweepOneAxis {
    axis: Axis,
    /// Boxes sorted by their beginnings, then by key.
    entries: Vec<Entry>,
    widest: Widest,
    items: Items,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    bounds: MinMax,
    key: u32,
}

impl SweepOneAxis {
    /// Returns an empty partition, whose boxes will be sorted along `axis`.
    #[must_use]
    pub fn along(axis: Axis) -> Self {
        Self { axis, ..Self::default() }
    }

    /// Returns the partition of these boxes, sorted along an axis. The key of a box is its index in
    /// `boxes`.
    ///
    /// # Complexity
    /// O(n log n).
    #[must_use]
    pub fn build(axis: Axis, boxes: &[MinMax]) -> Self {
        let mut sweep = Self::along(axis);
        for (key, bounds) in boxes.iter().enumerate() {
            sweep.items.insert(key as u32, *bounds);
            sweep.widest.include(bounds, axis.number());
            sweep.entries.push(Entry { bounds: *bounds, key: key as u32 });
        }
        sweep.entries.sort_unstable_by(|one, other| {
            begin(one, axis.number()).total_cmp(&begin(other, axis.number())).then(one.key.cmp(&other.key))
        });
        sweep
    }

    /// Returns the axis along which the boxes are sorted.
    #[must_use]
    pub fn axis(&self) -> Axis {
        self.axis
    }

    /// Returns the index of this entry, or the index at which to insert it.
    fn place(&self, entry: &Entry) -> usize {
        let axis = self.axis.number();
        self.entries.partition_point(|other| precedes(other, entry, axis))
    }

    fn age(&mut self) {
        if self.widest.aged(self.entries.len()) {
            self.entries.iter().for_each(|entry| self.widest.include(&entry.bounds, self.axis.number()));
        }
    }
}

/// Returns the coordinate at which a box begins. Adding zero turns -0 into +0.
#[inline]
fn begin(entry: &Entry, axis: usize) -> f64 {
    entry.bounds.min()[axis] + 0.0
}

fn precedes(one: &Entry, other: &Entry, axis: usize) -> bool {
    let (begins, other_begins) = (begin(one, axis), begin(other, axis));
    begins < other_begins || (begins == other_begins && one.key < other.key)
}

impl Holds for SweepOneAxis {
    fn items(&self) -> &Items {
        &self.items
    }
}

impl Partition for SweepOneAxis {
    fn cells(&self) -> Cells {
        Cells::Order
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let axis = self.axis.number();
        let before = self.widest.before(bounds.min()[axis]);
        let first = self.entries.partition_point(|entry| entry.bounds.min()[axis] < before);
        work.nodes += 1;
        for entry in &self.entries[first..] {
            if entry.bounds.min()[axis] > bounds.max()[axis] {
                break;
            }
            work.boxes += 1;
            if entry.bounds.overlaps(bounds) {
                visit(entry.key)?;
            }
        }
        ControlFlow::Continue(())
    }

    fn for_each_pair(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        let axis = self.axis.number();
        for (at, entry) in self.entries.iter().enumerate() {
            let end = entry.bounds.max()[axis];
            for other in self.entries[at + 1..].iter().take_while(|other| other.bounds.min()[axis] <= end) {
                if entry.bounds.overlaps(&other.bounds) {
                    visit([entry.key.min(other.key), entry.key.max(other.key)])?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl Dynamic for SweepOneAxis {
    fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
        let axis = self.axis.number();
        let before = self.items.insert(key, bounds);
        self.widest.include(&bounds, axis);
        let entry = Entry { bounds, key };
        match before {
            Some(before) => {
                let from = self.place(&Entry { bounds: before, key });
                reorder(&mut self.entries, from, entry, |one, other| precedes(one, other, axis));
                self.age();
            }
            None => self.entries.insert(self.place(&entry), entry),
        }
        before
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        let before = self.items.remove(key)?;
        self.entries.remove(self.place(&Entry { bounds: before, key }));
        self.age();
        Some(before)
    }
}
