//! Axis-aligned boxes in f64 that provably contain the exact images of posed triangles.
//!
//! **Bound.** Let u = 2^-53, c = r0 x + r1 y + r2 z + t over the reals, and S = |r0 x| + |r1 y| +
//! |r2 z| + |t|. Computed in f64, c' differs from c by at most 4u/(1-4u) S, by one rounding of each
//! product and three sums, and by 3 · 2^-1075 if products underflow (Higham, *Accuracy and
//! Stability of Numerical Algorithms*, 3.1). The computed S' has the same error, so
//! S ≤ S'(1 + 5u) + 2^-1073 and |c' - c| ≤ 5u S' + 2^-1072. The reach used, `8u S' + 2^-1070`,
//! exceeds that by more than 1/3 of itself, and so by more than the rounding of its own sum.
//! Subtracting and adding it rounds once more, which one step outward compensates. If anything
//! overflows, the bounds are infinite.

use crate::{Affine, Posed};

/// Closed bounds in world coordinates, rounded outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldBox {
    /// Smallest coordinates.
    pub low: [f64; 3],
    /// Largest coordinates.
    pub high: [f64; 3],
}

impl WorldBox {
    /// Returns bounds of the exact image of one triangle.
    pub fn of_triangle(corners: &[[f64; 3]; 3], world_from_local: &Affine) -> Self {
        let mut bounds = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        for &corner in corners {
            let (image, reach) = image_and_reach(world_from_local, corner);
            for k in 0..3 {
                bounds.low[k] = bounds.low[k].min((image[k] - reach[k]).next_down());
                bounds.high[k] = bounds.high[k].max((image[k] + reach[k]).next_up());
            }
        }
        bounds
    }

    /// Returns bounds of every face of a mesh.
    pub fn of_faces(mesh: Posed) -> Vec<Self> {
        (0..mesh.faces.len()).map(|i| Self::of_triangle(&mesh.triangle(i), &mesh.world_from_local)).collect()
    }

    /// Reports whether the boxes have a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}

/// Returns the rounded image of a point, and a bound on its error along each axis.
pub(super) fn image_and_reach(world_from_local: &Affine, point: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    const EIGHT_ROUNDINGS: f64 = 4.0 * f64::EPSILON;
    /// 2^-1070, 16 times the smallest number: a bound on all underflows together.
    const UNDERFLOW: f64 = 16.0 * 5e-324;
    let mut image = world_from_local.apply_rounded(point);
    let size = Affine {
        linear: world_from_local.linear.map(|row| row.map(f64::abs)),
        translation: world_from_local.translation.map(f64::abs),
    }
    .apply_rounded(point.map(f64::abs));
    let mut reach = size.map(|s| EIGHT_ROUNDINGS * s + UNDERFLOW);
    for k in 0..3 {
        if !reach[k].is_finite() {
            (image[k], reach[k]) = (0.0, f64::INFINITY);
        }
    }
    (image, reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Rng;
    use crate::oracle::triangles_meet;

    #[test]
    fn boxes_hold_the_exact_images() {
        let mut rng = Rng::new(1);
        for round in 0..3_000 {
            let scale = [1.0, 2f64.powi(30), 2f64.powi(-30), 2f64.powi(100), 2f64.powi(-1060)][round % 5];
            let mut pose = Affine::new(
                std::array::from_fn(|_| std::array::from_fn(|_| rng.uniform(-2.0, 2.0))),
                std::array::from_fn(|_| rng.uniform(-2.0, 2.0) * scale),
            );
            let point: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0) * scale);
            if rng.one_in(2) {
                // If the image cancels, only rounding is left of it.
                pose.translation = [0.0; 3];
                pose.translation = pose.apply_rounded(point).map(|x| -x);
            }
            let bounds = WorldBox::of_triangle(&[point; 3], &pose);
            for k in 0..3 {
                // A map with only the k-th coordinate decides exactly whether the image is in the
                // interval.
                let only_k = Affine::new(
                    std::array::from_fn(|i| if i == 0 { pose.linear[k] } else { [0.0; 3] }),
                    [pose.translation[k], 0.0, 0.0],
                );
                let interval = [[bounds.low[k], 0.0, 0.0], [bounds.high[k], 0.0, 0.0], [bounds.low[k], 0.0, 0.0]];
                assert!(triangles_meet(&[point; 3], &only_k, &interval, &Affine::IDENTITY));
                let width = bounds.high[k] - bounds.low[k];
                assert!(width <= 3e-14 * scale + 1e-321, "the box must also be tight: {width}");
            }
        }
    }
}
