//! Classifies pairs of triangles in single precision, eight at a time: apart, intersecting or
//! undecided.
//!
//! Source: Devillers, Guigue, *Faster triangle-triangle intersection tests*, INRIA RR-4488, 2002,
//! on eight lanes. Ours departs in that every sign has an error bound (docs/notes/proof.md, L4). A
//! lane is undecided unless all of its signs are certain.
//!
//! Guarded by the tests in `filter/tests`, by `engine/triangle_pairs.rs`, and by the benchmark
//! `headline`.
//!
//! # The bound of a determinant
//! Every determinant here is (e × f) · d with edges e, f of two triangles and d from a corner of
//! one to a corner of the other. Write u = 2^-24, ε for the sum of the error bounds of the corners
//! of the two triangles, and let X ≥ |e| + 4ε, Z ≥ |f| + 4ε and Y ≥ |d| + 4ε bound the components.
//! The error of an edge is at most 2ε + uX, that of d at most ε + uY. Then the error of e × f is at
//! most 4ε(X + Z) + 10uXZ, if the 4ε in X and Z cover the products of errors. The error of the dot
//! product, with its own four roundings, is at most
//!
//! ε (6XZ + 15Y(X + Z)) + 68 u XYZ.
//!
//! The code takes 16 for 15 and 72 for 68, which covers the evaluation of the bound. ε is at least
//! 2^-40, so the bound exceeds the losses of products too small for single precision (at most
//! 2^-146 (1 + X + Y + Z), compared with 2^-111 Y). A bound or determinant that overflows makes the
//! lane undecided.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use super::across::apart_along_edge_cross;
use crate::hierarchy::HALF_ULP;
use crate::simd::{ALL_LANES, Lanes3, by_axis, cross, dot, sub};

/// A triangle in each lane.
pub(super) struct Triangle<S: Simd> {
    pub(super) corners: [Lanes3<S>; 3],
    /// Maximum extent of the triangle's box.
    pub(super) width: f32x8<S>,
}

impl<S: Simd> Triangle<S> {
    /// Returns the normal, twice the area long.
    #[inline(always)]
    fn normal(&self) -> Lanes3<S> {
        let [p, q, r] = &self.corners;
        cross(&sub(q, p), &sub(r, p))
    }
}

/// Classifies eight pairs of triangles whose boxes overlap. Returns the lanes that intersect and
/// the lanes that are undecided.
#[inline(always)]
pub(super) fn classify<S: Simd>(host: &Triangle<S>, guest: &Triangle<S>, error: f32x8<S>) -> [u32; 2] {
    let margin = error * 4.0;
    let (x, z) = (host.width + margin, guest.width + margin);
    // If boxes overlap when one is enlarged by the error, their corners are at most this far apart.
    let y = host.width + guest.width + margin + margin;
    let host_plane = bound(error, x, x, y);
    let guest_plane = bound(error, z, z, y);

    let (host_normal, guest_normal) = (host.normal(), guest.normal());
    let guest_heights: [f32x8<S>; 3] =
        by_axis!(corner => dot(&host_normal, &sub(&guest.corners[corner], &host.corners[0])));
    let host_heights: [f32x8<S>; 3] =
        by_axis!(corner => dot(&guest_normal, &sub(&host.corners[corner], &guest.corners[0])));
    let apart = one_sided(&guest_heights, host_plane) | one_sided(&host_heights, guest_plane);
    let near = !(apart.to_bitmask() as u32) & ALL_LANES;
    if near == 0 {
        return [0, 0];
    }
    let certain = all_certain(&guest_heights, host_plane) & all_certain(&host_heights, guest_plane);

    // The corner of each triangle that is alone on its side of the other's plane comes first. A
    // triangle is turned over if the lone corner of the other one lies below it.
    let (host_lone, guest_lone) = (Lone::of(&host_heights), Lone::of(&guest_heights));
    let zero = f32x8::splat(error.token(), 0.0);
    let (host_first, host_rest) = host_lone.canonical(&host.corners, guest_lone.height.simd_lt(zero));
    let (guest_first, guest_rest) = guest_lone.canonical(&guest.corners, host_lone.height.simd_lt(zero));
    let between = sub(&guest_first, &host_first);
    let edge_bound = bound(error, x, z, y);
    let start = dot(&cross(&sub(&host_rest[0], &host_first), &sub(&guest_rest[0], &guest_first)), &between);
    let end = dot(&cross(&sub(&host_rest[1], &host_first), &sub(&guest_rest[1], &guest_first)), &between);
    let intersects = certain & start.simd_gt(edge_bound) & end.simd_lt(-edge_bound);
    let misses = certain & (start.simd_lt(-edge_bound) | end.simd_gt(edge_bound));
    let intersects = intersects.to_bitmask() as u32 & near;
    let misses = misses.to_bitmask() as u32;
    let undecided = near & !intersects & !misses;
    if undecided == 0 {
        return [intersects, 0];
    }
    [intersects, undecided & !apart_along_edge_cross(&host.corners, &guest.corners, error)]
}

/// Returns the error bound of a determinant; see the head of this file.
#[inline(always)]
pub(super) fn bound<S: Simd>(error: f32x8<S>, x: f32x8<S>, z: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    let product = x * z;
    let rounding = f32x8::splat(error.token(), 72.0 * HALF_ULP as f32);
    let edges = product.mul_add(f32x8::splat(error.token(), 6.0), y * (x + z) * 16.0);
    error.mul_add(edges, rounding * product * y)
}

/// The corner of each lane that is alone on its side of the other triangle's plane: the first
/// corner unless a mask selects another. It is meaningful only if the three heights do not all have
/// the same sign.
struct Lone<S: Simd> {
    second: mask32x8<S>,
    third: mask32x8<S>,
    /// Height of the lone corner above the other plane.
    height: f32x8<S>,
}

impl<S: Simd> Lone<S> {
    /// Finds the lone corner from the heights of the corners above the other plane.
    #[inline(always)]
    fn of(heights: &[f32x8<S>; 3]) -> Self {
        let zero = f32x8::splat(heights[0].token(), 0.0);
        let above: [mask32x8<S>; 3] = by_axis!(corner => heights[corner].simd_gt(zero));
        let second = (above[1] ^ above[0]) & (above[1] ^ above[2]);
        let third = (above[2] ^ above[0]) & (above[2] ^ above[1]);
        Self { second, third, height: second.select(heights[1], third.select(heights[2], heights[0])) }
    }

    /// Returns the lone corner and the other two in cyclic order, which is reversed if the triangle
    /// is turned `over`.
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

/// Returns the lanes in which all three heights are certainly on one side.
#[inline(always)]
fn one_sided<S: Simd>(heights: &[f32x8<S>; 3], bound: f32x8<S>) -> mask32x8<S> {
    let [a, b, c] = *heights;
    (a.simd_gt(bound) & b.simd_gt(bound) & c.simd_gt(bound))
        | (a.simd_lt(-bound) & b.simd_lt(-bound) & c.simd_lt(-bound))
}

/// Returns the lanes in which all three signs are certain.
#[inline(always)]
fn all_certain<S: Simd>(heights: &[f32x8<S>; 3], bound: f32x8<S>) -> mask32x8<S> {
    heights[0].abs().simd_gt(bound) & heights[1].abs().simd_gt(bound) & heights[2].abs().simd_gt(bound)
}
