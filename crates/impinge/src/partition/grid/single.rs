//! Grids of cells of one size: dense (`UniformGrid`) and hashed (`HashedGrid`).

use std::ops::ControlFlow;

use super::super::{
    BoxTree, Cells, Changes, Dynamic, Holds, Items, Move, PairVisitor, Partition, Visitor, Work, forward_to_inner,
};
use super::batched_step::{self, BatchedMoves};
use super::cell_visits::{CellVisits, MAX_PATH_CELLS};
use super::level::Level;
use super::move_batch::MoveBatch;
use crate::input::{InputError, InputErrorKind};
use crate::volume::{BoundingVolume, MinMax};

/// Maximum number of cells that a box may reach into. Larger boxes, and boxes that reach into more
/// than eight cells along an axis, are kept in a tree beside the cells, so that no box touches an
/// unbounded number of cells.
const MAX_CELLS: f64 = 27.0;

/// The boxes of a path that is processed in a batch are all in cells.
const _: () = assert!(MAX_PATH_CELLS as f64 <= MAX_CELLS);

/// Maximum number of cells of a uniform grid. This number of cells takes 1 GiB.
const MAX_DENSE_CELLS: f64 = (1 << 24) as f64;

/// A block of equal cells, contiguous in memory. Use it for boxes of similar size that fill a known
/// region evenly.
///
/// A box is stored in each cell that it reaches into, at most 27 cells and eight along an axis.
/// Larger boxes are kept in a tree beside the cells. The space outside the block belongs to the
/// cells at its border. Results stay exact, but many boxes outside crowd into few cells, which
/// slows queries.
///
/// # Complexity
/// O(1 + boxes in the same cells) for each change and query, if cells are about as large as boxes.
/// Every cell takes memory, full or empty.
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

/// Equal cells in all of space; a hash finds the cells that hold boxes. Use it for boxes of similar
/// size anywhere.
///
/// It works like [`UniformGrid`], but memory grows with the number of boxes instead of cells. Cells
/// that share a place in memory cost extra comparisons but change no result. Cells are
/// distinguished up to a distance of 2^40 cells from the origin.
///
/// # Source
/// Teschner et al., *Optimized spatial hashing for collision detection of deformable objects*, VMV
/// 2003.
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

/// Validates the edge length of cells: it must be finite and above zero.
pub(super) fn validate_cell(cell: f64) -> Result<(), InputError> {
    match cell {
        x if !x.is_finite() => Err(InputError::new(InputErrorKind::NonFinite { what: "cell size", index: 0 })),
        x if x <= 0.0 => Err(InputError::new(InputErrorKind::Negative { what: "cell size", index: 0 })
            .with_hint("pass a cell size greater than zero")),
        _ => Ok(()),
    }
}

impl UniformGrid {
    /// Returns an empty grid over `bounds` whose cells have edges of length `cell`, in the unit of
    /// the boxes.
    ///
    /// # Errors
    /// Returns [`NonFinite`](InputErrorKind::NonFinite) or [`Negative`](InputErrorKind::Negative)
    /// if the `"cell size"` is not finite or not above zero. Returns
    /// [`OutOfRange`](InputErrorKind::OutOfRange) for the `"grid"` if it would have more than 2^24
    /// cells.
    pub fn over(bounds: &MinMax, cell: f64) -> Result<Self, InputError> {
        validate_cell(cell)?;
        let (min, max) = (bounds.min(), bounds.max());
        let counts = [0, 1, 2].map(|axis| ((max[axis] - min[axis]) / cell).ceil().max(1.0));
        if counts.iter().product::<f64>() > MAX_DENSE_CELLS {
            let limit = "2^24 cells";
            return Err(InputError::new(InputErrorKind::OutOfRange { what: "grid", index: 0, limit })
                .with_hint("the cell size is too small: pass a larger one, or use a HashedGrid"));
        }
        Ok(Self(Single::new(Level::dense(min, cell, counts.map(|count| count as usize)))))
    }
}

impl HashedGrid {
    /// Returns an empty grid whose cells have edges of length `cell`, in the unit of the boxes.
    /// About twice the edge length of the boxes is a good choice.
    ///
    /// # Errors
    /// Returns [`NonFinite`](InputErrorKind::NonFinite) or [`Negative`](InputErrorKind::Negative)
    /// if the `"cell size"` is not finite or not above zero.
    pub fn new(cell: f64) -> Result<Self, InputError> {
        validate_cell(cell)?;
        Ok(Self(Single::new(Level::hashed(cell))))
    }
}

impl Single {
    fn new(level: Level) -> Self {
        Self { level, large: BoxTree::new(), items: Items::default() }
    }

    fn is_large(&self, bounds: &MinMax) -> bool {
        !self.level.takes(bounds, MAX_CELLS)
    }

    /// Records which pairs with large boxes a path changes.
    fn follow_among_large(&self, key: u32, [from, to]: &[MinMax; 2], changes: &mut Changes) {
        let _ = self.large.overlapping(&from.merged(to), &mut |other| {
            if let Some(bounds) = self.items.get(other) {
                let overlaps = to.overlaps(bounds);
                if from.overlaps(bounds) != overlaps {
                    changes.note(key, other, overlaps);
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

    fn for_each_pair(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        self.large.for_each_pair(visit)?;
        self.level.for_each_pair(&self.items, |one, other| visit([one.min(other), one.max(other)]))?;
        let mut flow = ControlFlow::Continue(());
        self.large.each(&mut |key, bounds| {
            if flow.is_continue() {
                flow = self.level.overlapping(&self.items, bounds, &mut Work::default(), &mut |other| {
                    visit([key.min(other), key.max(other)])
                });
            }
        });
        flow
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
