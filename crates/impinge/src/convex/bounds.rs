//! Boxes about convex sets in the world.

use fearless_simd::prelude::*;
use fearless_simd::{dispatch, f64x4};

use super::posed::{Core, Pair, Swept};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::simd::{best_level, by_axis};

/// Corners of which the images are taken all, which for so many takes no longer than to look for the six that count.
const FEW: usize = 32;

impl Swept<'_> {
    /// A box of the world that holds the shape.
    ///
    /// # Accuracy
    /// Tight but for units of 2^-53 of the magnitudes that sum up to a coordinate: about 8 for a few corners, and as many as L20
    /// of docs/proof.md says for other cores.
    pub(crate) fn world_bounds(&self) -> [[f64; 3]; 2] {
        let [against, along] = match self.core.corners() {
            Some(corners) if corners.len() <= FEW => self.heights_of_corners(corners),
            _ => self.heights_of_supports(),
        };
        let at = self.pose.translation();
        let swept = |height: f64| (height + self.radius[1]).next_up();
        [
            by_axis!(axis => (at[axis] - swept(against[axis])).next_down()),
            by_axis!(axis => (at[axis] + swept(along[axis])).next_up()),
        ]
    }

    /// How far the core reaches at most against each axis of the world and along it, as seen from the origin of its own frame.
    ///
    /// A height is three products and two sums, off by 3.1 u of the magnitudes of its terms, which are at most those at the
    /// greatest coordinates of any corner, and what is added to it is rounded itself: 4.2 u in all, taken as 8.
    fn heights_of_corners(&self, corners: &[[f64; 3]]) -> [[f64; 3]; 2] {
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            let linear = self.pose.linear();
            // The images of the three axes, and a lane to fill the vector.
            let columns = by_axis!(k => f64x4::from_slice(simd, &[linear[0][k], linear[1][k], linear[2][k], 0.0]));
            let mut low = f64x4::splat(simd, f64::INFINITY);
            let (mut high, mut reach) = (-low, [0.0; 3]);
            for corner in corners {
                let terms = by_axis!(k => columns[k] * f64x4::splat(simd, corner[k]));
                let height = terms[0] + terms[1] + terms[2];
                (low, high) = (low.min(height), high.max(height));
                reach = by_axis!(k => if corner[k].abs() > reach[k] { corner[k].abs() } else { reach[k] });
            }
            let sizes = by_axis!(k => columns[k].abs() * f64x4::splat(simd, reach[k]));
            // Products that vanish lose less than the least normal number together.
            let vanished = f64x4::splat(simd, f64::MIN_POSITIVE);
            let error = (sizes[0] + sizes[1] + sizes[2]) * f64x4::splat(simd, 8.0 * UNIT_ROUNDOFF) + vanished;
            [error - low, high + error].map(|heights| {
                let mut all = [0.0; 4];
                heights.store_slice(&mut all);
                [all[0], all[1], all[2]]
            })
        }))
    }

    /// The same by the points that are farthest along the axes.
    fn heights_of_supports(&self) -> [[f64; 3]; 2] {
        let origin = Swept { core: Core::Points(&[[0.0; 3]]), pose: self.pose, radius: [0.0; 2] };
        let pair = Pair::new(&origin, self);
        [-1.0, 1.0].map(|sign: f64| {
            by_axis!(axis => {
                let direction = std::array::from_fn(|k| if k == axis { sign } else { 0.0 });
                let height = sign * pair.b.support(direction).point[axis] + pair.height_error(direction);
                (height * pair.unit).next_up()
            })
        })
    }
}
