//! A box relative to a cell, quantized to one machine word, so that the boxes of a cell fit into
//! one cache line.

use super::quantization::DISTINCT_KEYS;
use bytemuck::{Pod, Zeroable};

/// Number of bits per axis, which hold two steps. The cell key has the same number of bits, above
/// all axes.
pub(super) const AXIS: u32 = 16;
pub(super) const CELL_KEY: u32 = 3 * AXIS;
const ALL: u64 = (1 << CELL_KEY) - 1;

/// Distance in bits between the two steps of an axis.
const END_SHIFT: u32 = 8;

/// Mask of the first step of each axis.
const BEGINS: u64 = 0x00ff_00ff_00ff;

/// Position in a cell key of the low three bits of the cell's number, for each axis. No byte of a
/// cell key has all bits set.
const CELL_KEYS: [u32; 3] = [0, 3, 8];

/// Bit that is set in every cell key, so that no cell key is zero.
const IS_PRESENT: u16 = 1 << 6;

/// The beginning and the end of a box along the three axes, in steps relative to a cell, and the
/// key of the cell.
///
/// Ends are counted from the far side of the cell, so that the steps of a larger box are all
/// smaller. The key distinguishes cells that are less than [`DISTINCT_KEYS`] apart along each axis.
/// A word of zero means that there is no box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct QuantizedBox(pub(super) u64);

/// A box that quantized boxes are compared with: for each step, the maximum that a box overlapping
/// it may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe(u64);

impl QuantizedBox {
    /// Word that represents no box.
    pub(super) const NONE: Self = Self(0);

    /// Returns the part of one axis: the beginning and the end of the box, from 0 (before the cell)
    /// to 255 (behind it), and the cell's number along the axis. A quantized box is the union of
    /// its three parts.
    #[inline(always)]
    pub(super) fn along(axis: usize, [begin, end]: [u8; 2], cell: i64) -> Self {
        let steps = u64::from(steps(u16::from(begin), u16::from(u8::MAX - end)));
        Self(steps << (AXIS * axis as u32) | u64::from(cell_key(axis, cell)) << CELL_KEY)
    }

    #[inline]
    pub(super) fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    #[inline]
    pub(super) fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Reports whether both are relative to the same cell, or to two cells with the same key.
    #[inline]
    pub(super) fn has_cell_key_of(self, other: Self) -> bool {
        (self.0 ^ other.0) & !ALL == 0
    }

    /// Reports whether the box begins before the cell along an axis.
    #[inline]
    pub(super) fn begins_before(self, axis: usize) -> bool {
        self.0 >> (AXIS * axis as u32) & 0xff == 0
    }

    /// Returns the box in the form in which others are compared with it.
    #[inline]
    pub(super) fn probe(self) -> Probe {
        let steps = !self.0;
        Probe(!ALL | steps >> END_SHIFT & BEGINS | (steps & BEGINS) << END_SHIFT)
    }
}

/// Packs two steps of an axis.
#[inline(always)]
pub(super) fn steps(first: u16, second: u16) -> u16 {
    first | second << END_SHIFT
}

#[inline(always)]
pub(super) fn cell_key(axis: usize, cell: i64) -> u16 {
    ((cell & (DISTINCT_KEYS - 1)) as u16) << CELL_KEYS[axis] | IS_PRESENT
}

impl Probe {
    /// Returns `false` if the boxes are certainly apart: steps in strict order belong to
    /// coordinates in strict order. The result is meaningful only if both boxes are relative to the
    /// same cell.
    #[inline]
    pub(super) fn may_overlap(self, quantized: QuantizedBox) -> bool {
        let (most, bytes) = (self.0.to_ne_bytes(), quantized.0.to_ne_bytes());
        let over: [u8; 8] = std::array::from_fn(|at| bytes[at].saturating_sub(most[at]));
        u64::from_ne_bytes(over) == 0
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    pub(in crate::partition::grid) type Ends = [[u8; 3]; 2];

    pub(in crate::partition::grid) fn quantized([min, max]: Ends, cell: [i64; 3]) -> QuantizedBox {
        (0..3)
            .fold(QuantizedBox::NONE, |quantized, k| quantized.with(QuantizedBox::along(k, [min[k], max[k]], cell[k])))
    }

    pub(in crate::partition::grid) fn draw(rng: &mut Rng) -> Ends {
        let most = rng.choose(&[3, 255]);
        let ends = [0; 3].map(|_: i32| [0; 2].map(|_: i32| rng.integer(0, most) as u8));
        [ends.map(|[one, other]| one.min(other)), ends.map(|[one, other]| one.max(other))]
    }

    #[test]
    fn quantized_boxes_compare_as_their_steps_do_one_by_one() {
        let mut rng = Rng::new(91);
        let mut apart = 0;
        for _ in 0..100_000 {
            let cell = [0; 3].map(|_: i32| rng.integer(-20, 20));
            let (one, other) = (draw(&mut rng), draw(&mut rng));
            let [quantized, seen] = [one, other].map(|ends| quantized(ends, cell));
            let may_overlap = (0..3).all(|k| one[0][k] <= other[1][k] && other[0][k] <= one[1][k]);
            assert_eq!(seen.probe().may_overlap(quantized), may_overlap);
            assert_eq!([0, 1, 2].map(|axis| quantized.begins_before(axis)), one[0].map(|step| step == 0));
            assert!(
                !quantized.is_none()
                    && quantized.has_cell_key_of(seen)
                    && !quantized.has_cell_key_of(QuantizedBox::NONE)
            );
            apart += u32::from(!may_overlap);
        }
        assert!((20_000..95_000).contains(&apart), "{apart} apart");
    }

    #[test]
    fn neighboring_cells_have_different_cell_keys() {
        let quantized = |cell| quantized([[1; 3], [9; 3]], cell);
        for axis in 0..3 {
            for away in 1..DISTINCT_KEYS {
                let mut cell = [-3, 1 << 40, 0];
                let here = quantized(cell);
                cell[axis] += away;
                assert!(!quantized(cell).has_cell_key_of(here));
            }
        }
    }
}
