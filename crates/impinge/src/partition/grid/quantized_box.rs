//! A box as it is seen from a cell, quantized to one machine word: so small that the boxes of a cell fit one line of a cache.

use super::quantization::DISTINCT_KEYS;
use bytemuck::{Pod, Zeroable};

/// Number of bits of an axis, which has two steps. The cell key has as many bits above all axes.
pub(super) const AXIS: u32 = 16;
pub(super) const CELL_KEY: u32 = 3 * AXIS;
const ALL: u64 = (1 << CELL_KEY) - 1;

/// How far above the first step of an axis is the other one.
const END: u32 = 8;

/// The first step of each axis.
const FIRST: u64 = 0x00ff_00ff_00ff;

/// Where the three bits of the cell along each axis are in a cell key. One more bit is always set. No byte of a cell key is full.
const CELL_KEYS: [u32; 3] = [0, 3, 8];
const IS_THERE: u16 = 1 << 6;

/// Where a box begins and ends as seen from a cell, in steps along the three axes, and the key of the cell. The ends are counted
/// from behind, so that a larger box has lesser steps throughout. The key tells cells apart that are fewer than [`DISTINCT_KEYS`]
/// apart along each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct QuantizedBox(pub(super) u64);

/// A box that quantized boxes are compared with: the greatest steps that a box may have that it meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe(u64);

impl QuantizedBox {
    /// No box.
    pub(super) const NONE: Self = Self(0);

    /// The part of one axis: where the box begins and ends, from 0, before the cell, to 255, behind it, and the place of the
    /// cell. A quantized box is all three.
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

    /// Reports whether both are seen from the same cell, or from two cells of one key.
    #[inline]
    pub(super) fn has_cell_key_of(self, other: Self) -> bool {
        (self.0 ^ other.0) & !ALL == 0
    }

    /// Whether the box begins before the cell along an axis.
    #[inline]
    pub(super) fn begins_before(self, axis: usize) -> bool {
        self.0 >> (AXIS * axis as u32) & 0xff == 0
    }

    /// The box as others are compared with it.
    #[inline]
    pub(super) fn probe(self) -> Probe {
        let steps = !self.0;
        Probe(!ALL | steps >> END & FIRST | (steps & FIRST) << END)
    }
}

/// Two steps of an axis together.
#[inline(always)]
pub(super) fn steps(first: u16, second: u16) -> u16 {
    first | second << END
}

#[inline(always)]
pub(super) fn cell_key(axis: usize, cell: i64) -> u16 {
    ((cell & (DISTINCT_KEYS - 1)) as u16) << CELL_KEYS[axis] | IS_THERE
}

impl Probe {
    /// Unless it does, the boxes are apart: steps that are in strict order belong to coordinates in strict order. Only of use for a
    /// quantized box that is seen from the same cell.
    #[inline]
    pub(super) fn may_meet(self, quantized: QuantizedBox) -> bool {
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
            let may_meet = (0..3).all(|k| one[0][k] <= other[1][k] && other[0][k] <= one[1][k]);
            assert_eq!(seen.probe().may_meet(quantized), may_meet);
            assert_eq!([0, 1, 2].map(|axis| quantized.begins_before(axis)), one[0].map(|step| step == 0));
            assert!(
                !quantized.is_none()
                    && quantized.has_cell_key_of(seen)
                    && !quantized.has_cell_key_of(QuantizedBox::NONE)
            );
            apart += u32::from(!may_meet);
        }
        assert!((20_000..95_000).contains(&apart), "{apart} apart");
    }

    #[test]
    fn cell_keys_tell_neighbouring_cells_apart() {
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
