//! A grid for boxes of all sizes: a hashed one for each size.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use super::super::{Cells, Changes, Dynamic, Holds, Items, Move, Partition, Visitor, Work};
use super::batched_step::{self, BatchedMoves};
use super::cell_visits::CellVisits;
use super::level::Level;
use super::move_batch::MoveBatch;
use super::single::judge_cell;
use crate::input::InputError;
use crate::volume::MinMax;

/// Edges of the least cells are between these: all boxes are less than so many times as large as cells that no product
/// overflows, and a float of the least size still has an inverse.
const EDGES: [f64; 2] = [f64::from_bits((1023 - 600) << 52), f64::from_bits((1023 + 1020) << 52)];

/// Levels are so many powers of two apart: each box is looked for in every level that holds one, and in larger cells are
/// more boxes that it misses.
const STEP: i32 = 2;

/// Hashed grids, one for each fourfold size of boxes, each box in the first one whose cells are as large as it is: the kind for
/// boxes of unlike sizes that come, go and move.
///
/// A box has eight copies or so at most, mostly two or four. Nothing is large: however the sizes are spread, a box touches no more
/// cells, and only levels that hold boxes are looked at. Boxes smaller than the least cells, and points, share these.
///
/// # Complexity
/// A change O(1); a question O(levels in use + boxes in the same cells). One that is much larger than the cells of a level
/// looks at all that it covers, or at all boxes of that level if these are fewer: where large boxes among many small ones
/// are asked about often, a [`BoxTree`](super::super::BoxTree) is the better kind.
///
/// # Source
/// Ericson, 7.2 (hierarchical grids); Eitz, Gu, *Hierarchical spatial hashing for real-time collision detection*, SMI 2007.
/// Ours departs in that boxes are in all cells of their level that they reach into, so that a question looks at its own
/// cells alone, in that levels come and go with what they hold, and in that each has its own table.
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
    /// The edge of the least cells.
    least: f64,
    /// By how many levels of larger cells could be below them.
    levels: BTreeMap<i32, Level>,
    items: Items,
}

/// Of two.
fn power(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

impl HierarchicalGrid {
    /// A grid of nothing, whose least cells have edges of `cell`: a little more than most boxes have, or than the smallest of which
    /// there are many.
    ///
    /// # Errors
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite) and [`Negative`](crate::input::InputErrorKind::Negative) for a
    /// `"cell size"` that is not above zero.
    pub fn new(cell: f64) -> Result<Self, InputError> {
        judge_cell(cell)?;
        Ok(Self::with_cell(cell))
    }

    /// As [`new`](Self::new), for a number above zero.
    pub(crate) fn with_cell(cell: f64) -> Self {
        Self { least: cell.clamp(EDGES[0], EDGES[1]), levels: BTreeMap::new(), items: Items::default() }
    }

    /// The edge of the least cells.
    pub(crate) fn cell(&self) -> f64 {
        self.least
    }

    /// The level of a box: the first whose cells are at least as large as the next power of two above its longest edge, in least cells.
    fn level_of(&self, bounds: &MinMax) -> i32 {
        let edge = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max) / self.least;
        if edge <= 1.0 {
            return 0;
        }
        let above = (edge.to_bits() >> 52) as i32 - 1022;
        (above + STEP - 1) / STEP
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
        let level = self.levels.entry(at).or_insert_with(|| Level::hashed(self.least * power(STEP * at)));
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
