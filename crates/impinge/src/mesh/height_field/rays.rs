//! Rays against a height field: the blocks that a ray enters, the earliest first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::field::HeightField;
use crate::hierarchy::Child;
use crate::mesh::points::rays::{Ray, RayHit};
use crate::partition;
use crate::volume::MinMax;

/// Bound on the relative error of the parameter of a hit, with a margin: 2^-36.
const HIT_ERROR: f64 = 1.0 / (1_u64 << 36) as f64;

/// A block, and the parameter at which the ray enters its box.
struct Entered {
    enter: f64,
    block: u32,
}

impl Ord for Entered {
    /// Returns `Greater` for the earlier one or, if both are as early, the one with the lesser
    /// number.
    fn cmp(&self, other: &Self) -> Ordering {
        other.enter.total_cmp(&self.enter).then(other.block.cmp(&self.block))
    }
}

impl PartialOrd for Entered {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entered {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entered {}

impl HeightField {
    /// Returns the first face that a ray intersects, decided exactly, or `None`. The ray is in the
    /// frame of the field. The answer is that of [`Mesh::ray_cast`](crate::Mesh::ray_cast) for the
    /// mesh of the same triangles.
    ///
    /// # Complexity
    /// The blocks that the ray enters before the hit, and a small mesh for each block of 8 by 8
    /// cells with a cell whose box the ray enters.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<RayHit> {
        self.first_hit(ray, false)
    }

    /// Returns the first face that a ray intersects and that faces against the ray.
    pub(crate) fn ray_cast_fronts(&self, ray: &Ray) -> Option<RayHit> {
        self.first_hit(ray, true)
    }

    fn first_hit(&self, ray: &Ray, is_fronts_only: bool) -> Option<RayHit> {
        let (unit, scale) = ray.of_unit_size();
        let boxes = partition::Ray::new(unit.origin(), unit.direction(), f64::INFINITY).ok()?;
        let enters = |[min, max]: [[f64; 3]; 2]| boxes.enters(&MinMax::from_ordered(min, max));
        let hit_of = |faces: Vec<u32>| {
            let crop = self.crop(faces)?;
            let hit = if is_fronts_only { crop.mesh.ray_cast_fronts(ray) } else { crop.mesh.ray_cast(ray) };
            hit.map(|hit| RayHit { face: crop.face(hit.face), ..hit })
        };
        let mut queue = BinaryHeap::new();
        if let Some(enter) = self.local_bounds().and_then(enters) {
            queue.push(Entered { enter, block: 0 });
        }
        // The faces of blocks with a hit, and the earliest hit. Faces of several blocks are
        // compared together in the end, because hits may be equal.
        let (mut faces, mut best) = (Vec::new(), None::<RayHit>);
        while let Some(Entered { enter, block }) = queue.pop() {
            if best.is_some_and(|best| enter * scale > best.t * (1.0 + HIT_ERROR)) {
                break;
            }
            let mut of_block = Vec::new();
            for (child, bounds) in self.boxes(block) {
                let Some(enter) = enters(bounds) else { continue };
                match child {
                    Child::Inner(block) => queue.push(Entered { enter, block }),
                    Child::Leaf(cell) => of_block.extend([2 * cell, 2 * cell + 1]),
                }
            }
            if let Some(hit) = hit_of(of_block.clone()) {
                faces.extend(of_block);
                best = Some(best.filter(|best| best.t <= hit.t).unwrap_or(hit));
            }
        }
        if best.is_some() { hit_of(faces) } else { None }
    }
}
