//! Squared distance of two convex hulls in integers of any size, with a proof of the answer.
//!
//! All differences of points are formed. From the shortest one, a simplex of up to four differences
//! is improved. Its nearest point to the origin follows from the normal equations of each of its
//! parts by Cramer's rule, and any difference beyond the plane through that point joins. The result
//! is checked against every difference: if x is in the hull and x·y ≥ x·x for every y, no point is
//! nearer, however x was found. It checks `query::distance` of shapes.

use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

use crate::Affine;

type Vector = [IBig; 3];

/// Point of a simplex's hull over a common denominator, and the part of the simplex whose hull
/// contains it.
struct Nearest {
    numerators: Vector,
    denominator: IBig,
    part: Vec<Vector>,
}

/// Returns the squared distance of the convex hulls of two sets of points, each under its map.
///
/// # Complexity
/// The product of the numbers of points, times the number of steps.
///
/// # Panics
/// Panics if a set is empty or a number is not finite.
pub fn squared_distance_of_hulls(a: &[[f64; 3]], place_a: &Affine, b: &[[f64; 3]], place_b: &Affine) -> RBig {
    let (a, b) = (images(a, place_a), images(b, place_b));
    let (denominator, differences) = on_grid(&a, &b);
    let mut nearest = single(differences.iter().min_by_key(|y| dot(y, y)).expect("not empty").clone());
    loop {
        let squared = dot(&nearest.numerators, &nearest.numerators);
        let height = |y: &Vector| dot(&nearest.numerators, y);
        let lowest = differences.iter().min_by_key(|y| height(y)).expect("not empty");
        if height(lowest) * &nearest.denominator >= squared {
            let scale = nearest.denominator * IBig::from(denominator);
            return RBig::from(squared) / RBig::from(&scale * &scale);
        }
        let mut simplex = nearest.part.clone();
        simplex.push(lowest.clone());
        nearest = nearest_of(&simplex);
    }
}

fn images(points: &[[f64; 3]], place: &Affine) -> Vec<[RBig; 3]> {
    let exact = |x: f64| RBig::try_from(x).expect("finite");
    let image = |point: &[f64; 3]| {
        std::array::from_fn(|k| {
            (0..3).fold(exact(place.translation[k]), |sum, j| sum + exact(place.linear[k][j]) * exact(point[j]))
        })
    };
    points.iter().map(image).collect()
}

/// Returns all differences as integers over one denominator.
fn on_grid(a: &[[RBig; 3]], b: &[[RBig; 3]]) -> (UBig, Vec<Vector>) {
    // Denominators are powers of two, so the largest is a multiple of all.
    let denominator = a.iter().chain(b).flatten().map(RBig::denominator).max().expect("not empty").clone();
    let scaled = |x: &RBig| x.numerator() * IBig::from(&denominator / x.denominator());
    let [a, b] = [a, b].map(|points| points.iter().map(|p| p.each_ref().map(scaled)).collect::<Vec<Vector>>());
    let differences = a.iter().flat_map(|p| b.iter().map(|q| minus(p, q))).collect();
    (denominator, differences)
}

fn single(y: Vector) -> Nearest {
    Nearest { numerators: y.clone(), denominator: IBig::ONE, part: vec![y] }
}

/// Returns the nearest point of the simplex to the origin: the nearest among the points of its
/// parts that are inside their part.
fn nearest_of(simplex: &[Vector]) -> Nearest {
    let mut best: Option<(RBig, Nearest)> = None;
    for bits in 1_usize..1 << simplex.len() {
        let part: Vec<Vector> = (0..simplex.len()).filter(|i| bits >> i & 1 == 1).map(|i| simplex[i].clone()).collect();
        let Some(found) = nearest_inside(&part) else { continue };
        let squared =
            RBig::from(dot(&found.numerators, &found.numerators)) / RBig::from(&found.denominator * &found.denominator);
        if best.as_ref().is_none_or(|(least, _)| squared < *least) {
            best = Some((squared, found));
        }
    }
    best.expect("a corner is a part").1
}

/// Returns the point of the part's affine hull nearest to the origin, if it is inside the part's
/// hull.
///
/// With p the first corner and u the edges, the weights solve (u_i·u_j) w = -u_i·p.
fn nearest_inside(part: &[Vector]) -> Option<Nearest> {
    let p = &part[0];
    let edges: Vec<Vector> = part[1..].iter().map(|q| minus(q, p)).collect();
    let n = edges.len();
    let gram: Vec<Vec<IBig>> = edges.iter().map(|u| edges.iter().map(|v| dot(u, v)).collect()).collect();
    let denominator = determinant(&gram);
    if denominator == IBig::ZERO {
        return None;
    }
    let mut rest = denominator.clone();
    let mut numerators = p.each_ref().map(|x| x * &denominator);
    for i in 0..n {
        let mut replaced = gram.clone();
        for (row, edge) in replaced.iter_mut().zip(&edges) {
            row[i] = -dot(edge, p);
        }
        let weight = determinant(&replaced);
        if weight < IBig::ZERO {
            return None;
        }
        rest -= &weight;
        numerators = std::array::from_fn(|k| &numerators[k] + &weight * &edges[i][k]);
    }
    (rest >= IBig::ZERO).then(|| Nearest { numerators, denominator, part: part.to_vec() })
}

/// Returns the determinant, expanded by the first row. It is 1 for a matrix without rows.
fn determinant(matrix: &[Vec<IBig>]) -> IBig {
    let Some(first) = matrix.first() else { return IBig::ONE };
    let mut sum = IBig::ZERO;
    for (column, entry) in first.iter().enumerate() {
        let minor: Vec<Vec<IBig>> = matrix[1..]
            .iter()
            .map(|row| row.iter().enumerate().filter(|(k, _)| *k != column).map(|(_, x)| x.clone()).collect())
            .collect();
        let term = entry * determinant(&minor);
        if column % 2 == 0 { sum += term } else { sum -= term }
    }
    sum
}

fn minus(p: &Vector, q: &Vector) -> Vector {
    std::array::from_fn(|k| &p[k] - &q[k])
}

fn dot(p: &Vector, q: &Vector) -> IBig {
    (0..3).map(|k| &p[k] * &q[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_distances_are_found() {
        let cube: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let at = |translation| Affine::new(identity, translation);
        let squared = |translation| squared_distance_of_hulls(&cube, &at([0.0; 3]), &cube, &at(translation));
        assert_eq!(squared([0.5, 0.25, 0.0]), RBig::ZERO);
        assert_eq!(squared([1.0, 1.0, -1.0]), RBig::ZERO);
        assert_eq!(squared([3.0, 0.5, 0.0]), RBig::from(4));
        assert_eq!(squared([3.0, -3.0, 2.0]), RBig::from(9));
        // A corner over the inside of an oblique face: 1/3 of the square of the diagonal.
        let triangle = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let found = squared_distance_of_hulls(&triangle, &at([0.0; 3]), &[[0.0; 3]], &at([0.0; 3]));
        assert_eq!(found * RBig::from(3), RBig::ONE);
    }
}
