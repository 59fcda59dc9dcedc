//! Tests one box against many, eight at a time (*Notes*, algorithm 2.1).
//!
//! Tests: `tests/it/volumes/batch.rs`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::Aabb;
use crate::simd::{LANES, Level, best_level, by_axis, dispatch};

/// Boxes in structure-of-arrays layout, to find those that overlap a given box.
///
/// ```
/// use impinge::volume::{Aabb, AabbBatch};
/// let at = |x: f32| Aabb { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 1.0] };
/// let batch: AabbBatch = (0..100).map(|i| at(i as f32)).collect();
/// let mut found = Vec::new();
/// batch.overlapping(&at(6.5), &mut found);
/// assert_eq!(found, [6, 7]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct AabbBatch {
    packets: Vec<Packet>,
    len: usize,
}

/// Eight boxes by axis. Lanes beyond the last box hold the empty box, which overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Packet {
    min: [[f32; LANES]; 3],
    max: [[f32; LANES]; 3],
}

impl FromIterator<Aabb> for AabbBatch {
    fn from_iter<I: IntoIterator<Item = Aabb>>(boxes: I) -> Self {
        let mut batch = Self::default();
        for one in boxes {
            batch.push(&one);
        }
        batch
    }
}

impl AabbBatch {
    /// Appends a box. A box with a NaN coordinate overlaps nothing, but
    /// [`overlapping`](Self::overlapping) may still report it.
    ///
    /// # Panics
    /// If the batch already holds 2^32 boxes.
    pub fn push(&mut self, one: &Aabb) {
        assert!(
            u32::try_from(self.len).is_ok(),
            "an AabbBatch holds at most 2^32 boxes: split the boxes over several batches"
        );
        let lane = self.len % LANES;
        if lane == 0 {
            self.packets.push(Packet { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3] });
        }
        if let Some(packet) = self.packets.last_mut() {
            for axis in 0..3 {
                packet.min[axis][lane] = one.min[axis];
                packet.max[axis][lane] = one.max[axis];
            }
        }
        self.len += 1;
    }

    /// Returns the number of boxes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Reports whether the batch has no boxes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends the indices of the boxes that overlap `one` to `found`, in ascending order. An index
    /// counts the boxes in the order of [`push`](Self::push). The test is exact; touching boxes
    /// overlap.
    ///
    /// # Complexity
    /// One pass over memory: 24 bytes and six comparisons per box.
    pub fn overlapping(&self, one: &Aabb, found: &mut Vec<u32>) {
        self.overlapping_at(best_level(), one, found);
    }

    /// Does the same as [`overlapping`](Self::overlapping) on the vector unit `level`. The result
    /// does not depend on the vector unit.
    pub fn overlapping_at(&self, level: Level, one: &Aabb, found: &mut Vec<u32>) {
        dispatch!(level, simd => scan(simd, &self.packets, one, found));
    }
}

#[inline(always)]
fn scan<S: Simd>(simd: S, packets: &[Packet], one: &Aabb, found: &mut Vec<u32>) {
    let min = by_axis!(axis => f32x8::splat(simd, one.min[axis]));
    let max = by_axis!(axis => f32x8::splat(simd, one.max[axis]));
    for (index, packet) in packets.iter().enumerate() {
        let apart = by_axis!(axis => {
            let (low, high) = (f32x8::from_slice(simd, &packet.min[axis]), f32x8::from_slice(simd, &packet.max[axis]));
            low.simd_gt(max[axis]) | high.simd_lt(min[axis])
        });
        let mut lanes = !((apart[0] | apart[1] | apart[2]).to_bitmask() as u32) & ((1 << LANES) - 1);
        while lanes != 0 {
            found.push((index * LANES) as u32 + lanes.trailing_zeros());
            lanes &= lanes - 1;
        }
    }
}
