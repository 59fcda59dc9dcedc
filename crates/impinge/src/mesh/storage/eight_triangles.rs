//! Loads eight triangles into SIMD lanes, from the rows in which their vertices are stored.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, f64x4};

use super::frame::PackedFrame;
use crate::simd::{LANES, Lanes3, by_axis, transposed};

/// Returns the corners of eight triangles, `[corner][axis]` with one triangle per lane. `row(4 *
/// lane + corner)` returns a vertex, in the order of [`VertexRows`](super::faces::VertexRows). Its
/// fourth number is ignored.
#[inline(always)]
pub(super) fn corners_of<S: Simd>(row: impl Fn(usize) -> f32x4<S>) -> [Lanes3<S>; 3] {
    by_axis!(k => {
        let low = [row(k), row(4 + k), row(8 + k), row(12 + k)];
        let high = [row(16 + k), row(20 + k), row(24 + k), row(28 + k)];
        transposed(low, high)
    })
}

/// Returns twice the box centers of eight faces, one vector per face. `row(3 * face + corner)`
/// returns a vertex. The fourth lanes have no meaning.
#[inline(always)]
pub(super) fn twice_centers_of<S: Simd>(row: impl Fn(usize) -> f32x4<S>) -> [[f32x4<S>; 4]; 2] {
    let twice = [twice_of(&row, 0), twice_of(&row, 1), twice_of(&row, 2), twice_of(&row, 3)];
    [twice, [twice_of(&row, 4), twice_of(&row, 5), twice_of(&row, 6), twice_of(&row, 7)]]
}

#[inline(always)]
fn twice_of<S: Simd>(row: &impl Fn(usize) -> f32x4<S>, face: usize) -> f32x4<S> {
    let [p, q, r] = by_axis!(corner => row(3 * face + corner));
    p.min(q).min(r) + p.max(q).max(r)
}

/// Returns twice the box centers of eight faces in the packed frame, one vector per face, for
/// vertices given in the mesh frame. `row(3 * face + corner)` returns a vertex. The fourth lanes
/// have no meaning.
#[inline(always)]
pub(super) fn twice_packed_centers_of<'a, S: Simd, T: Copy + Into<f64> + 'a>(
    simd: S,
    frame: &PackedFrame,
    row: impl Fn(usize) -> &'a [T; 4],
) -> [[f32x4<S>; 4]; 2] {
    let [x, y, z] = frame.origin;
    let (origin, scale) = (f64x4::from_slice(simd, &[x, y, z, 0.0]), f64x4::splat(simd, frame.scale));
    let mut twice = [[f32x4::splat(simd, 0.0); 4]; 2];
    for (half, first) in twice.iter_mut().zip([0, 4]) {
        for pair in [0, 2] {
            let [even, odd] = [0, 1].map(|lane| 3 * (first + pair + lane));
            let both: f32x8<S> = twice_packed(origin, scale, by_axis!(corner => widened(simd, row(even + corner))))
                .narrow(twice_packed(origin, scale, by_axis!(corner => widened(simd, row(odd + corner)))));
            (half[pair], half[pair + 1]) = both.split();
        }
    }
    twice
}

#[inline(always)]
fn twice_packed<S: Simd>(origin: f64x4<S>, scale: f64x4<S>, [p, q, r]: [f64x4<S>; 3]) -> f64x4<S> {
    (p.min(q).min(r) - origin) * scale + (p.max(q).max(r) - origin) * scale
}

#[inline(always)]
fn widened<S: Simd, T: Copy + Into<f64>>(simd: S, &[x, y, z, any]: &[T; 4]) -> f64x4<S> {
    f64x4::from_slice(simd, &[x.into(), y.into(), z.into(), any.into()])
}

/// Returns the corners of eight triangles in double precision, `[corner][lane]`. `row(4 * lane +
/// corner)` returns a vertex, in the order of [`VertexRows`](super::faces::VertexRows). The fourth
/// lanes have no meaning.
#[inline(always)]
pub(super) fn widened_rows<'a, S: Simd, T: Copy + Into<f64> + 'a>(
    simd: S,
    row: impl Fn(usize) -> &'a [T; 4],
) -> [[f64x4<S>; LANES]; 3] {
    let mut rows = [[f64x4::splat(simd, 0.0); LANES]; 3];
    for lane in 0..LANES {
        for corner in 0..3 {
            rows[corner][lane] = widened(simd, row(4 * lane + corner));
        }
    }
    rows
}
