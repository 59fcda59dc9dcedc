//! Packets: the triangles of one leaf side by side for the vector unit, in single precision about an anchor of their
//! own, for rejecting and confirming in bulk. What they leave open is decided on the stored vertices.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::{PACKING_ERROR, PackedFrame};
use super::positions::Vertex;
use crate::hierarchy::{HALF_ULP, Slab};
use crate::simd::{LANES, Lanes3, by_axis, load3, sub};
use crate::volume::Aabb;

/// Up to eight triangles; unused lanes repeat the first one.
///
/// A corner is `anchor + corners[..]` in the packed frame, up to `HALF_ULP · radius` for its rounding to single
/// precision and [`PACKING_ERROR`] for the arithmetic before that.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(32))]
pub(crate) struct Packet {
    /// `corners[corner][axis][lane]`, relative to the anchor.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
    /// A point amid the triangles, in the packed frame, exactly.
    pub(crate) anchor: [f32; 3],
    /// The greatest magnitude of the relative coordinates.
    pub(crate) radius: f32,
    /// The slab about the relative corners: their least and greatest height along [`normal`](Self::normal).
    pub(crate) heights: [f32; 2],
    normal: [i16; 3],
    count: u16,
    /// Which face each lane is.
    pub(crate) faces: [u32; LANES],
}

/// The unit of a packet's normal.
const NORMAL_STEP: f32 = 1.0 / (1 << 14) as f32;

impl Packet {
    /// The bits of the lanes that hold a triangle.
    #[inline(always)]
    pub(crate) fn lanes_in_use(&self) -> u32 {
        (1 << usize::from(self.count).min(LANES)) - 1
    }

    /// The direction of the slab about the corners, mostly that in which the triangles face; no component is larger than
    /// one in magnitude, and none is rounded.
    #[inline(always)]
    pub(crate) fn normal(&self) -> [f32; 3] {
        by_axis!(axis => f32::from(self.normal[axis]) * NORMAL_STEP)
    }

    /// The normal, and the least and greatest height along it of all that the packet stands for, about the anchor, outward.
    #[inline(always)]
    pub(crate) fn slab(&self) -> ([f64; 3], [f64; 2]) {
        let [low, high] = self.heights.map(f64::from);
        let error = 3.0 * (HALF_ULP * f64::from(self.radius) + PACKING_ERROR);
        (self.normal().map(f64::from), [low - error, high + error])
    }

    /// A packet that is [laid out](Self::lay).
    pub(super) fn holding(held: &[u32]) -> Self {
        let mut packet: Self = bytemuck::Zeroable::zeroed();
        packet.lay(held);
        packet
    }

    /// Lays the packet out: it holds these faces, at least one and at most eight. All else follows from where they are, and means
    /// nothing until it is [fitted](Self::fit).
    pub(super) fn lay(&mut self, held: &[u32]) {
        self.faces = [held[0]; LANES];
        self.faces[..held.len()].copy_from_slice(held);
        self.count = held.len() as u16;
    }

    /// The faces that it holds; the first one where it says that it holds none.
    pub(super) fn held(&self) -> &[u32] {
        &self.faces[..usize::from(self.count).clamp(1, LANES)]
    }

    /// Whether lanes that hold no face of their own repeat the first, and no other does.
    pub(super) fn is_layout_sound(&self) -> bool {
        (1..=LANES).contains(&usize::from(self.count))
            && (1..LANES).all(|lane| (self.faces[lane] == self.faces[0]) == (lane >= usize::from(self.count)))
    }

    /// Fits all to where the vertices of the faces are, and returns bounds of them as a builder is given them (see
    /// [`FaceBoxes`](super::face_boxes::FaceBoxes)).
    #[inline(always)]
    pub(super) fn fit<S: Simd, V: Vertex>(
        &mut self,
        simd: S,
        frame: &PackedFrame,
        vertices: &[V],
        faces: &[[u32; 3]],
    ) -> Aabb {
        let packed = self.packed(frame, vertices, faces);
        let mut bounds = Aabb::EMPTY;
        for axis in 0..3 {
            let mut rounded = [[0.0_f32; LANES]; 3];
            for corner in 0..3 {
                for lane in 0..LANES {
                    rounded[corner][lane] = packed[corner][axis][lane] as f32;
                }
            }
            let [p, q, r] = load3(simd, &rounded);
            bounds.min[axis] = p.min(q).min(r).reduce_min();
            bounds.max[axis] = p.max(q).max(r).reduce_max();
        }
        let bounds = bounds.next_outward();
        self.fit_within(simd, &bounds, &packed);
        bounds
    }

    /// The corners of the faces, `[corner][axis][lane]`, in the packed frame.
    #[inline(always)]
    fn packed<V: Vertex>(&self, frame: &PackedFrame, vertices: &[V], faces: &[[u32; 3]]) -> [[[f64; LANES]; 3]; 3] {
        let mut packed = [[[0.0_f64; LANES]; 3]; 3];
        for lane in 0..LANES {
            let face = &faces[self.faces[lane] as usize];
            for corner in 0..3 {
                let vertex = vertices[face[corner] as usize].widened();
                for axis in 0..3 {
                    packed[corner][axis][lane] = vertex[axis];
                }
            }
        }
        for corner in 0..3 {
            for axis in 0..3 {
                let origin = frame.origin[axis];
                for lane in 0..LANES {
                    packed[corner][axis][lane] = (packed[corner][axis][lane] - origin) * frame.scale;
                }
            }
        }
        packed
    }

    /// Fits all to these corners, which are within `bounds`.
    ///
    /// No operation is fused, so that the bits are the same on every vector unit.
    #[inline(always)]
    fn fit_within<S: Simd>(&mut self, simd: S, bounds: &Aabb, packed: &[[[f64; LANES]; 3]; 3]) {
        self.anchor = by_axis!(axis => 0.5 * (bounds.min[axis] + bounds.max[axis]));
        for corner in 0..3 {
            for axis in 0..3 {
                let anchor = f64::from(self.anchor[axis]);
                for lane in 0..LANES {
                    self.corners[corner][axis][lane] = (packed[corner][axis][lane] - anchor) as f32;
                }
            }
        }
        let corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &self.corners[corner]));
        let mut largest = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            for corner in &corners {
                largest = largest.max(corner[axis].abs());
            }
        }
        self.radius = largest.reduce_max();
        self.normal = direction(&corners);
        self.heights = heights(simd, &corners, self.normal(), self.radius);
    }

    /// The least and the greatest height of all that the packet stands for along a direction no component of which is
    /// larger than one, in the packed frame, outward.
    #[inline(always)]
    pub(crate) fn heights_along<S: Simd>(&self, simd: S, normal: [f32; 3]) -> [f64; 2] {
        let corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &self.corners[corner]));
        let [low, high] = heights(simd, &corners, normal, self.radius);
        let [x, y, z] = by_axis!(axis => f64::from(normal[axis]) * f64::from(self.anchor[axis]));
        let anchor = x + y + z;
        // Three components' worth of what a corner may be off by, and of what the sums here may.
        let error = 3.0 * (2.0 * HALF_ULP * f64::from(self.radius) + 2.0 * PACKING_ERROR);
        [anchor + f64::from(low) - error, anchor + f64::from(high) + error]
    }
}

/// The direction in which the triangles face, weighted by their areas; zero if in none.
#[inline(always)]
fn direction<S: Simd>(corners: &[Lanes3<S>; 3]) -> [i16; 3] {
    let (e, f) = (sub(&corners[1], &corners[0]), sub(&corners[2], &corners[0]));
    let areas = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let sum = by_axis!(axis => sum(areas[axis]));
    let [x, y, z] = by_axis!(axis => sum[axis].abs());
    let largest = x.max(y).max(z);
    let scale = 1.0 / (largest * NORMAL_STEP);
    if scale.is_finite() && largest.is_finite() { by_axis!(axis => (sum[axis] * scale) as i16) } else { [0; 3] }
}

/// The sum of the lanes, in an order that is the same on every vector unit.
#[inline(always)]
fn sum<S: Simd>(lanes: f32x8<S>) -> f32 {
    let [a, b, c, d, e, f, g, h] = <[f32; LANES]>::from(lanes);
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

/// The least and the greatest height of corners of at most this radius along a direction, outward: five roundings of
/// sums of three products of at most the radius.
#[inline(always)]
fn heights<S: Simd>(simd: S, corners: &[Lanes3<S>; 3], normal: [f32; 3], radius: f32) -> [f32; 2] {
    let normal: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, normal[axis]));
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => {
        let at = &corners[corner];
        normal[0] * at[0] + normal[1] * at[1] + normal[2] * at[2]
    });
    let error = 20.0 * HALF_ULP as f32 * radius + f32::MIN_POSITIVE;
    [p.min(q).min(r).reduce_min() - error, p.max(q).max(r).reduce_max() + error]
}

/// The slab about some packets, across the mean of the directions in which they face.
#[inline(always)]
pub(super) fn slab<S: Simd>(simd: S, packets: &[Packet]) -> Slab {
    let mut sum = [0.0_f32; 3];
    for packet in packets {
        let facing = packet.normal();
        for axis in 0..3 {
            sum[axis] += facing[axis];
        }
    }
    let largest = sum.iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
    if largest == 0.0 {
        return Slab::ALL;
    }
    let normal = sum.map(|x| x / largest);
    let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
    for packet in packets {
        let [low, high] = packet.heights_along(simd, normal);
        min = min.min(low);
        max = max.max(high);
    }
    Slab { normal, min: (min as f32).next_down(), max: (max as f32).next_up() }
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::mesh::frame::Extremes;
    use crate::simd::{Level, levels};

    #[test]
    fn a_packet_holds_its_triangles_and_bounds_them() {
        let mut rng = Rng::new(151);
        for round in 0..500 {
            let count = rng.integer(1, 8) as usize;
            let (centre, size) = ([0; 3].map(|_| rng.uniform(-9.0, 9.0)), 2.0_f64.powi(-(round % 20)));
            let vertices: Vec<[f64; 3]> =
                (0..24).map(|_| std::array::from_fn(|axis| centre[axis] + rng.uniform(-size, size))).collect();
            let frame = PackedFrame::over(&Extremes::of(&[&vertices[..], &[[-10.0; 3], [10.0; 3]]].concat()));
            let faces: Vec<[u32; 3]> = (0..8).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let held: Vec<u32> = (0..count as u32).rev().collect();
            let packed = |face: u32, corner: usize| frame.pack(vertices[faces[face as usize][corner] as usize]);
            let bounds = held.iter().fold(Aabb::EMPTY, |bounds, &face| {
                bounds.union(Aabb::of_points([0, 1, 2].map(|corner| packed(face, corner).map(|x| x as f32))))
            });
            let packets = levels().into_iter().map(|(name, level)| {
                let mut packet = Packet::holding(&held);
                let fitted = dispatch!(level, simd => packet.fit(simd, &frame, &vertices, &faces));
                assert_eq!((packet.held(), fitted), (&held[..], bounds.next_outward()), "{name}");
                (name, packet)
            });
            let packets: Vec<(&str, Packet)> = packets.collect();
            let (_, packet) = packets[0];
            for (name, other) in &packets {
                assert_eq!(bytemuck::bytes_of(other), bytemuck::bytes_of(&packet), "{name}: other bits");
            }
            assert_eq!(packet.lanes_in_use(), (1 << count) - 1);
            let normal = packet.normal();
            assert!(normal.iter().any(|x| x.abs() > 0.99) && normal.iter().all(|x| x.abs() <= 1.0), "{normal:?}");
            let [low, high] = dispatch!(Level::fallback(), simd => packet.heights_along(simd, normal));
            for lane in 0..LANES {
                let face = if lane < count { held[lane] } else { held[0] };
                assert_eq!(packet.faces[lane], face);
                for corner in 0..3 {
                    let exact = packed(face, corner);
                    let mut height = 0.0;
                    let mut relative_height = 0.0;
                    for axis in 0..3 {
                        let relative = packet.corners[corner][axis][lane];
                        assert!(relative.abs() <= packet.radius);
                        let off = (f64::from(packet.anchor[axis]) + f64::from(relative) - exact[axis]).abs();
                        assert!(off <= HALF_ULP * f64::from(packet.radius) + PACKING_ERROR, "off by {off}");
                        height += f64::from(normal[axis]) * exact[axis];
                        relative_height += f64::from(normal[axis]) * f64::from(relative);
                    }
                    assert!(low <= height && height <= high, "{height} is not in {low}..{high}");
                    let [low, high] = packet.heights.map(f64::from);
                    assert!(low <= relative_height && relative_height <= high);
                }
            }
            assert!(high - low < 8.0 * f64::from(packet.radius), "a slab as thick as {}", high - low);
        }
    }
}
