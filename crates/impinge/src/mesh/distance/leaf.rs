//! The triangles of a leaf in the metric frame, in single precision relative to a local origin, for
//! proving eight pairs at a time too far apart to matter.
//!
//! Error bounds: docs/notes/proof.md, L14. Guarded by `tests/it/distance/meshes.rs`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use super::bounds::{by_centers, squared_gaps};
use super::metric::MetricMap;
use crate::hierarchy::HALF_ULP;
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packet;
use crate::simd::{ALL_LANES, Choice, LANES, Lanes3, bits, by_axis, cross, dot, load3, sub};
use crate::volume::Aabb;

/// Bound for the rounding of a distance bound, relative to the coordinates that go into it: 32
/// units of 2^-24. It pays for the offset and its sum with a corner, and for three operations of
/// each of two dot products, along a direction whose components sum to at most √3. 18 units are
/// needed, and five more along the line between the local origins.
const ROUNDING: f64 = 32.0 * HALF_ULP;

/// Error bound of a corner of a packet of radius one on an axis of the metric frame, for each unit
/// of the map's row: 8 units of 2^-24. It pays for the rounding of the packed corner and of the
/// row, three products and two sums.
const CARRYING_ERROR: f64 = 8.0 * HALF_ULP;

/// Up to eight triangles in the metric frame. Unused lanes repeat the first triangle.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub(super) leaf: u32,
    origin: [f64; 3],
    /// Maximum magnitude of the coordinates relative to the local origin.
    radius: f32,
    /// Error bound of the coordinates, in metric units.
    error: f64,
    /// `corners[corner][axis][lane]`, relative to the local origin.
    corners: [[[f32; LANES]; 3]; 3],
}

impl Leaf {
    /// Carries the packet of a leaf into the metric frame.
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, leaf: u32, packet: &Packet<'_>, mesh: &Mesh, map: &MetricMap) -> Self {
        let unit = 1.0 / mesh.0.frame.scale;
        let [x, y, z] = packet.local_origin;
        let linear = map.linear.map(|row| row.map(|entry| entry * unit));
        let origin = by_axis!(axis => {
            let row = &linear[axis];
            (row[0] * x + row[1] * y + row[2] * z) + map.offset[axis]
        });
        let mut corners = [[[0.0; LANES]; 3]; 3];
        let mut largest = f32x8::splat(simd, 0.0);
        for corner in 0..3 {
            let [x, y, z] = load3(simd, &packet.corners[corner]);
            for axis in 0..3 {
                let row: Lanes3<S> = by_axis!(k => f32x8::splat(simd, linear[axis][k] as f32));
                let along = row[0] * x + row[1] * y + row[2] * z;
                largest = largest.max(along.abs());
                along.store_slice(&mut corners[corner][axis]);
            }
        }
        let size = linear.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        let error = CARRYING_ERROR * size * f64::from(packet.radius);
        Self { leaf, origin, radius: largest.reduce_max(), error, corners }
    }
}

/// Two leaves whose triangles are compared, relative to the host's local origin.
pub(super) struct Facing<'l, S: Simd> {
    simd: S,
    host: &'l Leaf,
    guest: &'l Leaf,
    /// The guest's local origin relative to the host's, in metric units.
    offset: [f32; 3],
    /// Error bound of the distance bounds, in metric units.
    pub(super) slack: f32,
    host_corners: [Lanes3<S>; 3],
    /// Normals of the host's triangles, of any length.
    host_normal: Lanes3<S>,
}

impl<'l, S: Simd> Facing<'l, S> {
    /// Prepares the comparison of two leaves. `error` is the error bound of metric corners and
    /// values.
    #[inline(always)]
    pub(super) fn new(simd: S, host: &'l Leaf, guest: &'l Leaf, error: f64) -> Self {
        let offset = by_axis!(axis => (guest.origin[axis] - host.origin[axis]) as f32);
        let reach =
            f64::from(host.radius + guest.radius) + offset.iter().fold(0.0, |most, x| f64::from(x.abs()).max(most));
        // An error on each of three axes moves a point by less than twice as much.
        let slack = ((ROUNDING * reach + 2.0 * (host.error + guest.error) + 4.0 * error) as f32).next_up();
        let host_corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &host.corners[corner]));
        let host_normal = normal(&host_corners);
        Self { simd, host, guest, offset, slack, host_corners, host_normal }
    }

    /// Returns for each guest lane the host lanes that are not proved farther than `limit` along
    /// the line between the local origins, as bits. Unused lanes may be among them. The square of
    /// the line's length and the limit add five roundings to the roundings of [`gap_along`].
    #[inline(always)]
    pub(super) fn near_between(&self, limit: f32) -> [u32; LANES] {
        let simd = self.simd;
        let [x, y, z] = self.offset;
        let squared = x * x + y * y + z * z;
        if squared <= MIN_SQUARE {
            return [ALL_LANES; LANES];
        }
        let direction: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, self.offset[axis]));
        let [p, q, r]: Lanes3<S> = by_axis!(corner => dot(&direction, &self.host_corners[corner]));
        let host = p.max(q).max(r);
        let [p, q, r]: Lanes3<S> = by_axis!(corner => dot(&direction, &load3(simd, &self.guest.corners[corner])));
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

    /// Returns the host lanes among `lanes` whose boxes are not proved farther than `limit` from
    /// the guest's triangle in `lane`, as bits. Also returns a number by which guest lanes are
    /// ordered: the least one is worth processing first.
    #[inline(always)]
    pub(super) fn near_boxes(&self, lane: usize, lanes: u32, limit: f32) -> (u32, f32) {
        let simd = self.simd;
        let corner = |corner: usize, axis: usize| self.guest.corners[corner][axis][lane] + self.offset[axis];
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
        by_centers(simd, squared, (&min, &max), &one).store_slice(&mut order);
        (near, bits(near).fold(f32::INFINITY, |least, lane| least.min(order[lane])))
    }

    /// Computes lower bounds of the distances of the guest's triangle in `lane` from the host's
    /// triangles, in metric units, along the normals of both. Also returns the lanes of `near`
    /// whose bound is not above `limit`.
    #[inline(always)]
    pub(super) fn by_planes(&self, lane: usize, near: u32, limit: f32) -> ([f32; LANES], u32) {
        let simd = self.simd;
        let guest: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => {
            f32x8::splat(simd, self.guest.corners[corner][axis][lane] + self.offset[axis])
        }));
        let host = &self.host_corners;
        let guest_normal = normal(&guest);
        // All corners of a face have the same height along its normal, but rounded heights differ,
        // so all three are used.
        let gap = gap_along(&self.host_normal, host, &guest).max(gap_along(&guest_normal, host, &guest));
        let bound = gap - f32x8::splat(simd, self.slack);
        let far = bound.simd_gt(f32x8::splat(simd, limit)).to_bitmask() as u32;
        let mut lower = [0.0; LANES];
        bound.store_slice(&mut lower);
        (lower, near & !far)
    }

    /// Computes lower bounds of the distances of eight pairs of triangles, in metric units, along
    /// the line between points that are roughly nearest. The choices name the lanes of each leaf.
    #[inline(always)]
    pub(super) fn by_points(&self, [hosts, guests]: [Choice; 2]) -> [f32; LANES] {
        let simd = self.simd;
        let host: [Lanes3<S>; 3] =
            by_axis!(corner => by_axis!(axis => hosts.of(simd, &self.host.corners[corner][axis])));
        let guest: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => {
            guests.of(simd, &self.guest.corners[corner][axis]) + f32x8::splat(simd, self.offset[axis])
        }));
        let direction = nearest_difference(&host, &guest);
        let mut lower = [0.0; LANES];
        (gap_along(&direction, &host, &guest) - f32x8::splat(simd, self.slack)).store_slice(&mut lower);
        lower
    }
}

/// Returns how far apart two triangles are along a direction, not counting rounding. Returns zero
/// if the direction does not separate them or has no length.
#[inline(always)]
fn gap_along<S: Simd>(direction: &Lanes3<S>, host: &[Lanes3<S>; 3], guest: &[Lanes3<S>; 3]) -> f32x8<S> {
    let zero = f32x8::splat(direction[0].token(), 0.0);
    let h: Lanes3<S> = by_axis!(corner => dot(direction, &host[corner]));
    let g: Lanes3<S> = by_axis!(corner => dot(direction, &guest[corner]));
    let (h_min, h_max) = (h[0].min(h[1]).min(h[2]), h[0].max(h[1]).max(h[2]));
    let (g_min, g_max) = (g[0].min(g[1]).min(g[2]), g[0].max(g[1]).max(g[2]));
    let gap = (g_min - h_max).max(h_min - g_max);
    let squared = dot(direction, direction);
    // A smaller square may be so inexact that its root is wrong.
    let sure = gap.simd_gt(zero) & squared.simd_gt(f32x8::splat(direction[0].token(), MIN_SQUARE));
    sure.select(gap / squared.sqrt(), zero)
}

/// Smallest squared length of a direction that is used: 2^-100. Smaller squares, or their terms,
/// have lost digits to underflow.
const MIN_SQUARE: f32 = 1.0 / (1_u128 << 100) as f32;

/// Returns roughly the difference from the host's nearest point to the guest's. It only serves as a
/// direction, so any error only loosens bounds.
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
            // Ericson, 5.1.9, without its special cases: quotients by zero are kept finite.
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

/// Returns vectors of any length that are perpendicular to the triangles.
#[inline(always)]
fn normal<S: Simd>(corners: &[Lanes3<S>; 3]) -> Lanes3<S> {
    cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]))
}

/// Returns the edges, from each corner to the next.
#[inline(always)]
fn edges<S: Simd>(corners: &[Lanes3<S>; 3]) -> [Lanes3<S>; 3] {
    [sub(&corners[1], &corners[0]), sub(&corners[2], &corners[1]), sub(&corners[0], &corners[2])]
}
