//! Overlap tests of eight boxes at a time. Guarded by `box_map/tests.rs`; the verdicts are
//! docs/notes/proof.md, L2.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use crate::simd::{LANES, by_axis, nonzero_bytes, take_four};
use crate::volume::Aabb;

/// Half a unit in the last place of 1 in single precision: the relative error of one rounding.
pub(crate) const HALF_ULP: f64 = 1.0 / (1_u32 << 24) as f64;

/// Eight boxes, stored by axis.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(crate) struct BoxLanes {
    pub(crate) min: [[f32; LANES]; 3],
    pub(crate) max: [[f32; LANES]; 3],
}

impl BoxLanes {
    /// Returns the box in one lane.
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> Aabb {
        Aabb { min: by_axis!(axis => self.min[axis][lane]), max: by_axis!(axis => self.max[axis][lane]) }
    }

    #[inline(always)]
    pub(crate) fn set_lane(&mut self, lane: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.min[axis][lane] = bounds.min[axis];
            self.max[axis][lane] = bounds.max[axis];
        }
    }
}

/// Returns the lanes whose boxes are not proved apart from `one`, as bits. A comparison with NaN
/// proves nothing, so a bound that overflowed costs time but never loses a pair.
#[inline(always)]
pub(crate) fn overlapping<S: Simd>(simd: S, boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]), one: &Aabb) -> u32 {
    !apart(simd, boxes, one) & 0xff
}

/// Returns the lanes of `boxes` that are not proved apart from each box of `many`: byte `k` for
/// lane `k` of `many`.
#[inline(always)]
pub(crate) fn overlapping_each<S: Simd>(simd: S, boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]), many: &BoxLanes) -> u64 {
    let mut apart_from = 0;
    for lane in 0..LANES {
        apart_from |= u64::from(apart(simd, boxes, &many.lane(lane))) << (LANES * lane);
    }
    !apart_from
}

/// Returns the given pairs of boxes that are not proved apart: bit `i` of byte `k` for lane `i` of
/// `boxes` and lane `k` of `many`.
///
/// It processes four boxes of `many` at a time. It is for `pairs` that mostly contain at most four
/// of them.
#[inline(always)]
pub(crate) fn overlapping_pairs<S: Simd>(
    simd: S,
    boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]),
    many: &BoxLanes,
    pairs: u64,
) -> u64 {
    let mut left = nonzero_bytes(pairs);
    let mut apart_from = 0;
    while left != 0 {
        for first in take_four(&mut left) {
            apart_from |= u64::from(apart(simd, boxes, &many.lane(first / LANES))) << first;
        }
    }
    pairs & !apart_from
}

/// Returns the lanes whose boxes are proved apart from `one`, as bits.
#[inline(always)]
fn apart<S: Simd>(simd: S, boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]), one: &Aabb) -> u32 {
    let (min, max) = boxes;
    let apart: [mask32x8<S>; 3] = by_axis!(axis => {
        min[axis].simd_gt(f32x8::splat(simd, one.max[axis])) | max[axis].simd_lt(f32x8::splat(simd, one.min[axis]))
    });
    (apart[0] | apart[1] | apart[2]).to_bitmask() as u32
}
