//! Packets: the triangles of one leaf side by side for the vector unit, in single precision about an anchor of their
//! own, for rejecting and confirming in bulk. What they leave open is decided on the stored vertices.

use super::frame::PackedFrame;
use super::positions::Positions;
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

    /// The packet of these faces, at least one and at most eight, whose packed boxes `bounds` holds.
    pub(crate) fn new(faces: &[[u32; 3]], chosen: &[u32], positions: &Positions, frame: &PackedFrame, bounds: &Aabb) -> Self {
        let anchor: [f32; 3] = std::array::from_fn(|axis| 0.5 * (bounds.min[axis] + bounds.max[axis]));
        let mut packet = Self {
            corners: [[[0.0; LANES]; 3]; 3],
            anchor,
            radius: 0.0,
            count: chosen.len() as u32,
            reserved: [0; 3],
        };
        for lane in 0..LANES {
            let face = faces[chosen[if lane < chosen.len() { lane } else { 0 }] as usize];
            for (corner, &vertex) in face.iter().enumerate() {
                let packed = frame.pack(positions.get(vertex as usize));
                for axis in 0..3 {
                    let relative = (packed[axis] - f64::from(anchor[axis])) as f32;
                    packet.corners[corner][axis][lane] = relative;
                    packet.radius = packet.radius.max(relative.abs());
                }
            }
        }
        packet
    }
}
