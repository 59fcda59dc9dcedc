//! Boxes eight at a time: carried from one frame into another without ever shrinking, and tested against each other.
//!
//! Source: Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems 1990 (the centre and half-extents form,
//! Ericson 4.2.6), in single precision with the rounding error carried as a bound.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use super::wide::Node;
use crate::simd::{LANES, by_axis, load, nonzero_bytes, take_four};
use crate::volume::Aabb;

/// Half a unit in the last place of single precision: the relative error of one rounding.
pub(crate) const HALF_ULP: f64 = 1.0 / (1_u32 << 24) as f64;

/// An affine map for boxes, from the guest's frame into the host's.
#[derive(Clone, Debug)]
pub(crate) struct BoxMap {
    linear: [[f32; 3]; 3],
    magnitude: [[f32; 3]; 3],
    translation: [f32; 3],
    slack: [f32; 3],
}

impl BoxMap {
    /// The map `linear · x + translation`, known up to `error` on each axis, for boxes whose coordinates are at most
    /// `reach` in magnitude.
    ///
    /// # Accuracy
    /// With u = 2^-24 and S = Σ|linear|·reach + |translation| on an axis, rounding contributes at most: 3 u S for the
    /// rounded matrix, translation and centre; 4 u S for the products and sums that make the new centre; 7 u S for the
    /// half-extents likewise; 2 u S for the last difference and sum, and these sums
    /// 5 u of the error itself. The slack is 20 u S and (1 + 8 u) times the error, which covers its own evaluation and,
    /// by `UNDERFLOW`, products too small for a float. This is lemma L2 of docs/proof.md with one bound for all boxes.
    pub(crate) fn new(linear: &[[f64; 3]; 3], translation: &[f64; 3], error: &[f64; 3], reach: f64) -> Self {
        const UNDERFLOW: f64 = 1.0 / (1_u128 << 120) as f64;
        let slack = std::array::from_fn(|axis| {
            let size = linear[axis].iter().map(|x| x.abs()).sum::<f64>() * reach + translation[axis].abs();
            ((20.0 * HALF_ULP * size + (1.0 + 8.0 * HALF_ULP) * error[axis] + UNDERFLOW) as f32).next_up()
        });
        let linear = linear.map(|row| row.map(|x| x as f32));
        Self {
            linear,
            magnitude: linear.map(|row| row.map(f32::abs)),
            translation: translation.map(|x| x as f32),
            slack,
        }
    }

    /// The greatest slack of the three axes, in the host's unit: what rounding may cost this frame.
    pub(crate) fn slack(&self) -> f32 {
        self.slack.iter().copied().fold(0.0, f32::max)
    }

    /// Boxes in the host's frame that hold the images of the node's boxes. Lanes that the node does not use hold
    /// nothing that may be relied on.
    #[inline(always)]
    pub(crate) fn apply<S: Simd>(&self, simd: S, node: &Node) -> BoxLanes {
        let half = f32x8::splat(simd, 0.5);
        let mut centre = [half; 3];
        let mut extent = [half; 3];
        for axis in 0..3 {
            let (min, max) = (load(simd, &node.min[axis]), load(simd, &node.max[axis]));
            centre[axis] = (min + max) * half;
            extent[axis] = (max - min) * half;
        }
        let mut lanes = BoxLanes::default();
        for axis in 0..3 {
            let mut c = f32x8::splat(simd, self.translation[axis]);
            let mut e = f32x8::splat(simd, self.slack[axis]);
            for from in 0..3 {
                c = f32x8::splat(simd, self.linear[axis][from]).mul_add(centre[from], c);
                e = f32x8::splat(simd, self.magnitude[axis][from]).mul_add(extent[from], e);
            }
            (c - e).store_slice(&mut lanes.min[axis]);
            (c + e).store_slice(&mut lanes.max[axis]);
        }
        lanes
    }
}

/// Eight boxes by axis.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(crate) struct BoxLanes {
    pub(crate) min: [[f32; LANES]; 3],
    pub(crate) max: [[f32; LANES]; 3],
}

impl BoxLanes {
    /// The box in one lane.
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

/// The lanes whose boxes are not proved apart from `one`, as bits. A comparison with NaN proves nothing, so that a bound
/// that overflowed costs time and never a pair.
#[inline(always)]
pub(crate) fn overlapping<S: Simd>(simd: S, boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]), one: &Aabb) -> u32 {
    !apart(simd, boxes, one) & 0xff
}

/// The lanes of `boxes` that are not proved apart from each of `many`: for lane `i` of these the byte `i`.
#[inline(always)]
pub(crate) fn overlapping_each<S: Simd>(simd: S, boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]), many: &BoxLanes) -> u64 {
    let mut apart_from = 0;
    for lane in 0..LANES {
        apart_from |= u64::from(apart(simd, boxes, &many.lane(lane))) << (LANES * lane);
    }
    !apart_from
}

/// Of pairs of boxes those that are not proved apart: bit `i` of byte `k` for lane `i` of `boxes` and `k` of `many`.
///
/// Four of `many` are looked at in one go: for pairs in which there are mostly no more of them.
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

/// The lanes whose boxes are proved apart from `one`, as bits.
#[inline(always)]
fn apart<S: Simd>(simd: S, boxes: (&[f32x8<S>; 3], &[f32x8<S>; 3]), one: &Aabb) -> u32 {
    let (min, max) = boxes;
    let apart: [mask32x8<S>; 3] = by_axis!(axis => {
        min[axis].simd_gt(f32x8::splat(simd, one.max[axis])) | max[axis].simd_lt(f32x8::splat(simd, one.min[axis]))
    });
    (apart[0] | apart[1] | apart[2]).to_bitmask() as u32
}

#[cfg(test)]
mod tests;
