//! What a builder knows of the things that it groups: that each has a box.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};

use crate::volume::Aabb;

/// Things with boxes, none of which is empty.
pub(crate) trait Boxes: Sync {
    /// How many there are.
    fn len(&self) -> usize;

    /// Bounds of twice the centres of all of them, which may be generous.
    fn twice_centres(&self) -> Aabb;

    /// Twice the centre of one box, and any fourth lane.
    fn twice_centre<S: Simd>(&self, simd: S, index: u32) -> f32x4<S>;

    /// The box of a group.
    fn bounds<S: Simd>(&self, simd: S, group: &[u32]) -> Aabb;
}

impl Boxes for [Aabb] {
    fn len(&self) -> usize {
        self.len()
    }

    fn twice_centres(&self) -> Aabb {
        let bounds = self.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        Aabb { min: bounds.min.map(|x| 2.0 * x), max: bounds.max.map(|x| 2.0 * x) }
    }

    #[inline(always)]
    fn twice_centre<S: Simd>(&self, simd: S, index: u32) -> f32x4<S> {
        let Aabb { min, max } = &self[index as usize];
        f32x4::from_slice(simd, &[min[0] + max[0], min[1] + max[1], min[2] + max[2], 0.0])
    }

    #[inline(always)]
    fn bounds<S: Simd>(&self, _: S, group: &[u32]) -> Aabb {
        group.iter().fold(Aabb::EMPTY, |bounds, &index| bounds.union(self[index as usize]))
    }
}
