//! Minimal sphere by trying every one, two, three and four points, in rational numbers (*Notes on
//! Real Time Collision Detection*, 2.3: the O(n⁵) method).
//!
//! It checks `volume::fit::minimal_sphere` on sets of up to seven points.

use dashu_ratio::RBig;

/// Exact smallest sphere that contains some points.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSphere {
    /// Center of the sphere.
    pub center: [RBig; 3],
    /// Square of the radius.
    pub squared_radius: RBig,
    /// Number of points on the sphere, including duplicates.
    pub on_it: usize,
}

/// Returns the smallest of the spheres through up to four points that contain all points, or `None`
/// without points.
///
/// # Complexity
/// The fifth power of the number of points.
///
/// # Panics
/// Panics if a number is not finite.
pub fn minimal_sphere(points: &[[f64; 3]]) -> Option<LeastSphere> {
    let exact: Vec<[RBig; 3]> = points.iter().map(|p| p.map(|x| RBig::try_from(x).expect("finite"))).collect();
    let mut least: Option<LeastSphere> = None;
    let n = exact.len();
    for i in 0..n {
        for j in i..n {
            for k in j..n {
                for l in k..n {
                    let mut chosen = vec![i, j, k, l];
                    chosen.dedup();
                    let Some((center, squared_radius)) = through(&exact, &chosen) else { continue };
                    if least.as_ref().is_some_and(|least| least.squared_radius <= squared_radius) {
                        continue;
                    }
                    let squares: Vec<RBig> = exact.iter().map(|p| square(&minus(p, &center))).collect();
                    if squares.iter().all(|square| *square <= squared_radius) {
                        let on_it = squares.iter().filter(|&square| *square == squared_radius).count();
                        least = Some(LeastSphere { center, squared_radius, on_it });
                    }
                }
            }
        }
    }
    least
}

/// Returns the center, in the affine hull of the chosen points, of the sphere through all of them,
/// and its squared radius. Returns `None` if the points are affinely dependent.
///
/// The center is p₀ + Σ λᵢ uᵢ with uᵢ · uⱼ λⱼ = uᵢ · uᵢ / 2, solved by elimination.
fn through(points: &[[RBig; 3]], chosen: &[usize]) -> Option<([RBig; 3], RBig)> {
    let first = &points[chosen[0]];
    let edges: Vec<[RBig; 3]> = chosen[1..].iter().map(|&i| minus(&points[i], first)).collect();
    let n = edges.len();
    let half = RBig::ONE / RBig::from(2);
    let mut rows: Vec<Vec<RBig>> =
        edges.iter().map(|u| edges.iter().map(|v| dot(u, v)).chain([square(u) * half.clone()]).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).find(|&row| rows[row][k] != RBig::ZERO)?;
        rows.swap(k, pivot);
        for row in (0..n).filter(|&row| row != k) {
            let factor = rows[row][k].clone() / rows[k][k].clone();
            for column in k..=n {
                let part = factor.clone() * rows[k][column].clone();
                rows[row][column] = rows[row][column].clone() - part;
            }
        }
    }
    let mut offset = [RBig::ZERO; 3];
    for (k, edge) in edges.iter().enumerate() {
        let weight = rows[k][n].clone() / rows[k][k].clone();
        offset = std::array::from_fn(|axis| offset[axis].clone() + weight.clone() * edge[axis].clone());
    }
    let center = std::array::from_fn(|axis| first[axis].clone() + offset[axis].clone());
    Some((center, square(&offset)))
}

fn minus(p: &[RBig; 3], q: &[RBig; 3]) -> [RBig; 3] {
    std::array::from_fn(|k| p[k].clone() - q[k].clone())
}

fn dot(p: &[RBig; 3], q: &[RBig; 3]) -> RBig {
    (0..3).fold(RBig::ZERO, |sum, k| sum + p[k].clone() * q[k].clone())
}

fn square(p: &[RBig; 3]) -> RBig {
    dot(p, p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_spheres_are_found() {
        let rational = |numerator: i32, denominator: i32| RBig::from(numerator) / RBig::from(denominator);
        let cube: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let sphere = minimal_sphere(&cube).unwrap();
        assert_eq!((sphere.center, sphere.on_it), ([rational(1, 2), rational(1, 2), rational(1, 2)], 8));
        assert_eq!(sphere.squared_radius, rational(3, 4));
        // An equilateral triangle needs all three points, an obtuse one needs two, and a point
        // inside is not needed.
        let triangle = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(minimal_sphere(&triangle).unwrap().squared_radius, rational(2, 3));
        let obtuse = [[0.0; 3], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let sphere = minimal_sphere(&obtuse).unwrap();
        assert_eq!((sphere.squared_radius, sphere.on_it), (rational(4, 1), 2));
        assert_eq!(minimal_sphere(&[[5.0; 3]; 3]).unwrap().squared_radius, RBig::ZERO);
        assert_eq!(minimal_sphere(&[]), None);
    }
}
