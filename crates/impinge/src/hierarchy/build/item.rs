//! The boxes that a builder rearranges, one vector each, and their unions.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, i32x4};

use crate::simd::{LANES, best_level, dispatch};
use crate::volume::Aabb;

/// A box and its index. They move together, so that passes read memory in order.
#[derive(Clone, Copy, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(32))]
pub(super) struct Item {
    max: [f32; 3],
    index: u32,
    negated_min: [f32; 3],
    unused: u32,
}

impl Item {
    /// Wraps box `index`.
    pub(super) fn new(bounds: &Aabb, index: u32) -> Self {
        Self { max: bounds.max, index, negated_min: bounds.min.map(|x| -x), unused: 0 }
    }

    /// Wraps all of these boxes in their order.
    pub(super) fn all(boxes: &[Aabb]) -> Vec<Self> {
        (0..).zip(boxes).map(|(index, bounds)| Self::new(bounds, index)).collect()
    }

    /// Returns the index of the box.
    pub(super) fn index(&self) -> u32 {
        self.index
    }

    /// Returns twice the center of the box on an axis. It is a sum, because products with subnormal
    /// numbers are many times slower.
    #[inline(always)]
    pub(super) fn twice_center(&self, axis: usize) -> f32 {
        self.max[axis] - self.negated_min[axis]
    }

    /// Returns the sort key of the box along an axis. All keys differ.
    #[inline(always)]
    pub(super) fn key(&self, axis: usize) -> u64 {
        key(self.twice_center(axis), self.index)
    }

    /// Returns the reach of the box: its maximum and its negated minimum.
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::from_slice(simd, bytemuck::cast_ref::<Self, [f32; LANES]>(self))
    }

    /// Returns twice the center of the box on each axis, and zero.
    #[inline(always)]
    pub(super) fn twice_centers<S: Simd>(&self, simd: S) -> f32x4<S> {
        let (max, negated_min) = self.lanes(simd).split();
        // The index could be a float that slows products down.
        let twice = (max - negated_min).bitcast::<i32x4<S>>() & i32x4::from_slice(simd, &[-1, -1, -1, 0]);
        twice.bitcast::<f32x4<S>>()
    }
}

/// Returns the box around some boxes.
pub(super) fn bounds(items: &[Item]) -> Aabb {
    dispatch!(best_level(), simd => {
        let lanes = items.iter().map(#[inline(always)] |item| item.lanes(simd));
        Reach::of_all(simd, lanes)
    })
    .aabb()
}

/// Returns the box around twice the centers of some boxes.
pub(super) fn twice_center_bounds(items: &[Item]) -> Aabb {
    dispatch!(best_level(), simd => {
        let points = items.iter().map(#[inline(always)] |item| point(item.twice_centers(simd)));
        Reach::of_all(simd, points)
    })
    .aabb()
}

/// Returns the indices of some boxes.
pub(super) fn order(items: &[Item]) -> Vec<u32> {
    items.iter().map(Item::index).collect()
}

/// Returns a key that sorts by a coordinate as floats do, then by the index. No two keys are equal,
/// so there is only one order.
#[inline(always)]
pub(super) fn key(along: f32, index: u32) -> u64 {
    let bits = along.to_bits();
    // The bits of negative floats sort in reverse. Positive floats need their top bit to come after
    // them.
    let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
    u64::from(ordered) << 32 | u64::from(index)
}

/// The reach of some boxes along and against each axis: their maximum coordinates, and their
/// negated minimum coordinates. So a union is one maximum of all lanes. Lanes 3 and 7 are
/// arbitrary.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Reach([f32; LANES]);

impl Reach {
    /// The reach of no boxes.
    pub(super) const NOTHING: Self = Self([f32::NEG_INFINITY; LANES]);

    /// Wraps the reach in the lanes of a vector.
    #[inline(always)]
    pub(super) fn of<S: Simd>(lanes: f32x8<S>) -> Self {
        Self(lanes.into())
    }

    /// Returns the union of many vectors.
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

    /// Extends the reach by these lanes.
    #[inline(always)]
    pub(super) fn take_in<S: Simd>(&mut self, simd: S, lanes: f32x8<S>) {
        self.lanes(simd).max(lanes).store_slice(&mut self.0);
    }

    /// Returns the union of both.
    pub(super) fn union(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane].max(other.0[lane])))
    }

    /// Returns the box with this reach.
    pub(super) fn aabb(&self) -> Aabb {
        let [x, y, z, _, left, below, behind, _] = self.0;
        Aabb { min: [-left, -below, -behind], max: [x, y, z] }
    }
}

/// Returns the reach of a point.
#[inline(always)]
pub(super) fn point<S: Simd>(at: f32x4<S>) -> f32x8<S> {
    at.combine(-at)
}
