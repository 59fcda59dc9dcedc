//! Packets: the triangles of one leaf side by side for the vector unit, in single precision about an anchor of their
//! own, for rejecting and confirming in bulk. What they leave open is decided on the stored vertices.

use crate::simd::LANES;
use crate::volume::Aabb;

/// Up to eight triangles; unused lanes repeat the first one.
///
/// A corner is `anchor + corners[..]` in the packed frame, up to `HALF_ULP · radius` for its rounding to single
/// precision and [`PACKING_ERROR`](super::frame::PACKING_ERROR) for the arithmetic before that.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    /// `corners[corner][axis][lane]`, relative to the anchor.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
    /// A point amid the triangles, in the packed frame, exactly.
    pub(crate) anchor: [f32; 3],
    /// The greatest magnitude of the relative coordinates.
    pub(crate) radius: f32,
    count: u32,
    reserved: [u32; 3],
}

impl Packet {
    /// The bits of the lanes that hold a triangle.
    #[inline(always)]
    pub(crate) fn lanes_in_use(&self) -> u32 {
        (1 << (self.count as usize).min(LANES)) - 1
    }

    /// The packet of these triangles, at least one and at most eight, whose packed boxes `bounds` holds; `packed` gives
    /// the packed corners of a triangle.
    pub(crate) fn new(triangles: &[u32], bounds: &Aabb, packed: impl Fn(u32) -> [[f64; 3]; 3]) -> Self {
        let anchor: [f32; 3] = std::array::from_fn(|axis| 0.5 * (bounds.min[axis] + bounds.max[axis]));
        let mut corners = [[[0.0; LANES]; 3]; 3];
        let mut radius = 0.0_f32;
        for (lane, &triangle) in triangles.iter().enumerate() {
            for (corner, packed) in packed(triangle).iter().enumerate() {
                for axis in 0..3 {
                    let relative = (packed[axis] - f64::from(anchor[axis])) as f32;
                    corners[corner][axis][lane] = relative;
                    radius = radius.max(relative.abs());
                }
            }
        }
        for lanes in corners.as_flattened_mut() {
            let first = lanes[0];
            lanes[triangles.len()..].fill(first);
        }
        Self { corners, anchor, radius, count: triangles.len() as u32, reserved: [0; 3] }
    }
}
