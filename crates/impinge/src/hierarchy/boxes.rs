//! The boxes that builders group, and the bounds that they keep of a group.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};

use crate::simd::LANES;
use crate::volume::Aabb;

/// Twice the center of a box, and the index of the box.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub(crate) struct Center {
    pub(super) twice: [f32; 3],
    pub(super) index: u32,
}

impl Center {
    /// Overwrites this entry with box `index`.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, twice: f32x4<S>, index: u32) {
        twice.store_slice(bytemuck::cast_mut::<Self, [f32; 4]>(self));
        self.index = index;
    }

    /// Returns twice the center, and an arbitrary fourth lane.
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> f32x4<S> {
        f32x4::from_slice(simd, bytemuck::cast_ref::<Self, [f32; 4]>(self))
    }
}

/// Returns twice the first eight centers, each with an arbitrary fourth lane.
#[inline(always)]
pub(super) fn lanes_of_eight<S: Simd>(simd: S, centers: &[Center]) -> [[f32x4<S>; 4]; 2] {
    let [a, b, c, d, e, f, g, h] = &centers[..LANES] else { unreachable!("at least eight centers were passed") };
    let (low, high) = ([a, b, c, d], [e, f, g, h]);
    [low.map(|center| center.lanes(simd)), high.map(|center| center.lanes(simd))]
}

/// Items with boxes. No box may be empty.
pub(crate) trait Boxes: Sync {
    /// Returns the number of boxes.
    fn len(&self) -> usize;

    /// Returns a box that encloses twice the centers of all boxes. It may be too large.
    fn twice_reach(&self) -> Aabb;

    /// Returns twice the centers of eight boxes from index `first` on, each with an arbitrary
    /// fourth lane. Indices out of range give arbitrary numbers.
    fn eight<S: Simd>(&self, simd: S, first: usize) -> [[f32x4<S>; 4]; 2];
}

impl Boxes for [Aabb] {
    fn len(&self) -> usize {
        self.len()
    }

    fn twice_reach(&self) -> Aabb {
        let bounds = self.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        Aabb { min: bounds.min.map(|x| 2.0 * x), max: bounds.max.map(|x| 2.0 * x) }
    }

    #[inline(always)]
    fn eight<S: Simd>(&self, simd: S, first: usize) -> [[f32x4<S>; 4]; 2] {
        let mut centers = [[f32x4::splat(simd, 0.0); 4]; 2];
        for (center, Aabb { min, max }) in centers.as_flattened_mut().iter_mut().zip(&self[first..]) {
            *center = f32x4::from_slice(simd, &[min[0] + max[0], min[1] + max[1], min[2] + max[2], 0.0]);
        }
        centers
    }
}

/// The bounds that a binary tree keeps of all that is below a node. They are a box, or `()` if only
/// the layout is needed, because a refit computes all boxes anyway.
pub trait Bounds: Copy + Send + Sync {
    /// The bounds of no boxes.
    const EMPTY: Self;

    /// Returns the bounds of all that is below two nodes.
    #[must_use]
    fn union(self, other: Self) -> Self;

    /// Returns the box, or the empty box if none is kept.
    fn aabb(self) -> Aabb;
}

impl Bounds for Aabb {
    const EMPTY: Self = Self::EMPTY;

    #[inline(always)]
    fn union(self, other: Self) -> Self {
        Self::union(self, other)
    }

    #[inline(always)]
    fn aabb(self) -> Aabb {
        self
    }
}

impl Bounds for () {
    const EMPTY: Self = ();

    #[inline(always)]
    fn union(self, (): Self) {}

    #[inline(always)]
    fn aabb(self) -> Aabb {
        Aabb::EMPTY
    }
}
