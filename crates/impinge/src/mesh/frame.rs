//! The frame in which a mesh's boxes and packets are kept: near the origin and about one unit large, whatever the
//! mesh's own unit is and however far out it lies, so that single precision serves meshes of every size alike.

use super::positions::Vertex;
use crate::simd::by_axis;

/// `packed = (local − origin) · scale`, with a power of two for the scale, which rounds nothing.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub(crate) struct PackedFrame {
    pub(crate) origin: [f64; 3],
    pub(crate) scale: f64,
}

/// No packed coordinate is larger in magnitude: one, and what rounding may add to it.
pub(crate) const REACH: f64 = 1.0 + 1e-6;

/// What a packed coordinate in double precision may be off by: two roundings of numbers of at most [`REACH`], a
/// subtraction's relative error and, for differences too small to keep, the least subnormal number.
pub(crate) const PACKING_ERROR: f64 = 1.0 / (1_u64 << 51) as f64;

impl PackedFrame {
    /// A frame in which all vertices between these extremes are at most [`REACH`] in magnitude.
    pub(super) fn over(extremes: &Extremes) -> Self {
        let Extremes { min, max } = extremes;
        if *extremes == Extremes::NONE {
            return Self { origin: [0.0; 3], scale: 1.0 };
        }
        let origin: [f64; 3] = std::array::from_fn(|axis| min[axis] + (max[axis] - min[axis]) / 2.0);
        let extent = (0..3).map(|axis| (max[axis] - origin[axis]).max(origin[axis] - min[axis])).fold(0.0, f64::max);
        Self { origin, scale: reciprocal_power_of_two(extent) }
    }

    #[inline(always)]
    pub(crate) fn pack(&self, vertex: [f64; 3]) -> [f64; 3] {
        by_axis!(axis => (vertex[axis] - self.origin[axis]) * self.scale)
    }

    /// Where a packed point is in the mesh's own frame, to nearest.
    #[inline(always)]
    pub(super) fn unpack(&self, packed: [f64; 3]) -> [f64; 3] {
        by_axis!(axis => packed[axis] / self.scale + self.origin[axis])
    }
}

/// The least and the greatest coordinates of vertices, in the mesh's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extremes {
    min: [f64; 3],
    max: [f64; 3],
}

impl Extremes {
    /// Of no vertices.
    pub(super) const NONE: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// Of vertices none of which has a coordinate that is not a number.
    pub(super) fn of<V: Vertex>(vertices: &[V]) -> Self {
        vertices.iter().fold(Self::NONE, |all, vertex| {
            let vertex = vertex.widened();
            all.union(Self { min: vertex, max: vertex })
        })
    }

    pub(super) fn union(self, Self { min, max }: Self) -> Self {
        let lesser = |a: f64, b: f64| if a < b { a } else { b };
        let greater = |a: f64, b: f64| if a > b { a } else { b };
        Self {
            min: by_axis!(axis => lesser(min[axis], self.min[axis])),
            max: by_axis!(axis => greater(max[axis], self.max[axis])),
        }
    }
}

/// The power of two that takes `extent` into (1/2, 1], as far as powers of two go in double precision with room for
/// products; one for zero.
pub(super) fn reciprocal_power_of_two(extent: f64) -> f64 {
    const EXPONENT_LIMIT: i32 = 900;
    if extent == 0.0 {
        return 1.0;
    }
    let bits = extent.to_bits();
    let biased = (bits >> 52) as i32;
    let is_power_of_two = bits << 12 == 0;
    let exponent = biased - 1023 + i32::from(!is_power_of_two);
    f64::from_bits(((1023 - exponent.clamp(-EXPONENT_LIMIT, EXPONENT_LIMIT)) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_positions_stay_within_reach() {
        for (offset, size) in [(0.0, 1.0), (1e7, 1e-3), (-1e30, 1e30), (0.0, 1e-310), (3.0, 0.0), (1e38, 2e38)] {
            let corners = [[offset; 3], [offset + size; 3], [offset, offset - size, offset]];
            let frame = PackedFrame::over(&Extremes::of(&corners));
            for corner in corners {
                for packed in frame.pack(corner) {
                    assert!(packed.abs() <= REACH, "{corner:?} packs to {packed}");
                }
            }
        }
        assert_eq!(reciprocal_power_of_two(1.0), 1.0);
        assert_eq!(reciprocal_power_of_two(1.5), 0.5);
        assert_eq!(reciprocal_power_of_two(0.5), 2.0);
    }
}
