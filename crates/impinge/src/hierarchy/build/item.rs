//! Boxes that a builder rearranges, each in one vector, and unions of them.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, i32x4};

use crate::simd::{LANES, best_level, dispatch};
use crate::volume::Aabb;

/// A box and its number, moved together, so that passes run over memory in order.
#[derive(Clone, Copy, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(32))]
pub(super) struct Item {
    max: [f32; 3],
    index: u32,
    negated_min: [f32; 3],
    unused: u32,
}

impl Item {
    /// Of box `index`.
    pub(super) fn new(bounds: &Aabb, index: u32) -> Self {
        Self { max: bounds.max, index, negated_min: bounds.min.map(|x| -x), unused: 0 }
    }

    /// All of these boxes in their order.
    pub(super) fn all(boxes: &[Aabb]) -> Vec<Self> {
        (0..).zip(boxes).map(|(index, bounds)| Self::new(bounds, index)).collect()
    }

    /// Which box it is.
    pub(super) fn index(&self) -> u32 {
        self.index
    }

    /// Twice the middle of the box on an axis. A sum, as a product takes many times as long where a coordinate is the next to zero.
    #[inline(always)]
    pub(super) fn twice_centre(&self, axis: usize) -> f32 {
        self.max[axis] - self.negated_min[axis]
    }

    /// Its place among all along an axis.
    #[inline(always)]
    pub(super) fn key(&self, axis: usize) -> u64 {
        key(self.twice_centre(axis), self.index)
    }

    /// How far the box reaches.
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::from_slice(simd, bytemuck::cast_ref::<Self, [f32; LANES]>(self))
    }

    /// Twice the middle of the box on each axis, and zero.
    #[inline(always)]
    pub(super) fn twice_centres<S: Simd>(&self, simd: S) -> f32x4<S> {
        let (max, negated_min) = self.lanes(simd).split();
        // The number may be a float that slows products down.
        let twice = (max - negated_min).bitcast::<i32x4<S>>() & i32x4::from_slice(simd, &[-1, -1, -1, 0]);
        twice.bitcast::<f32x4<S>>()
    }
}

/// The box of some boxes.
pub(super) fn bounds(items: &[Item]) -> Aabb {
    dispatch!(best_level(), simd => {
        let lanes = items.iter().map(#[inline(always)] |item| item.lanes(simd));
        Reach::of_all(simd, lanes)
    })
    .aabb()
}

/// The box of twice the centres of some boxes.
pub(super) fn twice_centre_bounds(items: &[Item]) -> Aabb {
    dispatch!(best_level(), simd => {
        let points = items.iter().map(#[inline(always)] |item| point(item.twice_centres(simd)));
        Reach::of_all(simd, points)
    })
    .aabb()
}

/// The numbers of some boxes.
pub(super) fn order(items: &[Item]) -> Vec<u32> {
    items.iter().map(Item::index).collect()
}

/// Sorts by a coordinate as floats do, then by the index: no two boxes are alike, so that there is one order.
#[inline(always)]
pub(super) fn key(along: f32, index: u32) -> u64 {
    let bits = along.to_bits();
    // A negative float's bits grow the wrong way; a positive one's need their top bit to come after it.
    let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
    u64::from(ordered) << 32 | u64::from(index)
}

/// How far something reaches along each axis and against each: its greatest coordinates, and its least ones negated, so that a union is
/// one maximum of all lanes. In the fourth and the last lane there is anything.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Reach([f32; LANES]);

impl Reach {
    /// Of nothing.
    pub(super) const NOTHING: Self = Self([f32::NEG_INFINITY; LANES]);

    /// Of what is in lanes of a vector.
    #[inline(always)]
    pub(super) fn of<S: Simd>(lanes: f32x8<S>) -> Self {
        Self(lanes.into())
    }

    /// Of what is in the lanes of many vectors.
    #[inline(always)]
    fn of_all<S: Simd>(simd: S, all: impl Iterator<Item = f32x8<S>>) -> Self {
        let mut reach = Self::NOTHING.lanes(simd);
        for lanes in all {
            reach = reach.max(lanes);
        }
        Self::of(reach)
    }

    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::from_slice(simd, &self.0)
    }

    /// Makes it reach as far as these lanes.
    #[inline(always)]
    pub(super) fn take_in<S: Simd>(&mut self, simd: S, lanes: f32x8<S>) {
        self.lanes(simd).max(lanes).store_slice(&mut self.0);
    }

    /// Of both.
    pub(super) fn union(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane].max(other.0[lane])))
    }

    /// The box that reaches as far.
    pub(super) fn aabb(&self) -> Aabb {
        let [x, y, z, _, left, below, behind, _] = self.0;
        Aabb { min: [-left, -below, -behind], max: [x, y, z] }
    }
}

/// How far a point reaches.
#[inline(always)]
pub(super) fn point<S: Simd>(at: f32x4<S>) -> f32x8<S> {
    at.combine(-at)
}
