//! What builders know of the things that they group, and what they keep of a group: that each has a box.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};

use crate::simd::LANES;
use crate::volume::Aabb;

/// Twice the centre of a box, and which box it is.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub(crate) struct Centre {
    pub(super) twice: [f32; 3],
    pub(super) index: u32,
}

impl Centre {
    /// Of box `index`, in place of what is here.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, twice: f32x4<S>, index: u32) {
        twice.store_slice(bytemuck::cast_mut::<Self, [f32; 4]>(self));
        self.index = index;
    }

    /// Twice the centre, and any fourth lane.
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> f32x4<S> {
        f32x4::from_slice(simd, bytemuck::cast_ref::<Self, [f32; 4]>(self))
    }
}

/// Twice the first eight of these centres, and any fourth lanes.
#[inline(always)]
pub(super) fn lanes_of_eight<S: Simd>(simd: S, centres: &[Centre]) -> [[f32x4<S>; 4]; 2] {
    let [a, b, c, d, e, f, g, h] = &centres[..LANES] else { unreachable!("as many were taken") };
    let (low, high) = ([a, b, c, d], [e, f, g, h]);
    [low.map(|centre| centre.lanes(simd)), high.map(|centre| centre.lanes(simd))]
}

/// Things with boxes, none of which is empty.
pub(crate) trait Boxes: Sync {
    /// How many there are.
    fn len(&self) -> usize;

    /// Bounds of twice the centres of all of them, which may be generous.
    fn twice_reach(&self) -> Aabb;

    /// Twice the centres of eight boxes from number `first` on, and any fourth lanes; anything for boxes that there are not.
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
        let mut centres = [[f32x4::splat(simd, 0.0); 4]; 2];
        for (centre, Aabb { min, max }) in centres.as_flattened_mut().iter_mut().zip(&self[first..]) {
            *centre = f32x4::from_slice(simd, &[min[0] + max[0], min[1] + max[1], min[2] + max[2], 0.0]);
        }
        centres
    }
}

/// What a binary tree keeps of all that is below a node: a box, or nothing where only the layout is wanted, as a refit makes
/// all boxes anyway.
pub trait Bounds: Copy + Send + Sync {
    /// Of nothing.
    const EMPTY: Self;

    /// Of all that is below two nodes.
    #[must_use]
    fn union(self, other: Self) -> Self;

    /// The box, which is empty where none is kept.
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
