//! Transforms boxes from one frame to another, eight at a time. The results always enclose the
//! images.
//!
//! Source: Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems 1990 (in the form with
//! center and half-extents, Ericson 4.2.6). Ours uses single precision and adds a bound on the
//! rounding error.
//!
//! Tests: `box_map/tests.rs`, against rationals. Proof: docs/notes/proof.md, L2.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::lanes::{BoxLanes, HALF_ULP};
use super::wide::Node;
use crate::simd::load;

/// An affine map for boxes, from the guest's frame to the host's.
#[derive(Clone, Debug)]
pub(crate) struct BoxMap {
    linear: [[f32; 3]; 3],
    magnitude: [[f32; 3]; 3],
    translation: [f32; 3],
    slack: [f32; 3],
}

impl BoxMap {
    /// Builds the map `linear · x + translation` for boxes whose coordinates are at most `reach` in
    /// magnitude. The map is known up to `error` on each axis.
    ///
    /// # Accuracy
    /// With u = 2^-24 and S = Σ|linear|·reach + |translation| on an axis, rounding contributes at
    /// most:
    /// - 3 u S for the rounded matrix, translation and center,
    /// - 4 u S for the products and sums of the new center,
    /// - 7 u S for the products and sums of the half-extents,
    /// - 2 u S for the last difference and sum,
    /// - 5 u of the error itself, which these sums contain.
    ///
    /// The slack is 20 u S and (1 + 8 u) times the error. This covers its own evaluation and, by
    /// `UNDERFLOW`, products too small for a float. It is lemma L2 of docs/notes/proof.md with one
    /// bound for all boxes.
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

    /// Returns the largest slack of the three axes, in the host's unit: the most that rounding may
    /// enlarge a box.
    pub(crate) fn slack(&self) -> f32 {
        self.slack.iter().copied().fold(0.0, f32::max)
    }

    /// Returns boxes in the host's frame that enclose the images of the node's boxes. Lanes that
    /// the node does not use are arbitrary.
    #[inline(always)]
    pub(crate) fn apply<S: Simd>(&self, simd: S, node: &Node) -> BoxLanes {
        let half = f32x8::splat(simd, 0.5);
        let mut center = [half; 3];
        let mut extent = [half; 3];
        for axis in 0..3 {
            let (min, max) = (load(simd, &node.min[axis]), load(simd, &node.max[axis]));
            center[axis] = (min + max) * half;
            extent[axis] = (max - min) * half;
        }
        let mut lanes = BoxLanes::default();
        for axis in 0..3 {
            let mut c = f32x8::splat(simd, self.translation[axis]);
            let mut e = f32x8::splat(simd, self.slack[axis]);
            for from in 0..3 {
                c = f32x8::splat(simd, self.linear[axis][from]).mul_add(center[from], c);
                e = f32x8::splat(simd, self.magnitude[axis][from]).mul_add(extent[from], e);
            }
            (c - e).store_slice(&mut lanes.min[axis]);
            (c + e).store_slice(&mut lanes.max[axis]);
        }
        lanes
    }
}

#[cfg(test)]
mod tests;
