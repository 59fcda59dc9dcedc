//! Grids of cells of one size.

use std::ops::ControlFlow;

use super::super::{BoxTree, Cells, Changes, Dynamic, Holds, Items, Move, Partition, Visitor, Work, record};
use super::level::{Level, Places};
use crate::input::{InputError, InputErrorKind};
use crate::volume::{BoundingVolume, MinMax};

/// Cells that a box reaches into at most; larger ones are kept in a tree beside the cells, so that no box touches cells
/// without bound.
const MOST_CELLS: f64 = 27.0;

/// Moves from the one whose memory is asked for to the one that is done: some hundred nanoseconds, as memory takes.
const AHEAD: usize = 4;

/// Cells of a uniform grid at most: 384 MiB of them.
const MOST_DENSE: f64 = (1 << 24) as f64;

/// Equal cells in a block, one after the other in memory: the kind for boxes of like size that fill a known space evenly.
///
/// A box is in each cell that it reaches into, at most 27; larger ones are in a tree beside them. What lies outside the
/// block belongs to the cells at its border: nothing is lost, but many boxes there are many in one cell.
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
        self.level.reach(bounds).count() > MOST_CELLS
    }

    fn overlapping(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        self.large.overlapping_counted(bounds, work, visit)?;
        self.level.overlapping(bounds, work, visit)
    }

    fn pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = self.large.pairs();
        self.level.pairs(|one, other| pairs.push([one.min(other), one.max(other)]));
        self.large.each(&mut |key, bounds| {
            let _ = self.level.overlapping(bounds, &mut Work::default(), &mut |other| {
                pairs.push([key.min(other), key.max(other)]);
                ControlFlow::Continue(())
            });
        });
        pairs.sort_unstable();
        pairs
    }

    fn insert(&mut self, key: u32, to: MinMax) -> Option<MinMax> {
        let from = self.items.insert(key, to);
        match (&from, self.is_large(&to)) {
            (Some(from), false) if !self.is_large(from) => self.level.relocate(key, from, &to),
            (Some(from), true) if self.is_large(from) => _ = self.large.insert(key, to),
            (from, is_large) => {
                from.iter().for_each(|from| self.take(key, from));
                if is_large {
                    self.large.insert(key, to);
                } else {
                    self.level.insert(key, &to);
                }
            }
        }
        from
    }

    /// Moves a box within the cells, and notes what that changes; whether this is all.
    fn follow(&mut self, step: &Move, changes: &mut Changes) -> bool {
        let (Some(from), Some(to)) = (self.items.get(step.key).copied(), step.to) else { return false };
        if !self.large.is_empty() || self.is_large(&to) {
            return false;
        }
        let followed = self.level.follow(step.key, &from, &to, |other, began| changes.note(step.key, other, began));
        if followed {
            self.items.insert(step.key, to);
        }
        followed
    }

    fn take(&mut self, key: u32, from: &MinMax) {
        if self.large.remove(key).is_none() {
            self.level.remove(key, from);
        }
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        let from = self.items.remove(key)?;
        self.take(key, &from);
        Some(from)
    }
}

/// The two kinds differ in where their cells are, and in nothing else.
macro_rules! is_single_level {
    ($grid:ident) => {
        impl Holds for $grid {
            fn items(&self) -> &Items {
                &self.0.items
            }
        }

        impl Partition for $grid {
            fn cells(&self) -> Cells {
                Cells::Disjoint
            }

            fn overlapping_counted(
                &self,
                bounds: &MinMax,
                work: &mut Work,
                visit: &mut Visitor<'_>,
            ) -> ControlFlow<()> {
                match self.0.items.bounds() {
                    Some(all) if all.overlaps(bounds) => self.0.overlapping(bounds, work, visit),
                    _ => ControlFlow::Continue(()),
                }
            }

            fn pairs(&self) -> Vec<[u32; 2]> {
                self.0.pairs()
            }
        }

        impl Dynamic for $grid {
            fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
                self.0.insert(key, bounds)
            }

            fn remove(&mut self, key: u32) -> Option<MinMax> {
                self.0.remove(key)
            }

            /// Asks for the memory of the next moves while it does one: in a large scene they are all over it.
            fn step(&mut self, moves: &[Move], changes: &mut Changes) {
                changes.clear();
                // Where the cells of the next moves are.
                let mut places = [Places::default(); AHEAD];
                for (at, step) in moves.iter().enumerate() {
                    let later = |ahead: usize| moves.get(at + ahead).map(|later| later.key);
                    later(3 * AHEAD).into_iter().for_each(|key| self.0.items.prefetch(key));
                    let places = &mut places[at % AHEAD];
                    self.0.level.prefetch_held(places);
                    *places = Places::default();
                    if let Some(bounds) = later(2 * AHEAD).and_then(|key| self.0.items.get(key)) {
                        self.0.level.prefetch(bounds, places);
                    }
                    if !self.0.follow(step, changes) {
                        record(self, step, changes);
                        match step.to {
                            Some(bounds) => self.0.insert(step.key, bounds),
                            None => self.0.remove(step.key),
                        };
                    }
                }
                changes.settle();
            }
        }
    };
}

is_single_level!(UniformGrid);
is_single_level!(HashedGrid);
