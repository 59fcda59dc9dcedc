//! The triangles of a leaf in the metric frame, in single precision about an anchor of their own, for proving in bulk that
//! pairs are too far apart to matter.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use super::bounds::{by_centres, squared_gaps};
use super::metric::MetricMap;
use crate::hierarchy::HALF_ULP;
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packet;
use crate::simd::{ALL_LANES, Choice, LANES, Lanes3, bits, by_axis, cross, dot, load3, sub};
use crate::volume::Aabb;

/// More than the roundings of a bound relative to the coordinates that go into it, in units of 2^-24: the offset and its sum
/// with a corner, and three operations of each of two dot products, along a direction whose components sum to at most √3.
/// 18 are needed, and five more along the line between anchors.
const ROUNDING: f64 = 32.0 * HALF_ULP;

/// More than what the corners of a packet of radius one may be off by on an axis of the metric frame, for each unit of
/// the map's row: the packed corner's rounding, the row's, and three products and two sums, in units of 2^-24.
const CARRIED: f64 = 8.0 * HALF_ULP;

/// Up to eight triangles in the metric frame; lanes that are not in use repeat the first.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub(super) leaf: u32,
    anchor: [f64; 3],
    /// The largest magnitude of the coordinates about the anchor.
    radius: f32,
    /// More than what they are off by.
    error: f64,
    /// `about[corner][axis][lane]`, about the anchor.
    about: [[[f32; LANES]; 3]; 3],
}

impl Leaf {
    /// Carries the packet of a leaf into the metric frame.
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, leaf: u32, packet: &Packet<'_>, mesh: &Mesh, map: &MetricMap) -> Self {
        let unit = 1.0 / mesh.0.frame.scale;
        let [x, y, z] = packet.anchor;
        let linear = map.linear.map(|row| row.map(|entry| entry * unit));
        let anchor = by_axis!(axis => {
            let row = &linear[axis];
            (row[0] * x + row[1] * y + row[2] * z) + map.offset[axis]
        });
        let mut about = [[[0.0; LANES]; 3]; 3];
        let mut largest = f32x8::splat(simd, 0.0);
        for corner in 0..3 {
            let [x, y, z] = load3(simd, &packet.corners[corner]);
            for axis in 0..3 {
                let row: Lanes3<S> = by_axis!(k => f32x8::splat(simd, linear[axis][k] as f32));
                let along = row[0] * x + row[1] * y + row[2] * z;
                largest = largest.max(along.abs());
                along.store_slice(&mut about[corner][axis]);
            }
        }
        let size = linear.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        let error = CARRIED * size * f64::from(packet.radius);
        Self { leaf, anchor, radius: largest.reduce_max(), error, about }
    }
}

/// Two leaves, the guest's triangles moved to the host's anchor.
pub(super) struct Facing<'l, S: Simd> {
    simd: S,
    host: &'l Leaf,
    guest: &'l Leaf,
    offset: [f32; 3],
    /// More than what a bound may be above the truth, in metric units.
    pub(super) slack: f32,
    host_corners: [Lanes3<S>; 3],
    host_normal: Lanes3<S>,
}

impl<'l, S: Simd> Facing<'l, S> {
    /// `error` is what metric corners and values may be off by.
    #[inline(always)]
    pub(super) fn new(simd: S, host: &'l Leaf, guest: &'l Leaf, error: f64) -> Self {
        let offset = by_axis!(axis => (guest.anchor[axis] - host.anchor[axis]) as f32);
        let reach =
            f64::from(host.radius + guest.radius) + offset.iter().fold(0.0, |most, x| f64::from(x.abs()).max(most));
        // An error on each of three axes moves a point by less than twice as much.
        let slack = ((ROUNDING * reach + 2.0 * (host.error + guest.error) + 4.0 * error) as f32).next_up();
        let host_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &host.about[corner]));
        let host_normal = normal(&host_corners);
        Self { simd, host, guest, offset, slack, host_corners, host_normal }
    }

    /// For each of the guest's lanes the host's, in use or not, that are not proved farther than `limit` along the line between
    /// the anchors. The square of its length and the limit add five roundings to those of [`gap_along`].
    #[inline(always)]
    pub(super) fn near_between(&self, limit: f32) -> [u32; LANES] {
        let simd = self.simd;
        let [x, y, z] = self.offset;
        let squared = x * x + y * y + z * z;
        if squared <= LEAST_SQUARE {
            return [ALL_LANES; LANES];
        }
        let direction: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, self.offset[axis]));
        let [p, q, r]: Lanes3<S> = by_axis!(corner => dot(&direction, &self.host_corners[corner]));
        let host = p.max(q).max(r);
        let [p, q, r]: Lanes3<S> = by_axis!(corner => dot(&direction, &load3(simd, &self.guest.about[corner])));
        let mut guest = [0.0; LANES];
        p.min(q).min(r).store_slice(&mut guest);
        let threshold = (limit + self.slack) * squared.sqrt() - squared;
        let mut near = [0; LANES];
        for lane in 0..LANES {
            let far = (f32x8::splat(simd, guest[lane]) - host).simd_gt(f32x8::splat(simd, threshold));
            near[lane] = !(far.to_bitmask() as u32);
        }
        near
    }

    /// The host's lanes among these whose boxes are not proved farther than `limit` from the guest's triangle in `lane`; and
    /// what says, where it is least among the guest's, that this one is worth looking at first.
    #[inline(always)]
    pub(super) fn near_boxes(&self, lane: usize, lanes: u32, limit: f32) -> (u32, f32) {
        let simd = self.simd;
        let corner = |corner: usize, axis: usize| self.guest.about[corner][axis][lane] + self.offset[axis];
        let one = Aabb {
            min: by_axis!(axis => corner(0, axis).min(corner(1, axis)).min(corner(2, axis)) - self.slack),
            max: by_axis!(axis => corner(0, axis).max(corner(1, axis)).max(corner(2, axis)) + self.slack),
        };
        let (min, max) = bounds(&self.host_corners);
        let squared = squared_gaps(simd, (&min, &max), &one);
        let limit = limit * (1.0 + 8.0 * HALF_ULP as f32);
        let far = squared.simd_gt(f32x8::splat(simd, limit * limit * (1.0 + 8.0 * HALF_ULP as f32)));
        let near = !(far.to_bitmask() as u32) & lanes;
        let mut order = [0.0; LANES];
        by_centres(simd, squared, (&min, &max), &one).store_slice(&mut order);
        (near, bits(near).fold(f32::INFINITY, |least, lane| least.min(order[lane])))
    }

    /// Lower bounds of the distances of the guest's triangle in `lane` from the host's along the normals of both, in metric
    /// units, and the lanes of `near` in which they are not above `limit`.
    #[inline(always)]
    pub(super) fn by_planes(&self, lane: usize, near: u32, limit: f32) -> ([f32; LANES], u32) {
        let simd = self.simd;
        let guest: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => {
            f32x8::splat(simd, self.guest.about[corner][axis][lane] + self.offset[axis])
        }));
        let host = &self.host_corners;
        let guest_normal = normal(&guest);
        // Along the normal of a face its corners are level, in truth; in rounded numbers they are not, and all are taken.
        let gap = gap_along(&self.host_normal, host, &guest).max(gap_along(&guest_normal, host, &guest));
        let bound = gap - f32x8::splat(simd, self.slack);
        let far = bound.simd_gt(f32x8::splat(simd, limit)).to_bitmask() as u32;
        let mut lower = [0.0; LANES];
        bound.store_slice(&mut lower);
        (lower, near & !far)
    }

    /// Lower bounds of the distances of eight pairs of triangles, by the choice of each leaf's: along the line between points
    /// that are roughly nearest.
    #[inline(always)]
    pub(super) fn by_points(&self, [hosts, guests]: [Choice; 2]) -> [f32; LANES] {
        let simd = self.simd;
        let host: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => hosts.of(simd, &self.host.about[corner][axis])));
        let guest: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => {
            guests.of(simd, &self.guest.about[corner][axis]) + f32x8::splat(simd, self.offset[axis])
        }));
        let direction = nearest_difference(&host, &guest);
        let mut lower = [0.0; LANES];
        (gap_along(&direction, &host, &guest) - f32x8::splat(simd, self.slack)).store_slice(&mut lower);
        lower
    }
}

/// How far apart two triangles are along a direction, before rounding; zero where it does not separate them or is none.
#[inline(always)]
fn gap_along<S: Simd>(direction: &Lanes3<S>, host: &[Lanes3<S>; 3], guest: &[Lanes3<S>; 3]) -> f32x8<S> {
    let zero = f32x8::splat(direction[0].token(), 0.0);
    let h: Lanes3<S> = by_axis!(corner => dot(direction, &host[corner]));
    let g: Lanes3<S> = by_axis!(corner => dot(direction, &guest[corner]));
    let (h_min, h_max) = (h[0].min(h[1]).min(h[2]), h[0].max(h[1]).max(h[2]));
    let (g_min, g_max) = (g[0].min(g[1]).min(g[2]), g[0].max(g[1]).max(g[2]));
    let gap = (g_min - h_max).max(h_min - g_max);
    let squared = dot(direction, direction);
    // Only where the square is not so small that its root would be wrong.
    let sure = gap.simd_gt(zero) & squared.simd_gt(f32x8::splat(direction[0].token(), LEAST_SQUARE));
    sure.select(gap / squared.sqrt(), zero)
}

/// Squares below this have lost digits to underflow, or their terms have: 2^-100.
const LEAST_SQUARE: f32 = 1.0 / (1_u128 << 100) as f32;

/// From the host's to the guest's nearest point, roughly: whatever it is, it only serves as a direction.
#[inline(always)]
fn nearest_difference<S: Simd>(host: &[Lanes3<S>; 3], guest: &[Lanes3<S>; 3]) -> Lanes3<S> {
    let simd = host[0][0].token();
    let (host_normal, guest_normal) = (normal(host), normal(guest));
    let zero = f32x8::splat(simd, 0.0);
    let one = f32x8::splat(simd, 1.0);
    let least = f32x8::splat(simd, f32::MIN_POSITIVE);
    let (host_edges, guest_edges) = (edges(host), edges(guest));
    let mut best = (f32x8::splat(simd, f32::INFINITY), sub(&guest[0], &host[0]));
    for i in 0..3 {
        let u = &host_edges[i];
        let uu = dot(u, u).max(least);
        for j in 0..3 {
            // Ericson, 5.1.9, without its special cases: quotients by nothing are kept finite.
            let v = &guest_edges[j];
            let vv = dot(v, v).max(least);
            let w = sub(&host[i], &guest[j]);
            let (uv, uw, vw) = (dot(u, v), dot(u, &w), dot(v, &w));
            let s = ((uv * vw - uw * vv) / (uu * vv - uv * uv).max(least)).max(zero).min(one);
            let t = ((uv * s + vw) / vv).max(zero).min(one);
            let s = ((uv * t - uw) / uu).max(zero).min(one);
            offer(&mut best, by_axis!(axis => t * v[axis] - (w[axis] + s * u[axis])));
        }
    }
    for corner in 0..3 {
        for (face, edges, normal, point, sign) in [
            (host, &host_edges, &host_normal, &guest[corner], one),
            (guest, &guest_edges, &guest_normal, &host[corner], zero - one),
        ] {
            let w = sub(point, &face[0]);
            let squared = dot(normal, normal).max(least);
            let inside: [mask32x8<S>; 3] =
                by_axis!(k => dot(&cross(&edges[k], &sub(point, &face[k])), normal).simd_ge(zero));
            let within = inside[0] & inside[1] & inside[2];
            let height = dot(&w, normal) / squared * sign;
            let difference: Lanes3<S> = by_axis!(axis => height * normal[axis]);
            let far = f32x8::splat(simd, f32::INFINITY);
            let squared = within.select(dot(&difference, &difference), far);
            choose(&mut best, squared, difference);
        }
    }
    best.1
}

#[inline(always)]
fn offer<S: Simd>(best: &mut (f32x8<S>, Lanes3<S>), difference: Lanes3<S>) {
    choose(best, dot(&difference, &difference), difference);
}

#[inline(always)]
fn choose<S: Simd>(best: &mut (f32x8<S>, Lanes3<S>), squared: f32x8<S>, difference: Lanes3<S>) {
    let nearer = squared.simd_lt(best.0);
    best.0 = nearer.select(squared, best.0);
    best.1 = by_axis!(axis => nearer.select(difference[axis], best.1[axis]));
}

#[inline(always)]
fn bounds<S: Simd>(corners: &[Lanes3<S>; 3]) -> (Lanes3<S>, Lanes3<S>) {
    let [p, q, r] = corners;
    (by_axis!(axis => p[axis].min(q[axis]).min(r[axis])), by_axis!(axis => p[axis].max(q[axis]).max(r[axis])))
}

/// Across the triangles, of any length.
#[inline(always)]
fn normal<S: Simd>(corners: &[Lanes3<S>; 3]) -> Lanes3<S> {
    cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]))
}

/// From each corner to the next.
#[inline(always)]
fn edges<S: Simd>(corners: &[Lanes3<S>; 3]) -> [Lanes3<S>; 3] {
    [sub(&corners[1], &corners[0]), sub(&corners[2], &corners[1]), sub(&corners[0], &corners[2])]
}
