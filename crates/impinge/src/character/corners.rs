//! The corners of a hull in groups of four, for its support function.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use crate::math::vec3::Vector;
use crate::simd::{best_level, by_axis, dispatch};

const LANES: usize = 4;

/// Corners, one per lane. Unused lanes of the last group repeat its last corner.
#[derive(Clone, Debug)]
pub(super) struct Corners(Vec<[[f64; LANES]; 3]>);

impl Corners {
    pub(super) fn new(corners: &[Vector]) -> Self {
        let quad = |own: &[Vector]| {
            let lane = |lane: usize| own[lane.min(own.len() - 1)];
            [0, 1, 2].map(|k| [0, 1, 2, 3].map(|at| lane(at)[k]))
        };
        Self(corners.chunks(LANES).map(quad).collect())
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.0[..])
    }

    /// Returns a corner that is farthest along a direction, up to the rounding of three products.
    /// Returns the origin if there are no corners.
    ///
    /// # Complexity
    /// Scans all corners. For a few dozen corners this is faster than walking the hull to the
    /// farthest.
    pub(super) fn support(&self, direction: Vector) -> Vector {
        dispatch!(best_level(), simd => self.support_lanes(simd, direction))
    }

    #[inline(always)]
    fn support_lanes<S: Simd>(&self, simd: S, direction: Vector) -> Vector {
        let direction: [f64x4<S>; 3] = by_axis!(k => f64x4::splat(simd, direction[k]));
        let mut farthest = f64x4::splat(simd, f64::NEG_INFINITY);
        let mut corner = [f64x4::splat(simd, 0.0); 3];
        for quad in &self.0 {
            let own: [f64x4<S>; 3] = by_axis!(k => f64x4::from_slice(simd, &quad[k]));
            let along = own[0] * direction[0] + own[1] * direction[1] + own[2] * direction[2];
            let is_farther = along.simd_gt(farthest);
            farthest = is_farther.select(along, farthest);
            corner = by_axis!(k => is_farther.select(own[k], corner[k]));
        }
        let mut heights = [0.0; LANES];
        farthest.store_slice(&mut heights);
        let mut lanes = [[0.0; LANES]; 3];
        by_axis!(k => corner[k].store_slice(&mut lanes[k]));
        let best = (1..LANES).fold(0, |best, lane| if heights[lane] > heights[best] { lane } else { best });
        lanes.map(|own| own[best])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3::dot;
    use crate::simd::dispatch_every;
    use crate::simd::kernel_levels;

    #[test]
    fn no_corner_is_farther() {
        // On a grid, so that many corners are equally far, and for every number of corners.
        let grid = |i: usize| [i * 7 % 5, i * 3 % 4, i * 5 % 3].map(|x| x as f64 - 2.0);
        let corners: Vec<Vector> = (0..23).map(grid).collect();
        for count in 1..=corners.len() {
            let all = Corners::new(&corners[..count]);
            for direction in (0..60).map(grid) {
                let height = |p: &Vector| dot(p, &direction);
                let most = corners[..count].iter().map(height).fold(f64::NEG_INFINITY, f64::max);
                for (name, level) in kernel_levels() {
                    let found = dispatch_every!(level, simd => all.support_lanes(simd, direction));
                    assert!(
                        height(&found) == most && corners[..count].contains(&found),
                        "{name} {count} {direction:?}"
                    );
                    assert_eq!(found, all.support(direction));
                }
            }
        }
        assert_eq!(Corners::new(&[]).support([1.0, 0.0, 0.0]), [0.0; 3]);
    }
}
