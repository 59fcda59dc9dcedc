//! A grid for boxes of all sizes: one hashed grid per range of sizes.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use super::super::{Cells, Changes, Dynamic, Holds, Items, Move, Partition, Visitor, Work};
use super::batched_step::{self, BatchedMoves};
use super::cell_visits::CellVisits;
use super::level::Level;
use super::move_batch::MoveBatch;
use super::single::validate_cell;
use crate::input::InputError;
use crate::volume::MinMax;

/// Minimum and maximum edge length of the smallest cells. With at least 2^-600, the ratio of any
/// box to these cells overflows no product; at most 2^1020 still has a reciprocal.
const EDGE_RANGE: [f64; 2] = [f64::from_bits((1023 - 600) << 52), f64::from_bits((1023 + 1020) << 52)];

/// Binary logarithm of the ratio between the cell sizes of successive levels. If it is smaller, a
/// query visits more levels; if it is larger, more boxes in the larger cells are compared although
/// they are apart.
const LEVEL_STEP: i32 = 2;

/// Hashed grids, one for each range of sizes that spans a factor of four. A box is in the first
/// grid whose cells are as large as the box. Use it for boxes of different sizes that are inserted,
/// removed and moved.
///
/// A box has at most about eight copies, usually two or four, however the sizes are spread. Only
/// levels that hold boxes are visited. Points, and boxes smaller than the smallest cells, share the
/// finest level.
///
/// # Complexity
/// A change takes O(1), a query O(levels in use + boxes in the same cells). A query much larger
/// than the cells of a level visits all cells that it covers, or all boxes of the level if they are
/// fewer. If you often query large boxes among many small ones, a
/// [`BoxTree`](super::super::BoxTree) is faster.
///
/// # Source
/// Ericson, 7.2 (hierarchical grids); Eitz, Gu, *Hierarchical spatial hashing for real-time
/// collision detection*, SMI 2007. Ours departs in three ways: a box is in every cell of its level
/// that it reaches into, so that a query visits only its own cells; levels exist only while they
/// hold boxes; and each level has its own table.
///
/// ```
/// use impinge::partition::{Dynamic, HierarchicalGrid, Partition};
/// use impinge::volume::MinMax;
///
/// let mut grid = HierarchicalGrid::new(1e-6)?;
/// grid.insert(0, MinMax::new([0.0; 3], [1e-6; 3])?);
/// grid.insert(1, MinMax::new([-1e9; 3], [1e9; 3])?);
/// grid.insert(2, MinMax::new([1e-6; 3], [1.0; 3])?);
/// assert_eq!(grid.pairs(), [[0, 1], [0, 2], [1, 2]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct HierarchicalGrid {
    /// Edge length of the smallest cells.
    least: f64,
    /// Levels that hold boxes, by number. The cells of each level are four times as large as those
    /// of the level before.
    levels: BTreeMap<i32, Level>,
    items: Items,
}

/// Returns 2 to the power of `exponent`.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

impl HierarchicalGrid {
    /// Returns an empty grid whose smallest cells have edges of length `cell`, in the unit of the
    /// boxes. Choose it slightly larger than most boxes, or than the smallest size of which there
    /// are many boxes.
    ///
    /// # Errors
    /// Returns [`NonFinite`](crate::input::InputErrorKind::NonFinite) or
    /// [`Negative`](crate::input::InputErrorKind::Negative) if the `"cell size"` is not finite or
    /// not above zero.
    pub fn new(cell: f64) -> Result<Self, InputError> {
        validate_cell(cell)?;
        Ok(Self::with_cell(cell))
    }

    /// Like [`new`](Self::new), for a number above zero.
    pub(crate) fn with_cell(cell: f64) -> Self {
        Self { least: cell.clamp(EDGE_RANGE[0], EDGE_RANGE[1]), levels: BTreeMap::new(), items: Items::default() }
    }

    /// Returns the edge length of the smallest cells.
    pub(crate) fn cell(&self) -> f64 {
        self.least
    }

    /// Returns the level of a box: the first level whose cells are at least as large as the next
    /// power of two above the box's longest edge. Lengths are measured in smallest cells.
    fn level_of(&self, bounds: &MinMax) -> i32 {
        let edge = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max) / self.least;
        if edge <= 1.0 {
            return 0;
        }
        let above = (edge.to_bits() >> 52) as i32 - 1022;
        (above + LEVEL_STEP - 1) / LEVEL_STEP
    }

    fn take(&mut self, key: u32, from: &MinMax) {
        let at = self.level_of(from);
        if let Some(level) = self.levels.get_mut(&at) {
            level.remove(&self.items, key, from);
            if level.is_empty() {
                self.levels.remove(&at);
            }
        }
    }
}

impl Holds for HierarchicalGrid {
    fn items(&self) -> &Items {
        &self.items
    }
}

impl Partition for HierarchicalGrid {
    fn cells(&self) -> Cells {
        Cells::Disjoint
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        self.levels.values().try_for_each(|level| level.overlapping(&self.items, bounds, work, visit))
    }
}

impl Dynamic for HierarchicalGrid {
    fn insert(&mut self, key: u32, to: MinMax) -> Option<MinMax> {
        let from = self.items.insert(key, to);
        let at = self.level_of(&to);
        let is_moved = from.as_ref().is_some_and(|from| self.level_of(from) == at);
        if let Some(from) = from.as_ref().filter(|_| !is_moved) {
            self.take(key, from);
        }
        let level = self.levels.entry(at).or_insert_with(|| Level::hashed(self.least * power_of_two(LEVEL_STEP * at)));
        match &from {
            Some(from) if is_moved => level.relocate(&self.items, key, from, &to),
            _ => level.insert(&self.items, key, &to),
        }
        from
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        let from = self.items.remove(key)?;
        self.take(key, &from);
        Some(from)
    }

    fn step(&mut self, moves: &[Move], changes: &mut Changes) {
        batched_step::step(self, moves, changes);
    }
}

impl BatchedMoves for HierarchicalGrid {
    fn levels(&self) -> usize {
        self.levels.len()
    }

    #[inline(always)]
    fn note_path(&self, mover: usize, path: &[MinMax; 2], visits: &mut [CellVisits]) -> bool {
        let [from, to] = [self.level_of(&path[0]), self.level_of(&path[1])];
        if from != to {
            return false;
        }
        for ((&number, level), visits) in self.levels.iter().zip(visits) {
            if !visits.note_path(level, mover, path, number == from) {
                return false;
            }
        }
        true
    }

    fn apply_batch(&mut self, batch: &MoveBatch, visits: &mut [CellVisits], changes: &mut Changes) {
        let Self { levels, items, .. } = self;
        for (level, visits) in levels.values_mut().zip(visits) {
            visits.apply(level, items, batch, changes);
        }
        for (key, [_, to]) in batch.iter() {
            items.replace(key, *to);
        }
        levels.values_mut().for_each(|level| level.resize(items));
    }
}
