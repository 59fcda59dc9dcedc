//! Proves long thin triangles apart along the cross product of their longest edges.
//!
//! Single precision hardly determines the plane of a sliver. The determinants of the filter have
//! errors of the order of its squared length, and their values are as small as its width. But its
//! edges are known well. Two slivers that pass each other are apart along the direction
//! perpendicular to both edges (Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996; Ericson,
//! 5.2.3).
//!
//! Guarded by `slivers_that_pass_each_other_are_apart` in the tests of the filter, and by the scene
//! `rods` of `bench/rivals.py`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::hierarchy::HALF_ULP;
use crate::simd::{LANES, Lanes3, by_axis, cross, dot, sub};

/// Minimum number of near pairs, of the 64 pairs of triangles of two packets, for which one
/// direction for all pairs is tested first. If fewer are near, the test costs more than it saves.
pub(super) const MIN_CROWDED_PAIRS: u32 = 32;

/// Returns the lanes whose triangles are proved apart, if corners have errors of at most `error`.
#[inline(always)]
pub(super) fn apart_along_edge_cross<S: Simd>(host: &[Lanes3<S>; 3], guest: &[Lanes3<S>; 3], error: f32x8<S>) -> u32 {
    let across = cross(&longest_edge(host), &longest_edge(guest));
    let [host_low, host_high] = reached(host, &across, error);
    let [guest_low, guest_high] = reached(guest, &across, error);
    let apart = guest_low.simd_gt(host_high) | host_low.simd_gt(guest_high);
    apart.to_bitmask() as u32
}

/// Returns for each guest lane `i`, in byte `i`, the host lanes whose triangles are not proved
/// apart from it. All are tested along one direction, the cross product of the longest edges of the
/// first triangle of each packet, as the long triangles of a leaf are mostly parallel.
#[inline(always)]
pub(super) fn near_along_edge_cross<S: Simd>(host: &[Lanes3<S>; 3], guest: &[Lanes3<S>; 3], error: f32x8<S>) -> u64 {
    let across = cross(&longest_edge(host), &longest_edge(guest));
    let across = by_axis!(axis => f32x8::splat(error.token(), across[axis][0]));
    let [host_low, host_high] = reached(host, &across, error);
    let [guest_low, guest_high] = reached(guest, &across, error);
    let (low, high): ([f32; LANES], [f32; LANES]) = (guest_low.into(), guest_high.into());
    let mut apart = 0;
    for lane in 0..LANES {
        let above = host_low.simd_gt(f32x8::splat(error.token(), high[lane]));
        let below = host_high.simd_lt(f32x8::splat(error.token(), low[lane]));
        apart |= u64::from((above | below).to_bitmask() as u32) << (LANES * lane);
    }
    !apart
}

/// Returns the minimum and maximum height of each triangle along a direction, rounded outward. The
/// direction may be any vector. A height has four roundings of products with the largest
/// coordinate, and one more of its last sum.
#[inline(always)]
fn reached<S: Simd>(corners: &[Lanes3<S>; 3], direction: &Lanes3<S>, error: f32x8<S>) -> [f32x8<S>; 2] {
    let mut largest = f32x8::splat(error.token(), 0.0);
    for corner in corners {
        for x in corner {
            largest = largest.max(x.abs());
        }
    }
    let [x, y, z] = by_axis!(axis => direction[axis].abs());
    let rounding = largest * (8.0 * HALF_ULP as f32);
    let slack = (x + y + z).mul_add(error + rounding, f32x8::splat(error.token(), f32::MIN_POSITIVE));
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => dot(direction, &corners[corner]));
    [p.min(q).min(r) - slack, p.max(q).max(r) + slack]
}

/// Returns the longest edge of each triangle.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{dispatch, levels, load3};

    /// Eight slivers along x, and eight along y that cross all of them, one of each at every
    /// height. Only slivers of the same height intersect.
    #[test]
    fn only_touching_slivers_of_a_crowd_are_near() {
        let (mut host, mut guest) = ([[[0.0; LANES]; 3]; 3], [[[0.0; LANES]; 3]; 3]);
        for lane in 0..LANES {
            let height = lane as f32;
            let of_host = [[-1.0, 0.0, height], [1.0, 0.0, height], [1.0, 1e-6, height]];
            let of_guest = [[0.0, -1.0, height], [0.0, 1.0, height], [1e-6, 1.0, height]];
            for corner in 0..3 {
                for axis in 0..3 {
                    host[corner][axis][lane] = of_host[corner][axis];
                    guest[corner][axis][lane] = of_guest[corner][axis];
                }
            }
        }
        for (name, level) in levels() {
            let (near, apart) = dispatch!(level, simd => {
                let [host, guest] = [&host, &guest].map(|side| by_axis!(corner => load3(simd, &side[corner])));
                let error = f32x8::splat(simd, 1e-5);
                (near_along_edge_cross(&host, &guest, error), apart_along_edge_cross(&host, &guest, error))
            });
            assert_eq!((near, apart), (0x8040_2010_0804_0201, 0), "{name}");
        }
    }
}
