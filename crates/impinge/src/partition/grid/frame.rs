//! Maps boxes to cells of one size: the cells that they reach into, and the parts of these at which
//! they begin and end.

use std::ops::ControlFlow;

use super::quantization::{DISTINCT_KEYS, PART_BITS, quantized_step};
use super::quantized_box::QuantizedBox;
use crate::simd::by_axis;
use crate::volume::MinMax;

/// Maximum distance of a cell from the origin, in cells. Everything farther away belongs to the
/// last cell.
const MAX_CELL: f64 = (1_u64 << 40) as f64;

/// Float whose low bits represent a whole number. Adding it rounds to the nearest whole number, if
/// the other summand is below 2^51 in magnitude.
const ROUNDING_OFFSET: f64 = (3_u64 << 51) as f64;

/// Numbers of a cell along each axis.
pub(super) type Cell = [i64; 3];

/// A partition of space into equal cells, counted from an origin.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    origin: [f64; 3],
    /// Number of parts of a cell per unit of length. Coordinates are multiplied by it, because a
    /// division takes four times as long; a product is monotone, too.
    scale: f64,
    /// First and last part along each axis. Coordinates beyond them are clamped.
    ends: [[f64; 2]; 3],
}

/// A coordinate in parts of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place(i64);

/// The beginning and the end of a box along each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reach {
    pub(super) low: [Place; 3],
    pub(super) high: [Place; 3],
}

/// A block of cells, from one corner to the other, both included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block {
    pub(super) low: Cell,
    pub(super) high: Cell,
}

impl Frame {
    /// Returns a frame with `counts` cells along each axis, counted from `origin`.
    pub(super) fn dense(origin: [f64; 3], cell: f64, counts: [usize; 3]) -> Self {
        Self { origin, scale: scale(cell), ends: counts.map(|count| [0.0, ((count << PART_BITS) - 1) as f64]) }
    }

    /// Returns a frame with cells in all of space, counted from the coordinate origin.
    pub(super) fn endless(cell: f64) -> Self {
        let last = MAX_CELL * f64::from(1 << PART_BITS);
        Self { origin: [0.0; 3], scale: scale(cell), ends: [[-last, last]; 3] }
    }

    /// Returns the place of a coordinate along an axis. Every operation is monotone. Points between
    /// two corners therefore lie in the cells between the corners' cells, and places in strict
    /// order belong to coordinates in strict order.
    #[inline(always)]
    fn place(&self, coordinate: f64, axis: usize) -> Place {
        let [first, last] = self.ends[axis];
        let at = (coordinate - self.origin[axis]) * self.scale;
        let above = if at > first { at } else { first };
        let within = if above < last { above } else { last };
        Place((within + ROUNDING_OFFSET).to_bits() as i64 - ROUNDING_OFFSET.to_bits() as i64)
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

    /// Reports whether a cell contains the minimum corner of the intersection of a box and a block.
    pub(super) fn is_first(&self, cell: Cell, block: &Block, bounds: &MinMax) -> bool {
        let min = bounds.min();
        (0..3).all(|axis| cell[axis] == block.low[axis].max(self.cell_along(min[axis], axis)))
    }
}

/// Returns the number of parts of a cell per unit of length. It is limited to a finite number,
/// because the smallest floats have infinite reciprocals.
fn scale(cell: f64) -> f64 {
    (f64::from(1 << PART_BITS) / cell).min(f64::MAX)
}

impl Place {
    #[inline]
    pub(super) fn cell(self) -> i64 {
        self.0 >> PART_BITS
    }

    /// Returns the signed distance from the beginning of a cell to the place, in parts of a cell.
    #[inline(always)]
    pub(super) fn parts_from(self, cell: i64) -> i64 {
        self.0 - (cell << PART_BITS)
    }

    /// Returns the step relative to a cell: 0 for a place before the cell, 255 for a place behind
    /// it, and 1 to 254 inside.
    #[inline]
    fn quantized(self, cell: i64) -> u8 {
        let parts = self.parts_from(cell).clamp(-1, 1 << PART_BITS);
        quantized_step(parts as i16, 0) as u8
    }
}

impl Reach {
    /// Returns the cells that the box reaches into.
    #[inline]
    pub(super) fn block(&self) -> Block {
        Block { low: self.low.map(Place::cell), high: self.high.map(Place::cell) }
    }

    /// Returns the beginning and the end of the box along an axis, in steps relative to a cell.
    #[inline]
    pub(super) fn along(&self, axis: usize, cell: i64) -> [u8; 2] {
        [self.low[axis].quantized(cell), self.high[axis].quantized(cell)]
    }

    /// Returns the box quantized relative to a cell.
    #[inline]
    pub(super) fn quantized(&self, cell: Cell) -> QuantizedBox {
        let along = |axis| QuantizedBox::along(axis, self.along(axis, cell[axis]), cell[axis]);
        along(0).with(along(1)).with(along(2))
    }
}

impl Block {
    /// Returns the number of cells.
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
