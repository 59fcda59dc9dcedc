//! Three-dimensional vectors, one per lane.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8};

use super::{LANES, by_axis};

/// Three coordinates in each lane.
pub(crate) type Lanes3<S> = [f32x8<S>; 3];

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lanes: &[f32; LANES]) -> f32x8<S> {
    f32x8::from_slice(simd, lanes)
}

#[inline(always)]
pub(crate) fn load3<S: Simd>(simd: S, lanes: &[[f32; LANES]; 3]) -> Lanes3<S> {
    by_axis!(axis => load(simd, &lanes[axis]))
}

#[inline(always)]
pub(crate) fn store3<S: Simd>(values: &Lanes3<S>, lanes: &mut [[f32; LANES]; 3]) {
    for axis in 0..3 {
        values[axis].store_slice(&mut lanes[axis]);
    }
}

#[inline(always)]
pub(crate) fn sub<S: Simd>(a: &Lanes3<S>, b: &Lanes3<S>) -> Lanes3<S> {
    by_axis!(axis => a[axis] - b[axis])
}

/// Returns the cross product per lane, with fused multiply-add if the level has it. The last bits
/// so depend on the level: use it for values compared within an error bound, not for values that
/// are stored.
#[inline(always)]
pub(crate) fn cross<S: Simd>(a: &Lanes3<S>, b: &Lanes3<S>) -> Lanes3<S> {
    [a[1].mul_sub(b[2], a[2] * b[1]), a[2].mul_sub(b[0], a[0] * b[2]), a[0].mul_sub(b[1], a[1] * b[0])]
}

/// Returns the dot product per lane. Its last bits depend on the level, as those of [`cross`] do.
#[inline(always)]
pub(crate) fn dot<S: Simd>(a: &Lanes3<S>, b: &Lanes3<S>) -> f32x8<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Returns the first three columns of eight rows: a transposition.
#[inline(always)]
pub(crate) fn transposed<S: Simd>(low: [f32x4<S>; 4], high: [f32x4<S>; 4]) -> Lanes3<S> {
    let (low, high) = (columns(low), columns(high));
    by_axis!(axis => low[axis].combine(high[axis]))
}

/// Returns the first three columns of four rows.
#[inline(always)]
fn columns<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 3] {
    let (xy_even, xy_odd) = (a.zip_low(c), b.zip_low(d));
    let (z_even, z_odd) = (a.zip_high(c), b.zip_high(d));
    [xy_even.zip_low(xy_odd), xy_even.zip_high(xy_odd), z_even.zip_low(z_odd)]
}

/// Reduces each of eight vectors to one lane of the result with `both`, in an order that is the
/// same on every vector unit.
#[inline(always)]
pub(crate) fn across<S: Simd>(each: &[f32x8<S>; LANES], both: impl Fn(f32x4<S>, f32x4<S>) -> f32x4<S>) -> f32x8<S> {
    let [a, b, c, d, e, f, g, h] = *each;
    across_four([a, b, c, d], &both).combine(across_four([e, f, g, h], &both))
}

/// Reduces each of three vectors to one number with `both`, as [`across`] does.
#[inline(always)]
pub(crate) fn across3<S: Simd>([x, y, z]: &Lanes3<S>, both: impl Fn(f32x4<S>, f32x4<S>) -> f32x4<S>) -> [f32; 3] {
    let [x, y, z, _] = <[f32; 4]>::from(across_four([*x, *y, *z, *z], &both));
    [x, y, z]
}

#[inline(always)]
fn across_four<S: Simd>(each: [f32x8<S>; 4], both: &impl Fn(f32x4<S>, f32x4<S>) -> f32x4<S>) -> f32x4<S> {
    let [(a, b), (c, d), (e, f), (g, h)] = [each[0].split(), each[1].split(), each[2].split(), each[3].split()];
    let [p, q, r, s] = [both(a, b), both(c, d), both(e, f), both(g, h)];
    let (even, odd) = (both(p.zip_low(r), p.zip_high(r)), both(q.zip_low(s), q.zip_high(s)));
    both(even.zip_low(odd), even.zip_high(odd))
}
