//! Bounding boxes of convex sets in the world frame.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;

use super::posed::{Core, Pair, Swept};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::simd::{best_level, by_axis, dispatch};

/// Maximum number of corners whose images are all computed. For more corners the six extremes are
/// found by climbing. Computing all images takes 10 % of the time of climbing for a hull of 32
/// corners, and 33 % to 40 % for a hull of 512.
const MAX_SCANNED_CORNERS: usize = 1024;

impl Swept<'_> {
    /// Returns a box that holds the shape, as least and greatest corner in the world frame.
    ///
    /// # Accuracy
    /// The box is tight up to units of 2^-53 of the magnitudes that sum up to a coordinate: about 8
    /// units for corners, and the number of units in docs/notes/proof.md, L20, for other cores.
    #[inline]
    pub(crate) fn world_bounds(&self) -> [[f64; 3]; 2] {
        let at = self.pose.translation();
        let swept = |heights: [f64; 3]| by_axis!(axis => up(heights[axis] + self.radius[1]));
        let [against, along] = match self.core {
            Core::Points([[0.0, 0.0, 0.0]]) => [[up(self.radius[1]); 3]; 2],
            Core::Cuboid([.., half_extents]) => [swept(self.heights_of_box(half_extents)); 2],
            _ => self.heights_of_any().map(swept),
        };
        [by_axis!(axis => -up(against[axis] - at[axis])), by_axis!(axis => up(at[axis] + along[axis]))]
    }

    /// Returns upper bounds on the reach of any core against each axis of the world and along it,
    /// measured from the origin of the core's frame.
    fn heights_of_any(&self) -> [[f64; 3]; 2] {
        match self.core.corners() {
            Some(corners) if corners.len() <= MAX_SCANNED_CORNERS => self.heights_of_corners(corners),
            _ => self.heights_of_supports(),
        }
    }

    /// Returns upper bounds on the reach of the core against each axis of the world and along it,
    /// measured from the origin of the core's frame.
    ///
    /// A height is three products and two sums, wrong by 3.1 u of the magnitudes of its terms.
    /// These are at most the magnitudes at the greatest coordinates of any corner. The added error
    /// is rounded itself: 4.2 u in all, taken as 8. (u = 2^-53.)
    fn heights_of_corners(&self, corners: &[[f64; 3]]) -> [[f64; 3]; 2] {
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || {
            let linear = self.pose.linear();
            // The images of the three axes, and one lane to fill the vector.
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
            // Products that underflow lose less than the least normal number together.
            let vanished = f64x4::splat(simd, f64::MIN_POSITIVE);
            let error = (sizes[0] + sizes[1] + sizes[2]) * f64x4::splat(simd, 8.0 * UNIT_ROUNDOFF) + vanished;
            [error - low, high + error].map(|heights| {
                let mut all = [0.0; 4];
                heights.store_slice(&mut all);
                [all[0], all[1], all[2]]
            })
        }))
    }

    /// Returns upper bounds on the reach of a box about its origin along each axis of the world,
    /// which is its reach against the axis too. The error is that of
    /// [`heights_of_corners`](Self::heights_of_corners).
    #[inline]
    fn heights_of_box(&self, half_extents: &[f64; 3]) -> [f64; 3] {
        self.pose.linear().map(|row| {
            let terms = by_axis!(k => row[k].abs() * half_extents[k]);
            (terms[0] + terms[1] + terms[2]) * (1.0 + 8.0 * UNIT_ROUNDOFF) + f64::MIN_POSITIVE
        })
    }

    /// Returns the same bounds as [`heights_of_corners`](Self::heights_of_corners), from the
    /// farthest points along the axes.
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

/// Returns the next greater float. It has the bits of [`f64::next_up`] for every finite number, and
/// takes half of its instructions.
#[inline(always)]
fn up(x: f64) -> f64 {
    // A zero of either sign becomes a positive one. Magnitudes grow with their bits.
    let bits = (x + 0.0).to_bits() as i64;
    f64::from_bits((bits + (1 | bits >> 63)) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::dyadic::{self, Dyadic};
    use crate::math::{Pose, Sign};
    use impinge_testkit::Affine;
    use impinge_testkit::generate::{Rng, poses};

    /// Returns exactly how much the image of a corner exceeds a number along an axis.
    fn beyond(pose: &Pose, corner: [f64; 3], axis: usize, number: f64) -> Dyadic {
        let image = dyadic::dot(&pose.linear()[axis].map(Dyadic::from_f64), &corner.map(Dyadic::from_f64));
        &(&image + &Dyadic::from_f64(pose.translation()[axis])) - &Dyadic::from_f64(number)
    }

    fn parts(map: &Affine) -> ([[f64; 3]; 3], [f64; 3]) {
        (map.linear, map.translation)
    }

    #[test]
    fn boxes_hold_every_corner_exactly_and_little_more() {
        let mut rng = Rng::new(91);
        let (mut many, mut tight) = (0, 0);
        for round in 0..3000 {
            let (linear, translation) = match round % 3 {
                0 => parts(&poses::large_integer_map(&mut rng)),
                1 => parts(&poses::rotation(&mut rng)),
                _ => (poses::cube_symmetry(&mut rng), [0.1, 2.0, -1e3]),
            };
            let pose = Pose::new(linear, translation).unwrap();
            let size = rng.choose(&[1e-300, 1e-9, 1.0, 1e9, 1e30]);
            // Both methods of finding heights are tested. The corners are on a grid, so some
            // coincide.
            let count = if rng.one_in(40) { MAX_SCANNED_CORNERS + 8 } else { rng.choose(&[1, 3, 8]) };
            let corners: Vec<[f64; 3]> =
                (0..count).map(|_| [0; 3].map(|_: i32| size * rng.integer(-4, 4) as f64 * 0.37)).collect();
            let swept = Swept { core: Core::Points(&corners), pose: &pose, radius: [0.0; 2] };
            let [min, max] = swept.world_bounds();
            many += u32::from(count > MAX_SCANNED_CORNERS);
            for axis in 0..3 {
                let images = corners.iter().map(|corner| {
                    assert_ne!(beyond(&pose, *corner, axis, min[axis]).sign(), Sign::Negative, "{pose:?} {corners:?}");
                    assert_ne!(beyond(&pose, *corner, axis, max[axis]).sign(), Sign::Positive, "{pose:?} {corners:?}");
                    pose.apply(*corner)[axis]
                });
                let [low, high] =
                    images.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x: f64| [low.min(x), high.max(x)]);
                let reach = pose.linear()[axis].iter().map(|x| x.abs()).sum::<f64>() * size * 1.5;
                let slack = 1e-14 * (reach + pose.translation()[axis].abs()) + 1e-290;
                assert!(low - min[axis] <= slack && max[axis] - high <= slack, "{min:?} {max:?} {low} {high}");
                // A box that is rounded inwards would leave out a corner.
                tight += u32::from(low - min[axis] < 4.0 * f64::EPSILON * low.abs());
            }
        }
        assert!(many > 30 && tight > 1000, "{many} with many corners, {tight} ends within two units");
    }

    #[test]
    fn the_next_float_has_the_bits_of_the_standard_library() {
        let mut rng = Rng::new(92);
        let ends = [0.0, -0.0, f64::MAX, f64::MIN, f64::MIN_POSITIVE, -f64::MIN_POSITIVE, 5e-324, -5e-324, 1.0, -1.0];
        let any = (0..10_000).map(|_| f64::from_bits(rng.next_u64())).filter(|x| x.is_finite());
        for x in ends.into_iter().chain(any) {
            assert_eq!(up(x).to_bits(), x.next_up().to_bits(), "{x:e}");
            assert_eq!((-up(-x)).to_bits(), x.next_down().to_bits(), "{x:e}");
        }
    }

    #[test]
    fn a_sphere_widens_a_box_by_no_less_than_its_radius() {
        let pose = Pose::from_translation([0.1, -7.0, 1e12]).unwrap();
        let swept = Swept { core: Core::Points(&[[0.25; 3]]), pose: &pose, radius: [0.3; 2] };
        let [min, max] = swept.world_bounds();
        for axis in 0..3 {
            for (end, sign) in [(min[axis], -1.0), (max[axis], 1.0)] {
                let sphere = &Dyadic::from_f64(0.3) * &Dyadic::from_f64(sign);
                let past = &beyond(&pose, [0.25; 3], axis, end) + &sphere;
                assert_ne!(past.sign(), if sign < 0.0 { Sign::Negative } else { Sign::Positive });
            }
        }
    }
}
