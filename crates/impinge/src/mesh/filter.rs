//! Triangles against packets of triangles in single precision: proved apart, proved to meet, or open.
//!
//! Source: Devillers, Guigue, *Faster triangle-triangle intersection tests*, INRIA RR-4488, 2002, on eight lanes; ours
//! departs in that every sign comes with a bound of its error (docs/proof.md, L4), and a lane whose signs are not all certain
//! stays open.
//!
//! # The bound of a determinant
//! Every determinant here is (e × f) · d with edges e, f of two triangles and d from a corner of one to a corner of the
//! other. Write u = 2^-24, ε for the sum of what the corners of the two triangles may be off by, and let
//! X ≥ |e| + 4ε, Z ≥ |f| + 4ε and Y ≥ |d| + 4ε bound the components. An edge is off by at most 2ε + uX, d by ε + uY.
//! Then e × f is off by at most 4ε(X + Z) + 10uXZ, the 4ε in X and Z paying for products of errors, and the dot product
//! with its own four roundings by at most
//!
//! ε (6XZ + 15Y(X + Z)) + 68 u XYZ.
//!
//! The code takes 16 for 15 and 72 for 68, which pays for evaluating the bound. ε is at least 2^-40, so that the bound
//! is above what products too small for single precision lose (at most 2^-146 (1 + X + Y + Z) against 2^-111 Y). A
//! bound or determinant that overflows compares as *open*.

mod across;
mod together;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use super::packet::Packet;
use super::relation::{CornerError, GROWN, Relation};
use super::triangles::Triangles;
use crate::hierarchy::{BoxLanes, HALF_ULP, overlapping_each};
use crate::simd::{
    ALL_LANES, LANES, Lanes3, by_axis, cross, dot, each_byte, load, load3, outlined, spread_to_bytes, store3, sub,
};
use crate::volume::Aabb;
use across::{CROWDED, apart_across, near_across};
use together::Together;

/// The pairs of triangles of two packets that are proved to meet, and those that are left open: bit `h` of byte `g` for lane
/// `h` of the host's and `g` of the guest's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Verdicts {
    pub(crate) meet: u64,
    pub(crate) open: u64,
}

/// How a guest packet lies to a host's.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Facing {
    /// What moves the guest to the host's anchor.
    offset: [f32; 3],
    /// What the corners may be off by, then.
    error: f32,
    /// The pairs of triangles of which each reaches into the slab of the other's packet, as [`Verdicts`] has them.
    pub(crate) pairs: u64,
}

/// A guest packet, turned into the host's orientation but not moved: each host packet has its own anchor.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Guest {
    corners: [[[f32; LANES]; 3]; 3],
    normal: [[f32; LANES]; 3],
    min: [[f32; LANES]; 3],
    max: [[f32; LANES]; 3],
    /// The greatest extent of each triangle's box.
    width: [f32; LANES],
    /// All bits of the byte of each lane that holds a triangle.
    lanes_in_use: u64,
    /// The anchor's image in the host's packed frame.
    anchor: [f64; 3],
    /// What the corners may be off by once they are moved to a host anchor, but for the part that grows with the
    /// host's radius.
    error: f32,
    /// A direction in the host's frame, and the least and greatest height of the corners along it.
    across: [f32; 3],
    heights: [f32; 2],
    /// Bounds of the packet in the host's packed frame.
    pub(crate) bounds: Aabb,
}

impl Guest {
    /// No triangles.
    pub(crate) const EMPTY: Self = Self {
        corners: [[[0.0; LANES]; 3]; 3],
        normal: [[0.0; LANES]; 3],
        min: [[0.0; LANES]; 3],
        max: [[0.0; LANES]; 3],
        width: [0.0; LANES],
        lanes_in_use: 0,
        anchor: [0.0; 3],
        error: f32::INFINITY,
        across: [0.0; 3],
        heights: [f32::NEG_INFINITY, f32::INFINITY],
        bounds: Aabb::EMPTY,
    };

    /// Turns a packet; `back` relates the meshes the other way round.
    #[inline(always)]
    pub(crate) fn take_up<S: Simd>(&mut self, simd: S, packet: &Packet<'_>, relation: &Relation, back: &Relation) {
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
        store3(&min, &mut self.min);
        store3(&max, &mut self.max);
        store3(&cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0])), &mut self.normal);
        width(&min, &max).store_slice(&mut self.width);
        self.lanes_in_use = u64::MAX >> (u64::BITS - LANES as u32 * packet.lanes_in_use().count_ones()).min(63);
        self.anchor = relation.apply(packet.anchor);
        let CornerError { per_radius, constant, of_bounds } = relation.corner_error;
        self.error = per_radius * packet.radius + constant;
        self.across = back.turn_back(packet.normal());
        let (low, high) = heights(simd, &corners, self.across);
        self.heights = [low.reduce_min(), high.reduce_max()];
        let slack = self.error * GROWN + of_bounds;
        self.bounds = Aabb {
            min: by_axis!(axis => self.anchor[axis] as f32 + (min[axis].reduce_min() - slack)),
            max: by_axis!(axis => self.anchor[axis] as f32 + (max[axis].reduce_max() + slack)),
        };
    }

    /// The corners about [`anchor`](Self::anchor), in the host's orientation.
    #[inline(always)]
    pub(super) fn corners<S: Simd>(&self, simd: S) -> [Lanes3<S>; 3] {
        by_axis!(corner => load3(simd, &self.corners[corner]))
    }

    /// Where the corners are about, in the host's packed frame.
    pub(super) fn anchor(&self) -> [f64; 3] {
        self.anchor
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
    pub(crate) fn face<S: Simd>(&self, simd: S, host: &Packet<'_>, lanes: u32) -> Facing {
        let offset: [f32; 3] = by_axis!(axis => (self.anchor[axis] - host.anchor[axis]) as f32);
        // Of the host's corners: their own rounding, and two of sums with an offset of up to the host's radius.
        let error = self.error + 4.0 * HALF_ULP as f32 * host.radius;
        let guest_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &self.corners[corner]));
        let guest_lanes = !outside(simd, &guest_corners, offset, host.normal(), host.heights, error) & lanes;
        if guest_lanes == 0 {
            return Facing::default();
        }
        let host_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &host.corners[corner]));
        let back = by_axis!(axis => -offset[axis]);
        let host_lanes = host.lanes_in_use() & !outside(simd, &host_corners, back, self.across, self.heights, error);
        let pairs = each_byte(host_lanes) & spread_to_bytes(guest_lanes) & self.lanes_in_use;
        Facing { offset, error, pairs }
    }

    /// Meets the triangles of a host leaf that the packet faces.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(&self, simd: S, host: &Triangles, facing: &Facing) -> Verdicts {
        outlined(
            simd,
            #[inline(always)]
            || self.judge(simd, host, facing),
        )
    }

    #[inline(always)]
    fn judge<S: Simd>(&self, simd: S, host: &Triangles, &Facing { offset, error, pairs }: &Facing) -> Verdicts {
        let host_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &host.corners[corner]));
        let offset: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, offset[axis]));
        let (host_min, host_max) = bounds(&host_corners);
        let slack = f32x8::splat(simd, error * GROWN);
        let mut moved = BoxLanes::default();
        for axis in 0..3 {
            (load(simd, &self.min[axis]) + offset[axis] - slack).store_slice(&mut moved.min[axis]);
            (load(simd, &self.max[axis]) + offset[axis] + slack).store_slice(&mut moved.max[axis]);
        }
        let mut near = overlapping_each(simd, (&host_min, &host_max), &moved) & pairs;
        let mut verdicts = Verdicts::default();
        if near == 0 {
            return verdicts;
        }
        let host_width: [f32; LANES] = width(&host_min, &host_max).into();
        let error = f32x8::splat(simd, error);
        if near.count_ones() >= CROWDED {
            let guest_corners: [Lanes3<S>; 3] = by_axis!(corner => {
                by_axis!(axis => load(simd, &self.corners[corner][axis]) + offset[axis])
            });
            near &= near_across(&host_corners, &guest_corners, error);
        }
        // On average five pairs are near, of three triangles on either side: side by side, they seldom fill more than one
        // vector, where each triangle of one side would take one for itself.
        while near != 0 {
            let together = Together::take(&mut near);
            let host = together.hosts(simd, &host.corners, &host_width);
            let guest = together.guests(simd, self, &offset);
            let [meet, open] = judge(&host, &guest, error);
            verdicts.meet |= together.bits(simd, meet);
            verdicts.open |= together.bits(simd, open);
        }
        verdicts
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

struct Triangle<S: Simd> {
    corners: [Lanes3<S>; 3],
    normal: Lanes3<S>,
    width: f32x8<S>,
}

/// Judges eight pairs of triangles whose boxes overlap: the lanes of those that meet, and of those that are left open.
#[inline(always)]
fn judge<S: Simd>(host: &Triangle<S>, guest: &Triangle<S>, error: f32x8<S>) -> [u32; 2] {
    let margin = error * 4.0;
    let (x, z) = (host.width + margin, guest.width + margin);
    // Corners of boxes that overlap when grown by the error are no farther apart than both widths and that.
    let y = host.width + guest.width + margin + margin;
    let host_plane = bound(error, x, x, y);
    let guest_plane = bound(error, z, z, y);

    let guest_heights: [f32x8<S>; 3] =
        by_axis!(corner => dot(&host.normal, &sub(&guest.corners[corner], &host.corners[0])));
    let host_heights: [f32x8<S>; 3] =
        by_axis!(corner => dot(&guest.normal, &sub(&host.corners[corner], &guest.corners[0])));
    let apart = one_sided(&guest_heights, host_plane) | one_sided(&host_heights, guest_plane);
    let near = !(apart.to_bitmask() as u32) & ALL_LANES;
    if near == 0 {
        return [0, 0];
    }
    let certain = all_certain(&guest_heights, host_plane) & all_certain(&host_heights, guest_plane);

    // Each triangle's corner that is alone on its side of the other's plane comes first, and a triangle is turned
    // over where the other's lone corner lies below it.
    let (host_lone, guest_lone) = (Lone::of(&host_heights), Lone::of(&guest_heights));
    let zero = f32x8::splat(error.token(), 0.0);
    let (host_first, host_rest) = host_lone.canonical(&host.corners, guest_lone.height.simd_lt(zero));
    let (guest_first, guest_rest) = guest_lone.canonical(&guest.corners, host_lone.height.simd_lt(zero));
    let between = sub(&guest_first, &host_first);
    let edge_bound = bound(error, x, z, y);
    let start = dot(&cross(&sub(&host_rest[0], &host_first), &sub(&guest_rest[0], &guest_first)), &between);
    let end = dot(&cross(&sub(&host_rest[1], &host_first), &sub(&guest_rest[1], &guest_first)), &between);
    let meets = certain & start.simd_gt(edge_bound) & end.simd_lt(-edge_bound);
    let misses = certain & (start.simd_lt(-edge_bound) | end.simd_gt(edge_bound));
    let meets = meets.to_bitmask() as u32 & near;
    let misses = misses.to_bitmask() as u32;
    let open = near & !meets & !misses;
    if open == 0 {
        return [meets, 0];
    }
    [meets, open & !apart_across(&host.corners, &guest.corners, error)]
}

/// The bound of a determinant's error; see the head of this file.
#[inline(always)]
fn bound<S: Simd>(error: f32x8<S>, x: f32x8<S>, z: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    let product = x * z;
    let rounding = f32x8::splat(error.token(), 72.0 * HALF_ULP as f32);
    let edges = product.mul_add(f32x8::splat(error.token(), 6.0), y * (x + z) * 16.0);
    error.mul_add(edges, rounding * product * y)
}

/// Which corner is alone on its side of the other's plane, by lane; the first unless a mask says otherwise. Only
/// meaningful where the three heights are not all of one sign.
struct Lone<S: Simd> {
    second: mask32x8<S>,
    third: mask32x8<S>,
    height: f32x8<S>,
}

impl<S: Simd> Lone<S> {
    #[inline(always)]
    fn of(heights: &[f32x8<S>; 3]) -> Self {
        let zero = f32x8::splat(heights[0].token(), 0.0);
        let above: [mask32x8<S>; 3] = by_axis!(corner => heights[corner].simd_gt(zero));
        let second = (above[1] ^ above[0]) & (above[1] ^ above[2]);
        let third = (above[2] ^ above[0]) & (above[2] ^ above[1]);
        Self { second, third, height: second.select(heights[1], third.select(heights[2], heights[0])) }
    }

    /// The lone corner, and the other two in turn, or in reverse where the triangle is turned `over`.
    #[inline(always)]
    fn canonical(&self, corners: &[Lanes3<S>; 3], over: mask32x8<S>) -> (Lanes3<S>, [Lanes3<S>; 2]) {
        let [p, q, r] = corners;
        let first = by_axis!(axis => self.second.select(q[axis], self.third.select(r[axis], p[axis])));
        let next: Lanes3<S> = by_axis!(axis => self.second.select(r[axis], self.third.select(p[axis], q[axis])));
        let last: Lanes3<S> = by_axis!(axis => self.second.select(p[axis], self.third.select(q[axis], r[axis])));
        let turned = [
            by_axis!(axis => over.select(last[axis], next[axis])),
            by_axis!(axis => over.select(next[axis], last[axis])),
        ];
        (first, turned)
    }
}

/// Lanes in which all three heights are certainly on one side.
#[inline(always)]
fn one_sided<S: Simd>(heights: &[f32x8<S>; 3], bound: f32x8<S>) -> mask32x8<S> {
    let [a, b, c] = *heights;
    (a.simd_gt(bound) & b.simd_gt(bound) & c.simd_gt(bound))
        | (a.simd_lt(-bound) & b.simd_lt(-bound) & c.simd_lt(-bound))
}

/// Lanes in which all three signs are certain.
#[inline(always)]
fn all_certain<S: Simd>(heights: &[f32x8<S>; 3], bound: f32x8<S>) -> mask32x8<S> {
    heights[0].abs().simd_gt(bound) & heights[1].abs().simd_gt(bound) & heights[2].abs().simd_gt(bound)
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
