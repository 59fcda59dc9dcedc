//! Transforms slabs from one frame to another, and tests them against the boxes of a node.
//!
//! Tests: `slab_map/tests.rs`, against rationals. Proof: docs/notes/proof.md, L2a.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8};

use super::lanes::HALF_ULP;
use super::slab::Slab;
use super::wide::Node;
use crate::simd::{by_axis, load};

/// Transforms slabs by the inverse of an affine map: from the map's target frame to its source
/// frame, which is the frame of the boxes.
#[derive(Clone, Debug)]
pub(crate) struct SlabMap {
    /// For each axis of the target: its row of the linear part, which turns a normal along it into
    /// the source frame, and its translation, which is the height of the source's origin along it.
    rows: [[f32; 4]; 3],
    slack: f32,
    /// Maximum magnitude of a coordinate in the source frame.
    reach: f32,
}

/// Minimum squared cosine of the angle between the normals of two slabs whose difference is used.
/// The normals are at most 14 degrees apart.
const MIN_SQUARED_COSINE: f32 = 15.0 / 16.0;

impl SlabMap {
    /// Builds the map for `linear · x + translation`, from boxes to slabs. The coordinates of the
    /// boxes are at most `reach` in magnitude. The map is known up to `error` on each axis.
    ///
    /// # Accuracy
    /// With u = 2^-24 and S the sum over the axes of Σ|linear|·reach + |translation|, and normals
    /// of at most 1, the height of a box's corner collects at most:
    /// - 5 u S for the rounded matrix and the turned normal,
    /// - 5 u S for the rounded translation and its height,
    /// - 5 u S for the corner's own height,
    /// - 4 u S for the last differences and sums.
    ///
    /// The slack is 32 u S and twice the errors.
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
            // If the map exceeds single precision, a transformed slab is all of space.
            slack: if is_in_range { (slack as f32).next_up() } else { f32::INFINITY },
            reach: (reach as f32).next_up(),
        }
    }

    /// Returns a slab in the source frame that contains every point that the map takes into `slab`.
    #[inline(always)]
    pub(crate) fn carry<S: Simd>(&self, simd: S, slab: &Slab) -> Slab {
        let [x, y, z] = by_axis!(axis => f32x4::splat(simd, slab.normal[axis]));
        let [along_x, along_y, along_z] = by_axis!(axis => f32x4::from_slice(simd, &self.rows[axis]));
        let [x, y, z, height] = z.mul_add(along_z, y.mul_add(along_y, x * along_x)).into();
        let (min, max) = (slab.min - height - self.slack, slab.max - height + self.slack);
        Slab { normal: [x, y, z], min, max }
    }

    /// Returns the difference of a transformed slab and a slab of the source frame, or `None`
    /// unless they face nearly the same way. It contains every point that lies in both slabs. Its
    /// normal is the part of `carried.normal` that is not along `own.normal`, so it is short. Boxes
    /// have a small extent along such a normal, although they are as thick along the slabs' own
    /// normals as they are wide.
    ///
    /// # Accuracy
    /// With S = (Σ|carried| + |share| Σ|own|)·reach, the two roundings of the normal take 2 u S,
    /// the bounds 5 u S, and the heights of a box and their comparison 10 u S (docs/notes/proof.md,
    /// L2a). The slack is 32 u S.
    #[inline(always)]
    pub(crate) fn difference(&self, carried: &Slab, own: &Slab) -> Option<Slab> {
        let (n, m) = (&carried.normal, &own.normal);
        let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (along, square) = (dot(n, m), dot(m, m));
        // False for a slab without a normal.
        let is_facing = along * along > MIN_SQUARED_COSINE * square * dot(n, n);
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
    /// Returns the lanes whose boxes are proved outside the slab, as bits. The slab must be in the
    /// frame of the boxes. A comparison with NaN proves nothing.
    #[inline(always)]
    pub(crate) fn outside<S: Simd>(&self, simd: S, boxes: &Node) -> u32 {
        // The lowest and the highest corner of each box along the normal.
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
