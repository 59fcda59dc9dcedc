//! The Morton curve: the order in which a depth-first walk of an octree meets its cells.
//!
//! Source: Morton, *A computer oriented geodetic data base*, IBM 1966; Ericson, 7.3.5.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, u32x4};

use crate::volume::Aabb;

/// Bits of a cell's coordinate on each axis.
const BITS: u32 = 10;

/// Bits of a code.
pub(crate) const CODE_BITS: u32 = 3 * BITS;

/// A box's code in the upper half, its index in the lower.
pub(crate) type Key = u64;

/// The code of a key.
#[inline(always)]
pub(crate) fn code(key: Key) -> u32 {
    (key >> 32) as u32
}

/// The index of a key.
#[inline(always)]
pub(crate) fn index(key: Key) -> u32 {
    key as u32
}

/// A curve through the cubic cells of a cube.
pub(crate) struct Curve {
    origin: [f32; 4],
    scale: f32,
}

impl Curve {
    /// The curve over these bounds; none where they are a point, or so large or small that cells could not be told apart.
    pub(crate) fn over(bounds: &Aabb) -> Option<Self> {
        let extent = (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f32::max);
        let scale = (1_u32 << BITS) as f32 / extent;
        let [x, y, z] = bounds.min;
        (extent > 0.0 && extent.is_finite() && scale.is_finite()).then_some(Self { origin: [x, y, z, 0.0], scale })
    }

    /// The key of a box of which this is twice the centre.
    #[inline(always)]
    pub(crate) fn key<S: Simd>(&self, simd: S, twice_centre: f32x4<S>, index: u32) -> Key {
        /// Added to a small positive number, leaves an integer in the lowest bits.
        const ROUND: f32 = (1 << 23) as f32;
        const LAST: f32 = ((1 << BITS) - 1) as f32;
        let origin = f32x4::from_slice(simd, &self.origin);
        let along = (twice_centre - origin) * self.scale - 0.5;
        let inside = along.simd_gt(f32x4::splat(simd, 0.0)).select(along, f32x4::splat(simd, 0.0));
        let cell = inside.min(f32x4::splat(simd, LAST)) + ROUND;
        let [x, y, z, _] = <[u32; 4]>::from(spread(cell.bitcast::<u32x4<S>>()));
        u64::from(x | y << 1 | z << 2) << 32 | u64::from(index)
    }
}

/// The low 10 bits of each lane, each followed by two zeros.
#[inline(always)]
fn spread<S: Simd>(x: u32x4<S>) -> u32x4<S> {
    let x = x & 0x3ff;
    let x = (x | (x << 16)) & 0x0300_00ff;
    let x = (x | (x << 8)) & 0x0300_f00f;
    let x = (x | (x << 4)) & 0x030c_30c3;
    (x | (x << 2)) & 0x0924_9249
}
