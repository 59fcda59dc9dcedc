//! Mean, covariance and principal axes of points (*Notes*, 2.3).
//!
//! The covariance is summed in a second pass, around the mean. The one-pass form of the *Notes*
//! (the mean of products minus the product of means) cancels: far from the origin it loses all
//! significant digits.
//!
//! Source: Golub and Van Loan, *Matrix Computations*, 8.5 (Jacobi rotations, in the order of rows).

use super::super::obb::orthonormal;
use super::enclosing::scaled_offset;
use crate::volume::points::{Coordinate, widen};

/// Returns the mean of the points, rounded. Offsets from `origin` are summed in scaled units.
pub(super) fn mean<T: Coordinate>(points: &[[T; 3]], origin: [f64; 3], scale: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for &point in points {
        let offset = scaled_offset(widen(point), origin, scale);
        sum = std::array::from_fn(|axis| sum[axis] + offset[axis]);
    }
    let count = points.len() as f64;
    std::array::from_fn(|axis| origin[axis] + sum[axis] / count / scale)
}

/// Returns unit vectors along the axes of the covariance, orthonormal up to rounding. The direction
/// of the largest spread comes first.
pub(super) fn principal_axes<T: Coordinate>(points: &[[T; 3]], origin: [f64; 3], scale: f64) -> [[f64; 3]; 3] {
    let mean = mean(points, origin, scale);
    let mut covariance = [[0.0; 3]; 3];
    for &point in points {
        let offset = scaled_offset(widen(point), mean, scale);
        for i in 0..3 {
            for j in i..3 {
                covariance[i][j] += offset[i] * offset[j];
            }
        }
    }
    for i in 0..3 {
        for j in 0..i {
            covariance[i][j] = covariance[j][i];
        }
    }
    let (values, vectors) = eigenvectors(covariance);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    orthonormal(order.map(|k| std::array::from_fn(|axis| vectors[axis][k])))
}

/// Returns the eigenvalues of a symmetric matrix, and its eigenvectors as columns.
fn eigenvectors(mut a: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    /// Number of Jacobi sweeps. Each sweep squares the remaining off-diagonal part. Six are enough
    /// for full precision from any start; the rest are a safety margin.
    const SWEEPS: usize = 12;
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            if !theta.is_finite() {
                continue; // negligible: counts as zero
            }
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for k in 0..3 {
                (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
            }
            for k in 0..3 {
                (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
            }
            for row in &mut vectors {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;

    #[test]
    fn the_axes_of_a_flat_cloud_are_found_anywhere() {
        let mut rng = Rng::new(3);
        for offset in [0.0, 1e7] {
            // 10 by 3 by 0.1 along (2, 2, 1), (-2, 1, 2), (1, -2, 2), all over 3.
            let frame = [[2.0, 2.0, 1.0], [-2.0, 1.0, 2.0], [1.0, -2.0, 2.0]].map(|row| row.map(|x| x / 3.0));
            let points: Vec<[f64; 3]> = (0..2000)
                .map(|_| {
                    let t = [10.0, 3.0, 0.1].map(|extent| extent * rng.uniform(-1.0, 1.0));
                    std::array::from_fn(|axis| offset + (0..3).map(|k| t[k] * frame[k][axis]).sum::<f64>())
                })
                .collect();
            let axes = principal_axes(&points, [offset; 3], 0.0625);
            for k in 0..3 {
                let cosine: f64 = (0..3).map(|axis| axes[k][axis] * frame[k][axis]).sum();
                assert!(cosine.abs() > 0.999, "{offset}: {axes:?}");
            }
        }
    }
}
