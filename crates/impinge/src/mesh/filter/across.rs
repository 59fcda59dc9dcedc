//! Long thin triangles that pass each other, proved apart along the direction across their longest edges.
//!
//! The plane of a sliver is hardly known in single precision: the determinants of the filter are off by the square of its length,
//! and are themselves as small as its width. Its edges are known well, and two that pass each other do so along the direction
//! across both (Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996; Ericson, 5.2.3).

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::Triangle;
use crate::hierarchy::HALF_ULP;
use crate::simd::{Lanes3, by_axis, cross, dot, sub};

/// The lanes whose triangles are proved apart, where their corners may be off by `error` together and no two are farther apart on
/// an axis than `reach`.
///
/// A direction may be anything. Along it, a difference of corners has four roundings, of what is no larger than the reach,
/// and two such are compared: with the comparison's own, less than 16 in all.
#[inline(always)]
pub(super) fn apart_across<S: Simd>(host: &Triangle<S>, guest: &Triangle<S>, error: f32x8<S>, reach: f32x8<S>) -> u32 {
    let across = cross(&longest_edge(&host.corners), &longest_edge(&guest.corners));
    let [x, y, z] = by_axis!(axis => across[axis].abs());
    let rounding = reach * (16.0 * HALF_ULP as f32);
    let slack = (x + y + z).mul_add(error + error + rounding, f32x8::splat(error.token(), f32::MIN_POSITIVE));
    let from = &host.corners[0];
    let (host_low, host_high) = reached(&host.corners, from, &across);
    let (guest_low, guest_high) = reached(&guest.corners, from, &across);
    let apart = guest_low.simd_gt(host_high + slack) | host_low.simd_gt(guest_high + slack);
    apart.to_bitmask() as u32
}

/// How far the corners of each triangle reach along a direction, at least and at most.
#[inline(always)]
fn reached<S: Simd>(corners: &[Lanes3<S>; 3], from: &Lanes3<S>, direction: &Lanes3<S>) -> (f32x8<S>, f32x8<S>) {
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => dot(direction, &sub(&corners[corner], from)));
    (p.min(q).min(r), p.max(q).max(r))
}

#[inline(always)]
fn longest_edge<S: Simd>([p, q, r]: &[Lanes3<S>; 3]) -> Lanes3<S> {
    let [mut longest, second, third] = [sub(q, p), sub(r, q), sub(p, r)];
    let mut most = dot(&longest, &longest);
    for edge in [second, third] {
        let square = dot(&edge, &edge);
        let is_longer = square.simd_gt(most);
        longest = by_axis!(axis => is_longer.select(edge[axis], longest[axis]));
        most = most.max(square);
    }
    longest
}
