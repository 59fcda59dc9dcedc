//! Leaves: which faces a leaf of the tree holds, and a slab about them.
//!
//! The corners are in [`packets`](super::packet), which are made when a leaf is first met.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::PACKING_ERROR;
use super::stored_corners::{StoredCorners, across};
use crate::hierarchy::HALF_ULP;
use crate::simd::{LANES, Lanes3, by_axis, sub};
use crate::volume::Aabb;

/// Up to eight triangles; unused lanes repeat the first one.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(64))]
pub(crate) struct Leaf {
    /// Which face each lane is.
    pub(crate) faces: [u32; LANES],
    /// A point amid the triangles, as [`StoredCorners`] keeps it.
    pub(super) anchor: [f32; 3],
    /// The greatest magnitude of the corners' coordinates about the anchor, in the packed frame.
    pub(crate) radius: f32,
    /// The slab about the corners: their least and greatest height about the anchor along [`normal`](Self::normal).
    pub(crate) heights: [f32; 2],
    normal: [i16; 3],
    count: u16,
}

/// The unit of a leaf's normal.
const NORMAL_STEP: f32 = 1.0 / (1 << 14) as f32;

impl Leaf {
    /// The bits of the lanes that hold a triangle.
    #[inline(always)]
    pub(crate) fn lanes_in_use(&self) -> u32 {
        (1 << usize::from(self.count).min(LANES)) - 1
    }

    /// The direction of the slab about the corners, mostly that in which the triangles face; no component is larger than
    /// one in magnitude, and none is rounded.
    #[inline(always)]
    pub(crate) fn normal(&self) -> [f32; 3] {
        by_axis!(axis => f32::from(self.normal[axis]) * NORMAL_STEP)
    }

    /// The normal, and the least and greatest height along it of all that the leaf holds, about the anchor, outward.
    #[inline(always)]
    pub(crate) fn slab(&self) -> ([f64; 3], [f64; 2]) {
        let [low, high] = self.heights.map(f64::from);
        let error = 3.0 * (HALF_ULP * f64::from(self.radius) + PACKING_ERROR);
        (self.normal().map(f64::from), [low - error, high + error])
    }

    /// A leaf that is [laid out](Self::lay).
    pub(super) fn holding(held: &[u32]) -> Self {
        let mut leaf: Self = bytemuck::Zeroable::zeroed();
        leaf.lay(held);
        leaf
    }

    /// Lays the leaf out: it holds these faces, at least one and at most eight. All else follows from where they are, and
    /// means nothing until it is [fitted](Self::fit).
    pub(super) fn lay(&mut self, held: &[u32]) {
        self.faces = [held[0]; LANES];
        self.faces[..held.len()].copy_from_slice(held);
        self.count = held.len() as u16;
    }

    /// The faces that it holds; the first one where it says that it holds none.
    pub(super) fn held(&self) -> &[u32] {
        &self.faces[..usize::from(self.count).clamp(1, LANES)]
    }

    /// Whether lanes that hold no face of their own repeat the first, and no other does.
    pub(super) fn is_layout_sound(&self) -> bool {
        (1..=LANES).contains(&usize::from(self.count))
            && (1..LANES).all(|lane| (self.faces[lane] == self.faces[0]) == (lane >= usize::from(self.count)))
    }

    /// Fits all to where the corners are; returns bounds of them as a builder is given them (see
    /// [`FaceBoxes`](super::face_boxes::FaceBoxes)), the corners about the anchor, and where that is in the packed frame.
    ///
    /// No operation is fused, so that the bits are the same on every vector unit.
    #[inline(always)]
    pub(super) fn fit<S: Simd, C: StoredCorners>(&mut self, simd: S, stored: &C) -> (Aabb, [Lanes3<S>; 3], [f64; 3]) {
        let gathered = stored.gather(simd, &self.faces);
        let extremes = stored.extremes(simd, &gathered);
        let bounds = stored.bounds(extremes);
        self.anchor = stored.anchor(extremes, &bounds);
        let place = stored.place(self.anchor);
        let corners = stored.about(simd, &gathered, place);
        let largest: Lanes3<S> =
            by_axis!(axis => corners[0][axis].abs().max(corners[1][axis].abs()).max(corners[2][axis].abs()));
        self.radius = largest[0].max(largest[1]).max(largest[2]).reduce_max();
        self.normal = direction(&corners);
        self.heights = heights(simd, &corners, self.normal(), self.radius);
        (bounds, corners, stored.frame().pack(place))
    }
}

/// The direction in which the triangles face, weighted by their areas; zero if in none.
#[inline(always)]
fn direction<S: Simd>(corners: &[Lanes3<S>; 3]) -> [i16; 3] {
    let (e, f) = (sub(&corners[1], &corners[0]), sub(&corners[2], &corners[0]));
    let areas = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let sum = across(
        &areas,
        #[inline(always)]
        |a, b| a + b,
    );
    let [x, y, z] = by_axis!(axis => sum[axis].abs());
    let largest = x.max(y).max(z);
    let scale = 1.0 / (largest * NORMAL_STEP);
    if scale.is_finite() && largest.is_finite() { by_axis!(axis => (sum[axis] * scale) as i16) } else { [0; 3] }
}

/// The least and the greatest height of corners of at most this radius along a direction, outward: five roundings of
/// sums of three products of at most the radius.
#[inline(always)]
fn heights<S: Simd>(simd: S, corners: &[Lanes3<S>; 3], normal: [f32; 3], radius: f32) -> [f32; 2] {
    let [low, high] = heights_by_lane(simd, corners, normal);
    let error = 20.0 * HALF_ULP as f32 * radius + f32::MIN_POSITIVE;
    [low.reduce_min() - error, high.reduce_max() + error]
}

/// The least and the greatest height of the corners of each triangle along a direction, not fused.
#[inline(always)]
pub(super) fn heights_by_lane<S: Simd>(simd: S, corners: &[Lanes3<S>; 3], normal: [f32; 3]) -> [f32x8<S>; 2] {
    let normal: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, normal[axis]));
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => {
        let at = &corners[corner];
        normal[0] * at[0] + normal[1] * at[1] + normal[2] * at[2]
    });
    [p.min(q).min(r), p.max(q).max(r)]
}
