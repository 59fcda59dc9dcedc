//! A grid for boxes of all sizes: a hashed one for each size.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use super::super::{Cells, Dynamic, Holds, Items, Partition, Visitor, Work};
use super::level::Level;
use super::single::judge_cell;
use crate::input::InputError;
use crate::volume::MinMax;

/// Cells have edges between these powers of two: twice the largest box is less, and a float of the least size still has an
/// inverse.
const EXPONENTS: [i32; 2] = [-1020, 1020];

/// Levels are so many powers of two apart: each box is looked for in every level that holds one, and in larger cells are
/// more boxes that it misses.
const STEP: i32 = 2;

/// Hashed grids, one for each fourfold size of boxes, each box in the one whose cells are two to eight times as large as it
/// is: the kind for boxes of unlike sizes that come, go and move.
///
/// A box has at most eight copies, mostly one or two. Nothing is large: however the sizes are spread, a box touches no more
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
    /// The exponent of the least cells.
    least: i32,
    /// By the exponent of their cells.
    levels: BTreeMap<i32, Level>,
    items: Items,
}

fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}

fn cell(level: i32) -> f64 {
    f64::from_bits(((1023 + level) as u64) << 52)
}

impl HierarchicalGrid {
    /// A grid of nothing, whose least cells have edges of `cell`, rounded down to a power of two: about twice the size of the
    /// smallest boxes of which there are many.
    ///
    /// # Errors
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite) and [`Negative`](crate::input::InputErrorKind::Negative) for a
    /// `"cell size"` that is not above zero.
    pub fn new(cell: f64) -> Result<Self, InputError> {
        judge_cell(cell)?;
        let least = exponent(cell).clamp(EXPONENTS[0], EXPONENTS[1]);
        Ok(Self { least, levels: BTreeMap::new(), items: Items::default() })
    }

    /// The exponent of the cells of a box: of a power of two that is at least twice its longest edge.
    fn level_of(&self, bounds: &MinMax) -> i32 {
        let size = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
        let above = (exponent(size) + 2 - self.least).max(0);
        self.least + (above + STEP - 1) / STEP * STEP
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
        match &from {
            Some(from) if self.level_of(from) == at => {
                self.levels.entry(at).or_insert_with(|| Level::hashed(cell(at))).relocate(&self.items, key, from, &to);
            }
            from => {
                from.iter().for_each(|from| self.take(key, from));
                self.levels.entry(at).or_insert_with(|| Level::hashed(cell(at))).insert(&self.items, key, &to);
            }
        }
        from
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        let from = self.items.remove(key)?;
        self.take(key, &from);
        Some(from)
    }
}
