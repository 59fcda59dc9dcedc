//! Slabs carried from one frame into another, and tested against the boxes of a node.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8};

use super::lanes::HALF_ULP;
use super::slab::Slab;
use super::wide::Node;
use crate::simd::{by_axis, load};

/// Carries slabs against an affine map: from the map's target into its source, where the boxes are.
#[derive(Clone, Debug)]
pub(crate) struct SlabMap {
    /// For each axis of the target: what a unit of a normal along it comes to along the source's axes, and how high it lifts the
    /// target's origin.
    rows: [[f32; 4]; 3],
    slack: f32,
    /// No coordinate of the source is larger.
    reach: f32,
}

/// The least square of the cosine between normals of slabs of which one is taken off the other: they are within 14 degrees.
const FACING: f32 = 15.0 / 16.0;

impl SlabMap {
    /// For the map `linear · x + translation`, known up to `error` on each axis, from boxes whose coordinates are at
    /// most `reach` in magnitude to slabs.
    ///
    /// # Accuracy
    /// With u = 2^-24 and S the sum over the axes of Σ|linear|·reach + |translation|, normals being at most one, the
    /// height of a box's corner collects at most 5 u S for the rounded matrix and the turned normal, 5 u S for the rounded
    /// translation and its height, 5 u S for the corner's own height, and 4 u S for the last differences and sums. The slack is
    /// 32 u S and twice the errors.
    pub(crate) fn new(linear: &[[f64; 3]; 3], translation: &[f64; 3], error: &[f64; 3], reach: f64) -> Self {
        const UNDERFLOW: f64 = 1.0 / (1_u128 << 100) as f64;
        let [turns, moves] = [linear.as_flattened(), translation].map(|x| x.iter().map(|x| x.abs()).sum::<f64>());
        let slack = 32.0 * HALF_ULP * (turns * reach + moves) + 2.0 * error.iter().sum::<f64>() + UNDERFLOW;
        let is_in_range = turns + moves < f64::from(f32::MAX);
        Self {
            rows: by_axis!(axis => {
                let [x, y, z] = linear[axis];
                [x as f32, y as f32, z as f32, translation[axis] as f32]
            }),
            // A slab that is carried by what is beyond single precision is all of space.
            slack: if is_in_range { (slack as f32).next_up() } else { f32::INFINITY },
            reach: (reach as f32).next_up(),
        }
    }

    /// The slab in the source's frame, so wide that it holds whatever the map takes into the slab.
    #[inline(always)]
    pub(crate) fn carry<S: Simd>(&self, simd: S, slab: &Slab) -> Slab {
        let [x, y, z] = by_axis!(axis => f32x4::splat(simd, slab.normal[axis]));
        let [along_x, along_y, along_z] = by_axis!(axis => f32x4::from_slice(simd, &self.rows[axis]));
        let [x, y, z, height] = z.mul_add(along_z, y.mul_add(along_y, x * along_x)).into();
        let (min, max) = (slab.min - height - self.slack, slab.max - height + self.slack);
        Slab { normal: [x, y, z], min, max }
    }

    /// What lies both in a slab that was carried and in one of the source's own lies in the slab that is returned, if the two face
    /// nearly the same way. Its normal is short, being what the carried one's is besides the own one's: boxes, which are as thick
    /// along either as they are wide, hardly reach along it.
    ///
    /// # Accuracy
    /// With S = (Σ|carried| + |share| Σ|own|)·reach the normal's two roundings take 2 u S, the bounds' 5 u S, and a box's heights and
    /// their comparison 10 u S (docs/proof.md, L2a). The slack is 32 u S.
    #[inline(always)]
    pub(crate) fn beside(&self, carried: &Slab, own: &Slab) -> Option<Slab> {
        let (n, m) = (&carried.normal, &own.normal);
        let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (along, square) = (dot(n, m), dot(m, m));
        // Not so for a slab without a normal.
        let is_facing = along * along > FACING * square * dot(n, n);
        is_facing.then(|| {
            let share = along / square;
            let sum = |normal: &[f32; 3]| normal[0].abs() + normal[1].abs() + normal[2].abs();
            let size = (sum(n) + share.abs() * sum(m)) * self.reach;
            let slack = 32.0 * HALF_ULP as f32 * size + f32::MIN_POSITIVE;
            let (p, q) = (share * own.min, share * own.max);
            Slab {
                normal: by_axis!(axis => n[axis] - share * m[axis]),
                min: carried.min - p.max(q) - slack,
                max: carried.max - p.min(q) + slack,
            }
        })
    }
}

impl Slab {
    /// The lanes whose boxes are proved outside, as bits; for a slab that was carried to where the boxes are. A
    /// comparison with NaN proves nothing.
    #[inline(always)]
    pub(crate) fn outside<S: Simd>(&self, simd: S, boxes: &Node) -> u32 {
        // The corners of each box that are lowest and highest along the normal.
        let mut low = f32x8::splat(simd, 0.0);
        let mut high = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            let (lower, higher) =
                if self.normal[axis] < 0.0 { (&boxes.max, &boxes.min) } else { (&boxes.min, &boxes.max) };
            let normal = f32x8::splat(simd, self.normal[axis]);
            low = load(simd, &lower[axis]).mul_add(normal, low);
            high = load(simd, &higher[axis]).mul_add(normal, high);
        }
        let above = low.simd_gt(f32x8::splat(simd, self.max));
        let below = high.simd_lt(f32x8::splat(simd, self.min));
        (above | below).to_bitmask() as u32
    }
}

#[cfg(test)]
mod tests;
