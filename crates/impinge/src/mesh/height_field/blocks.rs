//! The tree over the cells of a height field: square blocks of cells, with the least and the
//! greatest height of each.
//!
//! A block of the lowest level has 8 by 8 cells, and a block of each other level has 4 by 4 blocks
//! of the level below. The tree is implicit: a block is found by its row and column.

use std::ops::Range;

use crate::hierarchy::Child;

/// Binary logarithm of the number of cells along a side of a block of the lowest level. Smaller
/// blocks take more memory, larger blocks more comparisons of cells.
const LOWEST: u32 = 3;

/// Binary logarithm of the number of blocks along a side of the block above them.
const STEP: u32 = 2;

/// The levels of blocks, the one with a single block first. Blocks are numbered level by level, and
/// row by row in each.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    levels: Vec<Level>,
    /// Numbers of rows and columns of cells.
    cells: [u32; 2],
}

#[derive(Debug)]
struct Level {
    /// Binary logarithm of the number of cells along a side of a block.
    side: u32,
    columns: u32,
    /// Number of the first block.
    first: u32,
    /// Least and greatest height of each block. They are in the opposite order if all cells of the
    /// block are holes.
    spans: Vec<[f32; 2]>,
}

/// A square block of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Row and column among the blocks of its size.
    pub(super) place: [u32; 2],
    /// Binary logarithm of the number of cells along a side.
    pub(super) side: u32,
    /// Least and greatest height, in the opposite order if all cells are holes.
    pub(super) span: [f32; 2],
}

/// A span that holds nothing.
const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

fn join(all: [f32; 2], other: [f32; 2]) -> [f32; 2] {
    [all[0].min(other[0]), all[1].max(other[1])]
}

impl Blocks {
    /// Returns the blocks over rows and columns of cells, given the span of each cell.
    pub(super) fn over(cells: [u32; 2], span: impl Fn(u32, u32) -> Option<[f32; 2]>) -> Self {
        let mut levels: Vec<Level> = Vec::new();
        let mut side = LOWEST;
        loop {
            let [rows, columns] = cells.map(|count| count.div_ceil(1 << side));
            let block = |row: u32, column: u32| match levels.last() {
                None => within(row, LOWEST, cells[0])
                    .flat_map(|row| within(column, LOWEST, cells[1]).map(move |column| (row, column)))
                    .filter_map(|(row, column)| span(row, column))
                    .fold(NOTHING, join),
                Some(below) => below.children(row, column).map(|child| below.spans[child as usize]).fold(NOTHING, join),
            };
            let spans = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
            let spans = spans.map(|(row, column)| block(row, column)).collect();
            levels.push(Level { side, columns, first: 0, spans });
            if rows == 1 && columns == 1 {
                break;
            }
            side += STEP;
        }
        levels.reverse();
        let mut first = 0;
        for level in &mut levels {
            level.first = first;
            first += level.spans.len() as u32;
        }
        Self { levels, cells }
    }

    /// Returns the block that holds all cells.
    pub(super) fn whole(&self) -> Block {
        let level = &self.levels[0];
        Block { place: [0, 0], side: level.side, span: level.spans[0] }
    }

    /// Returns the level of a block, and its index in the level.
    fn find(&self, block: u32) -> (usize, u32) {
        let level = self.levels.partition_point(|level| level.first <= block) - 1;
        (level, block - self.levels[level].first)
    }

    /// Returns the blocks in a block, each with its number as a node, or `None` for a block of the
    /// lowest level.
    pub(super) fn children(&self, block: u32) -> Option<Vec<(Child, Block)>> {
        let (level, index) = self.find(block);
        let below = self.levels.get(level + 1)?;
        let columns = self.levels[level].columns;
        let child = |child: u32| {
            let place = [child / below.columns, child % below.columns];
            let block = Block { place, side: below.side, span: below.spans[child as usize] };
            (Child::Inner(below.first + child), block)
        };
        Some(below.children(index / columns, index % columns).map(child).collect())
    }

    /// Returns the rows and the columns of the cells in a block of the lowest level.
    pub(super) fn cells(&self, block: u32) -> [Range<u32>; 2] {
        let (level, index) = self.find(block);
        let columns = self.levels[level].columns;
        [within(index / columns, LOWEST, self.cells[0]), within(index % columns, LOWEST, self.cells[1])]
    }

    pub(super) fn memory(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level) + size_of_val(&*level.spans)).sum()
    }
}

/// Returns the rows or columns of a level that are in one of the level above.
fn within(block: u32, step: u32, count: u32) -> Range<u32> {
    block << step..((block + 1) << step).min(count)
}

impl Level {
    /// Returns the indices of the blocks of this level that are in a block of the level above.
    fn children(&self, row: u32, column: u32) -> impl Iterator<Item = u32> {
        let columns = self.columns;
        let rows = self.spans.len() as u32 / columns;
        within(row, STEP, rows)
            .flat_map(move |row| within(column, STEP, columns).map(move |column| row * columns + column))
    }
}
