//! Compares packets of triangles with packets in single precision. It finds the pairs of triangles
//! whose boxes overlap, and classifies them: apart, intersecting or undecided (docs/notes/proof.md,
//! L4).
//!
//! Guarded by the tests in `filter/tests.rs`, by `engine/triangle_pairs.rs` and `engine/laws.rs`,
//! and by the benchmark `headline`.

mod across;
mod candidates;
mod classify;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::relation::{CornerError, ERROR_GROWTH, Relation};
use crate::hierarchy::{BoxLanes, HALF_ULP, overlapping_pairs};
use crate::mesh::storage::packet::Packet;
use crate::mesh::storage::triangles::Triangles;
use crate::simd::{LANES, Lanes3, by_axis, dot, each_byte, load, load3, outlined, spread_to_bytes, store3, sub};
use crate::volume::Aabb;
use across::{MIN_CROWDED_PAIRS, near_along_edge_cross};

pub(crate) use candidates::{Candidates, LeafFaces, Verdicts};

/// Result of testing a guest packet and a host packet against the slabs of each other.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlabTest {
    /// Vector from the local origin of the host packet to that of the guest packet, in the packed
    /// frame of the host. Adding it to guest corners makes them relative to the host's local
    /// origin.
    offset: [f32; 3],
    /// Error bound of the corners of both packets together, relative to the host's local origin.
    error: f32,
    /// The pairs of triangles that both reach into the slab of the other packet. Bit `h` of byte
    /// `g` is the pair of host lane `h` and guest lane `g`.
    pub(crate) pairs: u64,
}

/// A guest packet, mapped by the linear part of a relation into the host's packed frame but not
/// translated, as each host packet has its own local origin.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Guest {
    /// Corners relative to `local_origin`, `[corner][axis][lane]`.
    corners: [[[f32; LANES]; 3]; 3],
    /// Box of each triangle, relative to `local_origin`.
    boxes: BoxLanes,
    /// Maximum extent of each triangle's box.
    width: [f32; LANES],
    /// All bits of the byte of each lane that holds a triangle.
    lanes_in_use: u64,
    /// Image of the packet's local origin in the packed frame of the host.
    local_origin: [f64; 3],
    /// Error bound of the corners once they are moved to a host's local origin, without the part
    /// that grows with the radius of the host packet.
    error: f32,
    /// Normal of the packet's slab in the host's frame.
    normal: [f32; 3],
    /// Minimum and maximum height of the corners above `local_origin` along `normal`.
    heights: [f32; 2],
    /// Bounds of the packet in the packed frame of the host, rounded outward.
    pub(crate) bounds: Aabb,
}

impl Guest {
    /// A packet without triangles.
    pub(crate) const EMPTY: Self = Self {
        corners: [[[0.0; LANES]; 3]; 3],
        boxes: BoxLanes { min: [[0.0; LANES]; 3], max: [[0.0; LANES]; 3] },
        width: [0.0; LANES],
        lanes_in_use: 0,
        local_origin: [0.0; 3],
        error: f32::INFINITY,
        normal: [0.0; 3],
        heights: [f32::NEG_INFINITY, f32::INFINITY],
        bounds: Aabb::EMPTY,
    };

    /// Sets this to a guest packet, mapped by the linear part of `relation`. `back` maps the other
    /// way, from the host to the guest.
    #[inline(always)]
    pub(crate) fn set_packet<S: Simd>(&mut self, simd: S, packet: &Packet<'_>, relation: &Relation, back: &Relation) {
        outlined(
            simd,
            #[inline(always)]
            || self.turn(simd, packet, relation, back),
        );
    }

    #[inline(always)]
    fn turn<S: Simd>(&mut self, simd: S, packet: &Packet<'_>, relation: &Relation, back: &Relation) {
        let linear: [Lanes3<S>; 3] =
            by_axis!(row => by_axis!(column => f32x8::splat(simd, relation.linear[row][column] as f32)));
        let corners: [Lanes3<S>; 3] = by_axis!(corner => {
            let from = load3(simd, &packet.corners[corner]);
            by_axis!(axis => dot(&linear[axis], &from))
        });
        let (min, max) = bounds(&corners);
        store3(&corners[0], &mut self.corners[0]);
        store3(&corners[1], &mut self.corners[1]);
        store3(&corners[2], &mut self.corners[2]);
        store3(&min, &mut self.boxes.min);
        store3(&max, &mut self.boxes.max);
        width(&min, &max).store_slice(&mut self.width);
        self.lanes_in_use = u64::MAX >> (u64::BITS - LANES as u32 * packet.lanes_in_use().count_ones()).min(63);
        self.local_origin = relation.apply(packet.local_origin);
        let CornerError { per_radius, constant, of_bounds } = relation.corner_error;
        self.error = per_radius * packet.radius + constant;
        self.normal = back.turn_back(packet.normal());
        let (low, high) = heights(simd, &corners, self.normal);
        self.heights = [low.reduce_min(), high.reduce_max()];
        let slack = self.error * ERROR_GROWTH + of_bounds;
        self.bounds = Aabb {
            min: by_axis!(axis => self.local_origin[axis] as f32 + (min[axis].reduce_min() - slack)),
            max: by_axis!(axis => self.local_origin[axis] as f32 + (max[axis].reduce_max() + slack)),
        };
    }

    /// Returns the corners relative to [`local_origin`](Self::local_origin), in the orientation of
    /// the host.
    #[inline(always)]
    pub(in crate::mesh) fn corners<S: Simd>(&self, simd: S) -> [Lanes3<S>; 3] {
        by_axis!(corner => load3(simd, &self.corners[corner]))
    }

    /// Returns the local origin of the corners, in the packed frame of the host.
    pub(in crate::mesh) fn local_origin(&self) -> [f64; 3] {
        self.local_origin
    }

    /// Returns the error bound of a corner plus the local origin.
    pub(super) fn corner_error(&self) -> f64 {
        f64::from(self.error)
    }

    /// Tests this packet, restricted to the triangles in `lanes`, and a host packet against the
    /// slabs of each other.
    ///
    /// About half of all packet pairs pass and go on to [`push_candidates`](Self::push_candidates),
    /// which the processor cannot predict. Test many pairs before any of them goes on, so that it
    /// can overlap the tests. The early return after the first slab is rare, unless the surfaces
    /// lie along each other.
    #[inline(always)]
    pub(crate) fn test_slabs<S: Simd>(&self, simd: S, host: &Packet<'_>, lanes: u32) -> SlabTest {
        let offset: [f32; 3] = by_axis!(axis => (self.local_origin[axis] - host.local_origin[axis]) as f32);
        // The host's corners are rounded themselves, and two sums with an offset of up to the
        // radius of the host packet are rounded too.
        let error = self.error + 4.0 * HALF_ULP as f32 * host.radius;
        let guest_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &self.corners[corner]));
        let guest_lanes = !outside(simd, &guest_corners, offset, host.normal(), host.heights, error) & lanes;
        if guest_lanes == 0 {
            return SlabTest::default();
        }
        let host_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &host.corners[corner]));
        let back = by_axis!(axis => -offset[axis]);
        let host_lanes = host.lanes_in_use() & !outside(simd, &host_corners, back, self.normal, self.heights, error);
        let pairs = each_byte(host_lanes) & spread_to_bytes(guest_lanes) & self.lanes_in_use;
        SlabTest { offset, error, pairs }
    }

    /// Appends to `candidates` the pairs of triangles that passed the slab test and whose boxes
    /// overlap, at most 64.
    #[inline(always)]
    pub(crate) fn push_candidates<S: Simd>(
        &self,
        simd: S,
        host: &Triangles,
        slab_test: &SlabTest,
        faces: &LeafFaces<'_>,
        candidates: &mut Candidates,
    ) {
        outlined(
            simd,
            #[inline(always)]
            || self.select(simd, host, slab_test, faces, candidates),
        );
    }

    #[inline(always)]
    fn select<S: Simd>(
        &self,
        simd: S,
        host: &Triangles,
        &SlabTest { offset, error, pairs }: &SlabTest,
        faces: &LeafFaces<'_>,
        candidates: &mut Candidates,
    ) {
        let host_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &host.corners[corner]));
        let offset: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, offset[axis]));
        let (host_min, host_max) = bounds(&host_corners);
        // Boxes of the host are moved to the guest's local origin, as the boxes of the guest are
        // read from memory one at a time.
        let slack = f32x8::splat(simd, error * ERROR_GROWTH);
        let min = by_axis!(axis => host_min[axis] - offset[axis] - slack);
        let max = by_axis!(axis => host_max[axis] - offset[axis] + slack);
        let mut near = overlapping_pairs(simd, (&min, &max), &self.boxes, pairs);
        if near == 0 {
            return;
        }
        let host_width: [f32; LANES] = width(&host_min, &host_max).into();
        let error = f32x8::splat(simd, error);
        if near.count_ones() >= MIN_CROWDED_PAIRS {
            let guest_corners: [Lanes3<S>; 3] = by_axis!(corner => {
                by_axis!(axis => load(simd, &self.corners[corner][axis]) + offset[axis])
            });
            near &= near_along_edge_cross(&host_corners, &guest_corners, error);
        }
        let leaves = candidates::LeafTriangles {
            host: (&host.corners, &host_width),
            guest: (&self.corners, &self.width),
            offset,
            error,
            faces,
        };
        while near != 0 {
            candidates.push(simd, &mut near, &leaves);
        }
    }
}

/// Returns the lanes whose corners, moved by `offset`, are proved outside the slab of `heights`
/// along `normal`, if the corners of both sides have errors of at most `error`.
///
/// The corners that matter are no larger than the radius for which `error` allows nine and four
/// roundings. A height has five roundings, and the height of the offset, which is no larger, has
/// seven. Together they are less than twice the error.
#[inline(always)]
fn outside<S: Simd>(
    simd: S,
    corners: &[Lanes3<S>; 3],
    offset: [f32; 3],
    normal: [f32; 3],
    heights: [f32; 2],
    error: f32,
) -> u32 {
    let [x, y, z] = normal;
    let slack = 4.0 * error * (x.abs() + y.abs() + z.abs());
    let moved = x * offset[0] + y * offset[1] + z * offset[2];
    let (low, high) = self::heights(simd, corners, normal);
    let above = low.simd_gt(f32x8::splat(simd, heights[1] - moved + slack));
    let below = high.simd_lt(f32x8::splat(simd, heights[0] - moved - slack));
    (above | below).to_bitmask() as u32
}

/// Returns the minimum and maximum height of the corners of each triangle along a direction.
#[inline(always)]
fn heights<S: Simd>(simd: S, corners: &[Lanes3<S>; 3], normal: [f32; 3]) -> (f32x8<S>, f32x8<S>) {
    let normal: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, normal[axis]));
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => dot(&normal, &corners[corner]));
    (p.min(q).min(r), p.max(q).max(r))
}

/// Returns the minimum and maximum coordinates of each triangle.
#[inline(always)]
fn bounds<S: Simd>(corners: &[Lanes3<S>; 3]) -> (Lanes3<S>, Lanes3<S>) {
    let [p, q, r] = corners;
    (by_axis!(axis => p[axis].min(q[axis]).min(r[axis])), by_axis!(axis => p[axis].max(q[axis]).max(r[axis])))
}

/// Returns the maximum extent of a box.
#[inline(always)]
fn width<S: Simd>(min: &Lanes3<S>, max: &Lanes3<S>) -> f32x8<S> {
    let [x, y, z] = sub(max, min);
    x.max(y).max(z)
}

#[cfg(test)]
mod tests;
