//! Where boxes are among cells of one size: which cells they reach into, and where in these they begin and end.

use std::ops::ControlFlow;

use super::quantization::{DISTINCT_KEYS, PARTS, quantized_step};
use super::quantized_box::QuantizedBox;
use crate::simd::by_axis;
use crate::volume::MinMax;

/// Cells are counted to here from the origin, and farther ones are the last.
const FARTHEST: f64 = (1_u64 << 40) as f64;

/// A sum with it ends in the whole number that is nearest to the other part, which has to be below 2^51.
const WHOLE: f64 = (3_u64 << 51) as f64;

/// A cell by its place, counted along each axis.
pub(super) type Cell = [i64; 3];

/// Equal cells, counted from an origin.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    origin: [f64; 3],
    /// Parts of a cell in a unit: a division takes four times as long as a product, which is monotone, too.
    scale: f64,
    /// The first and the last part of a cell along each axis.
    ends: [[f64; 2]; 3],
}

/// A coordinate in parts of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place(i64);

/// Where a box begins and ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reach {
    pub(super) low: [Place; 3],
    pub(super) high: [Place; 3],
}

/// A block of cells, from one corner to the other, with them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block {
    pub(super) low: Cell,
    pub(super) high: Cell,
}

impl Frame {
    /// Cells that are counted from `origin`, `counts` of them along each axis.
    pub(super) fn dense(origin: [f64; 3], cell: f64, counts: [usize; 3]) -> Self {
        Self { origin, scale: scale(cell), ends: counts.map(|count| [0.0, ((count << PARTS) - 1) as f64]) }
    }

    /// Cells without an end.
    pub(super) fn endless(cell: f64) -> Self {
        let last = FARTHEST * f64::from(1 << PARTS);
        Self { origin: [0.0; 3], scale: scale(cell), ends: [[-last, last]; 3] }
    }

    /// Every operation is monotone, so that what is between two corners is in the cells between theirs, and places that are
    /// in strict order belong to coordinates that are.
    #[inline(always)]
    fn place(&self, coordinate: f64, axis: usize) -> Place {
        let [first, last] = self.ends[axis];
        let at = (coordinate - self.origin[axis]) * self.scale;
        let above = if at > first { at } else { first };
        let within = if above < last { above } else { last };
        Place((within + WHOLE).to_bits() as i64 - WHOLE.to_bits() as i64)
    }

    #[inline]
    pub(super) fn cell_along(&self, coordinate: f64, axis: usize) -> i64 {
        self.place(coordinate, axis).cell()
    }

    #[inline(always)]
    pub(super) fn reach(&self, bounds: &MinMax) -> Reach {
        let (min, max) = (bounds.min(), bounds.max());
        Reach {
            low: by_axis!(axis => self.place(min[axis], axis)),
            high: by_axis!(axis => self.place(max[axis], axis)),
        }
    }

    /// Whether a cell is the one of the least corner of what a box shares with a block.
    pub(super) fn is_first(&self, cell: Cell, block: &Block, bounds: &MinMax) -> bool {
        let min = bounds.min();
        (0..3).all(|axis| cell[axis] == block.low[axis].max(self.cell_along(min[axis], axis)))
    }
}

/// A float of the least size has an infinite inverse.
fn scale(cell: f64) -> f64 {
    (f64::from(1 << PARTS) / cell).min(f64::MAX)
}

impl Place {
    #[inline]
    pub(super) fn cell(self) -> i64 {
        self.0 >> PARTS
    }

    /// How far the place is behind the beginning of a cell, in parts of one.
    #[inline(always)]
    pub(super) fn parts_from(self, cell: i64) -> i64 {
        self.0 - (cell << PARTS)
    }

    /// Returns the step as seen from a cell: 0 for what is before it, 255 for what is behind it, and 1 to 254 between.
    #[inline]
    fn quantized(self, cell: i64) -> u8 {
        let parts = self.parts_from(cell).clamp(-1, 1 << PARTS);
        quantized_step(parts as i16, 0) as u8
    }
}

impl Reach {
    /// The cells that the box reaches into.
    #[inline]
    pub(super) fn block(&self) -> Block {
        Block { low: self.low.map(Place::cell), high: self.high.map(Place::cell) }
    }

    /// The box along an axis as it is seen from a cell.
    #[inline]
    pub(super) fn along(&self, axis: usize, cell: i64) -> [u8; 2] {
        [self.low[axis].quantized(cell), self.high[axis].quantized(cell)]
    }

    /// The box as it is seen from a cell.
    #[inline]
    pub(super) fn quantized(&self, cell: Cell) -> QuantizedBox {
        let along = |axis| QuantizedBox::along(axis, self.along(axis, cell[axis]), cell[axis]);
        along(0).with(along(1)).with(along(2))
    }
}

impl Block {
    /// How many cells there are.
    pub(super) fn count(&self) -> f64 {
        (0..3).map(|axis| (self.high[axis] - self.low[axis] + 1) as f64).product()
    }

    /// Reports whether there are at most `most` cells, all with different keys.
    pub(super) fn is_small(&self, most: f64) -> bool {
        self.count() <= most && (0..3).all(|axis| self.high[axis] - self.low[axis] < DISTINCT_KEYS)
    }

    #[inline]
    pub(super) fn each(&self, mut visit: impl FnMut(Cell) -> ControlFlow<()>) -> ControlFlow<()> {
        let Self { low, high } = self;
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    visit([x, y, z])?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}
