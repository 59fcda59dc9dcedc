//! Grids of cells of one size.

use std::ops::ControlFlow;

use super::super::{BoxTree, Cells, Changes, Dynamic, Holds, Items, Move, Partition, Visitor, Work, forward_to_inner};
use super::batched_step::{self, BatchedMoves};
use super::cell_visits::{CellVisits, SHORT};
use super::level::Level;
use super::move_batch::MoveBatch;
use crate::input::{InputError, InputErrorKind};
use crate::volume::{BoundingVolume, MinMax};

/// Cells that a box reaches into at most; larger ones, and those that reach into more than eight along an axis, are kept in a
/// tree beside the cells, so that no box touches cells without bound.
const MOST_CELLS: f64 = 27.0;

/// A short path is all in cells.
const _: () = assert!(SHORT as f64 <= MOST_CELLS);

/// Cells of a uniform grid at most: a GiB of them, where they are full.
const MOST_DENSE: f64 = (1 << 24) as f64;

/// Equal cells in a block, one after the other in memory: the kind for boxes of like size that fill a known space evenly.
///
/// A box is in each cell that it reaches into, at most 27 and eight along an axis; larger ones are in a tree beside them. What
/// lies outside the block belongs to the cells at its border: nothing is lost, but many boxes there are many in one cell.
///
/// # Complexity
/// O(1 + boxes in the same cells) for each change and question, where cells are about as large as boxes. Memory for each
/// cell, full or not.
///
/// ```
/// use impinge::partition::{Dynamic, Partition, UniformGrid};
/// use impinge::volume::MinMax;
///
/// let mut grid = UniformGrid::over(&MinMax::new([0.0; 3], [10.0; 3])?, 1.0)?;
/// grid.insert(0, MinMax::new([0.5; 3], [1.5; 3])?);
/// grid.insert(1, MinMax::new([-7.0; 3], [90.0; 3])?); // larger than the grid
/// assert_eq!(grid.pairs(), [[0, 1]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct UniformGrid(Single);

/// Equal cells without an end, of which those that hold something are found by a hash: the kind for boxes of like size
/// anywhere.
///
/// As [`UniformGrid`], with memory for boxes instead of cells. Cells that share a place in memory cost comparisons and change
/// no answer. Cells are told apart as far as 2^40 of them from the origin.
///
/// # Source
/// Teschner et al., *Optimized spatial hashing for collision detection of deformable objects*, VMV 2003.
///
/// ```
/// use impinge::partition::{Dynamic, HashedGrid, Partition};
/// use impinge::volume::MinMax;
///
/// let mut grid = HashedGrid::new(2.0)?;
/// for key in 0..3 {
///     let x = 1e6 + f64::from(key);
///     grid.insert(key, MinMax::new([x; 3], [x + 1.0; 3])?);
/// }
/// assert_eq!(grid.pairs(), [[0, 1], [1, 2]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct HashedGrid(Single);

#[derive(Clone, Debug)]
struct Single {
    level: Level,
    large: BoxTree,
    items: Items,
}

/// Whether cells can have this edge.
pub(super) fn judge_cell(cell: f64) -> Result<(), InputError> {
    match cell {
        x if !x.is_finite() => Err(InputError::new(InputErrorKind::NonFinite { what: "cell size", index: 0 })),
        x if x <= 0.0 => Err(InputError::new(InputErrorKind::Negative { what: "cell size", index: 0 })
            .with_hint("a cell has to have a size above zero")),
        _ => Ok(()),
    }
}

impl UniformGrid {
    /// Cells with edges of `cell` over `bounds`, and none in them.
    ///
    /// # Errors
    /// [`NonFinite`](InputErrorKind::NonFinite) and [`Negative`](InputErrorKind::Negative) for a `"cell size"` that is not
    /// above zero; [`OutOfRange`](InputErrorKind::OutOfRange) for one that makes more than 2^24 cells.
    pub fn over(bounds: &MinMax, cell: f64) -> Result<Self, InputError> {
        judge_cell(cell)?;
        let (min, max) = (bounds.min(), bounds.max());
        let counts = [0, 1, 2].map(|axis| ((max[axis] - min[axis]) / cell).ceil().max(1.0));
        if counts.iter().product::<f64>() > MOST_DENSE {
            let limit = "what makes 2^24 cells";
            return Err(InputError::new(InputErrorKind::OutOfRange { what: "cell size", index: 0, limit })
                .with_hint("larger cells, or a hashed grid"));
        }
        Ok(Self(Single::new(Level::dense(min, cell, counts.map(|count| count as usize)))))
    }
}

impl HashedGrid {
    /// Cells with edges of `cell`; about twice the boxes' are a good choice.
    ///
    /// # Errors
    /// [`NonFinite`](InputErrorKind::NonFinite) and [`Negative`](InputErrorKind::Negative) for a `"cell size"` that is not
    /// above zero.
    pub fn new(cell: f64) -> Result<Self, InputError> {
        judge_cell(cell)?;
        Ok(Self(Single::new(Level::hashed(cell))))
    }
}

impl Single {
    fn new(level: Level) -> Self {
        Self { level, large: BoxTree::new(), items: Items::default() }
    }

    fn is_large(&self, bounds: &MinMax) -> bool {
        !self.level.takes(bounds, MOST_CELLS)
    }

    /// Notes which pairs with large boxes a path changes.
    fn follow_among_large(&self, key: u32, [from, to]: &[MinMax; 2], changes: &mut Changes) {
        let _ = self.large.overlapping(&from.merged(to), &mut |other| {
            if let Some(bounds) = self.items.get(other) {
                let meets = to.overlaps(bounds);
                if from.overlaps(bounds) != meets {
                    changes.note(key, other, meets);
                }
            }
            ControlFlow::Continue(())
        });
    }

    fn take(&mut self, key: u32, from: &MinMax) {
        if self.large.remove(key).is_none() {
            self.level.remove(&self.items, key, from);
        }
    }
}

impl Holds for Single {
    fn items(&self) -> &Items {
        &self.items
    }
}

impl Partition for Single {
    fn cells(&self) -> Cells {
        Cells::Disjoint
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        if !self.items.bounds().is_some_and(|all| all.overlaps(bounds)) {
            return ControlFlow::Continue(());
        }
        self.large.overlapping_counted(bounds, work, visit)?;
        self.level.overlapping(&self.items, bounds, work, visit)
    }

    fn pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = self.large.pairs();
        self.level.pairs(&self.items, |one, other| pairs.push([one.min(other), one.max(other)]));
        self.large.each(&mut |key, bounds| {
            let _ = self.level.overlapping(&self.items, bounds, &mut Work::default(), &mut |other| {
                pairs.push([key.min(other), key.max(other)]);
                ControlFlow::Continue(())
            });
        });
        pairs.sort_unstable();
        pairs
    }
}

impl Dynamic for Single {
    fn insert(&mut self, key: u32, to: MinMax) -> Option<MinMax> {
        let from = self.items.insert(key, to);
        match (&from, self.is_large(&to)) {
            (Some(from), false) if !self.is_large(from) => self.level.relocate(&self.items, key, from, &to),
            (Some(from), true) if self.is_large(from) => _ = self.large.insert(key, to),
            (from, is_large) => {
                from.iter().for_each(|from| self.take(key, from));
                if is_large {
                    self.large.insert(key, to);
                } else {
                    self.level.insert(&self.items, key, &to);
                }
            }
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

impl BatchedMoves for Single {
    fn levels(&self) -> usize {
        1
    }

    #[inline(always)]
    fn note_path(&self, mover: usize, path: &[MinMax; 2], visits: &mut [CellVisits]) -> bool {
        visits[0].note_path(&self.level, mover, path, true)
    }

    fn apply_batch(&mut self, batch: &MoveBatch, visits: &mut [CellVisits], changes: &mut Changes) {
        let Self { level, large, items } = self;
        visits[0].apply(level, items, batch, changes);
        for (key, [_, to]) in batch.iter() {
            items.replace(key, *to);
        }
        level.resize(items);
        if !large.is_empty() {
            batch.iter().for_each(|(key, path)| self.follow_among_large(key, path, changes));
        }
    }
}

forward_to_inner!(UniformGrid);
forward_to_inner!(HashedGrid);
