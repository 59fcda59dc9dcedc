//! Packets of triangles against packets in single precision: which pairs of triangles are near each other, and of these, which
//! are proved apart, proved to meet, or left open (docs/proof.md, L4).

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

/// How a guest packet lies to a host's.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlabTest {
    /// What moves the guest to the host's anchor.
    offset: [f32; 3],
    /// What the corners may be off by, then.
    error: f32,
    /// The pairs of triangles of which each reaches into the slab of the other's packet: bit `h` of byte `g` for lane `h` of the
    /// host's and `g` of the guest's.
    pub(crate) pairs: u64,
}

/// A guest packet, turned into the host's orientation but not moved: each host packet has its own anchor.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Guest {
    corners: [[[f32; LANES]; 3]; 3],
    boxes: BoxLanes,
    /// The greatest extent of each triangle's box.
    width: [f32; LANES],
    /// All bits of the byte of each lane that holds a triangle.
    lanes_in_use: u64,
    /// The anchor's image in the host's packed frame.
    local_origin: [f64; 3],
    /// What the corners may be off by once they are moved to a host anchor, but for the part that grows with the
    /// host's radius.
    error: f32,
    /// A direction in the host's frame, and the least and greatest height of the corners along it.
    normal: [f32; 3],
    heights: [f32; 2],
    /// Bounds of the packet in the host's packed frame.
    pub(crate) bounds: Aabb,
}

impl Guest {
    /// No triangles.
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

    /// Turns a packet; `back` relates the meshes the other way round.
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
        self.local_origin = relation.apply(packet.anchor);
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

    /// The corners about [`anchor`](Self::anchor), in the host's orientation.
    #[inline(always)]
    pub(in crate::mesh) fn corners<S: Simd>(&self, simd: S) -> [Lanes3<S>; 3] {
        by_axis!(corner => load3(simd, &self.corners[corner]))
    }

    /// Where the corners are about, in the host's packed frame.
    pub(in crate::mesh) fn local_origin(&self) -> [f64; 3] {
        self.local_origin
    }

    /// What anchor and corners may be off by together.
    pub(super) fn corner_error(&self) -> f64 {
        f64::from(self.error)
    }

    /// How the packet, its triangles in `lanes`, lies to a host's.
    ///
    /// Whether a pair goes on from here to [`meet`](Self::meet), as half do, cannot be foreseen: asked of many pairs before any goes
    /// on, the processor works ahead on the next ones. Only surfaces that lie along each other have few whose first slab holds
    /// anything of the other.
    #[inline(always)]
    pub(crate) fn test_slabs<S: Simd>(&self, simd: S, host: &Packet<'_>, lanes: u32) -> SlabTest {
        let offset: [f32; 3] = by_axis!(axis => (self.local_origin[axis] - host.anchor[axis]) as f32);
        // Of the host's corners: their own rounding, and two of sums with an offset of up to the host's radius.
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

    /// Takes on the pairs of triangles of a host leaf and this one that face each other and whose boxes overlap, 64 at most.
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
        // About the guest's anchor, as its boxes lie in memory, from where one at a time is asked for.
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

/// The lanes whose corners, moved by `offset`, are proved outside the slab of `heights` along `normal`, when the corners
/// of either side may be off by `error`.
///
/// The corners that matter are no larger than the radius that `error` allows nine and four roundings for, so that
/// the five roundings of a height, and the seven of the offset's, which is no larger, are less than twice the error.
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

/// The least and the greatest height of the corners of each triangle along a direction.
#[inline(always)]
fn heights<S: Simd>(simd: S, corners: &[Lanes3<S>; 3], normal: [f32; 3]) -> (f32x8<S>, f32x8<S>) {
    let normal: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, normal[axis]));
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => dot(&normal, &corners[corner]));
    (p.min(q).min(r), p.max(q).max(r))
}

#[inline(always)]
fn bounds<S: Simd>(corners: &[Lanes3<S>; 3]) -> (Lanes3<S>, Lanes3<S>) {
    let [p, q, r] = corners;
    (by_axis!(axis => p[axis].min(q[axis]).min(r[axis])), by_axis!(axis => p[axis].max(q[axis]).max(r[axis])))
}

/// The greatest extent of a box.
#[inline(always)]
fn width<S: Simd>(min: &Lanes3<S>, max: &Lanes3<S>) -> f32x8<S> {
    let [x, y, z] = sub(max, min);
    x.max(y).max(z)
}

#[cfg(test)]
mod tests;
