//! A first polytope about the origin, built from the simplex that the distance computation left.
//! The expanding polytope starts with it, and it is often enough to prove that the cores intersect.
//!
//! Shapes that are aligned, as most shapes placed by hand are, leave the origin on a face or an
//! edge of their simplex. Points on either side then make a double pyramid about a face, or eight
//! triangles about an edge.

use super::expand::Polytope;
use super::posed::{Difference, Pair, to_unit_entries};
use super::simplex;
use crate::hull::{Hull, HullKind};
use crate::math::vec3::{cross, sub};

/// Minimum weight of a corner in the mean that gives the origin: 2^-40. A smaller weight counts as
/// zero up to rounding, and the origin then lies on the face or edge of the other corners.
const MIN_WEIGHT: f64 = 1.0 / (1_u64 << 40) as f64;

/// Reports whether the cores certainly have a common point. This is proved if a polytope of
/// differences contains the origin with a margin above the error of the differences. The polytope
/// grows by a few points if the first one proves nothing. `false` means undecided.
pub(super) fn certainly_intersect(pair: &Pair<'_>, simplex: &[Difference]) -> bool {
    const MAX_POINTS: usize = 48;
    let Some(mut polytope) = about_origin(pair, simplex) else { return false };
    while let Some(nearest) = polytope.nearest() {
        if nearest.lower > pair.point_error() {
            return true;
        }
        if !polytope.grow(&nearest, pair.support(nearest.direction), MAX_POINTS) {
            break;
        }
    }
    false
}

/// Reports whether the first polytope about the origin contains it with a margin above the error of
/// the differences. Then the cores have a common point.
pub(super) fn polytope_holds_origin(pair: &Pair<'_>, simplex: &[Difference]) -> bool {
    around_simplex(pair, simplex)
        .and_then(|polytope| polytope.nearest())
        .is_some_and(|nearest| nearest.lower > pair.point_error())
}

/// Builds a polytope about the origin from the simplex that the distance computation left. Returns
/// `None` if no polytope with the origin well inside is found.
pub(super) fn about_origin(pair: &Pair<'_>, simplex: &[Difference]) -> Option<Polytope> {
    around_simplex(pair, simplex).or_else(|| hull_of_more(pair, simplex))
}

/// Builds a polytope about the origin from the corners that count in a simplex, and a few points on
/// either side of them.
fn around_simplex(pair: &Pair<'_>, simplex: &[Difference]) -> Option<Polytope> {
    match counting(simplex)[..] {
        [p, q] => around_edge(pair, p, q),
        [p, q, r] => around_face(pair, p, q, r),
        ref corners => Polytope::about_origin(corners),
    }
}

/// Returns the corners whose weight in the origin is at least [`MIN_WEIGHT`].
fn counting(simplex: &[Difference]) -> Vec<Difference> {
    let vectors: Vec<[f64; 3]> = simplex.iter().map(|corner| corner.vector).collect();
    let weights = if vectors.is_empty() { [0.0; 4] } else { simplex::nearest(&vectors).weights };
    simplex.iter().zip(weights).filter(|&(_, weight)| weight > MIN_WEIGHT).map(|(corner, _)| *corner).collect()
}

/// Builds a double pyramid from a triangle with the origin inside and the farthest differences on
/// either side of it.
fn around_face(pair: &Pair<'_>, p: Difference, q: Difference, r: Difference) -> Option<Polytope> {
    let up = to_unit_entries(cross(&sub(&q.vector, &p.vector), &sub(&r.vector, &p.vector)));
    let [above, below] = both_ways(up).map(|direction| pair.support(direction));
    Polytope::about_origin(&[p, q, r, above, below])
}

/// Builds eight triangles from a segment with the origin inside and the farthest differences in
/// four directions across it.
fn around_edge(pair: &Pair<'_>, p: Difference, q: Difference) -> Option<Polytope> {
    let along = to_unit_entries(sub(&q.vector, &p.vector));
    let least = (0..3).min_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs()))?;
    let across = to_unit_entries(cross(&along, &std::array::from_fn(|k| f64::from(u8::from(k == least)))));
    let [[east, west], [north, south]] = [across, to_unit_entries(cross(&along, &across))]
        .map(|direction| both_ways(direction).map(|direction| pair.support(direction)));
    Polytope::about_origin(&[p, q, east, north, west, south])
}

/// Builds the hull of more points, in directions that are not normal to facets of boxes. It serves
/// if the border of the set is near the origin.
fn hull_of_more(pair: &Pair<'_>, simplex: &[Difference]) -> Option<Polytope> {
    let mut points = simplex.to_vec();
    for direction in DIRECTIONS.into_iter().flat_map(both_ways) {
        let point = pair.support(direction);
        if points.iter().all(|known| known.vector != point.vector) {
            points.push(point);
        }
    }
    let vectors: Vec<[f64; 3]> = points.iter().map(|point| point.vector).collect();
    let hull = Hull::new(&vectors).ok()?;
    (hull.kind() == HullKind::Solid).then(|| {
        let points: Vec<Difference> = hull.vertices().iter().map(|&vertex| points[vertex as usize]).collect();
        Polytope::new(&points, hull.faces())
    })
}

fn both_ways(direction: [f64; 3]) -> [[f64; 3]; 2] {
    [direction, direction.map(|x| -x)]
}

/// Seven directions. No plane holds more than three of them.
const DIRECTIONS: [[f64; 3]; 7] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.875, 0.75],
    [-1.0, 0.875, 0.75],
    [1.0, -0.875, 0.75],
    [1.0, 0.875, -0.75],
];

#[cfg(test)]
mod tests {
    use super::super::posed::{Core, Swept};
    use super::*;
    use crate::math::Pose;

    /// The corners of a double pyramid and of an octahedron, both about the origin.
    const PYRAMIDS: [[f64; 3]; 5] =
        [[2.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    const OCTAHEDRON: [[f64; 3]; 6] =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];

    /// Returns the result of `ask` for the differences of a polytope, given by its corners, and a
    /// point at the origin.
    fn found<T>(corners: &[[f64; 3]], ask: impl Fn(&Pair<'_>, Vec<Difference>) -> T) -> T {
        let core = |points| Swept { core: Core::Points(points), pose: &Pose::IDENTITY, radius: [0.0; 2] };
        let (polytope, point) = (core(corners), core(&[[0.0; 3]]));
        let pair = Pair::new(&polytope, &point);
        let differences = corners.iter().map(|corner| {
            let spot = pair.a.spot(*corner);
            Difference::between(spot, pair.b.spot([0.0; 3]))
        });
        let differences = differences.collect();
        ask(&pair, differences)
    }

    #[test]
    fn points_to_either_side_are_enough_about_a_face_and_an_edge() {
        let lower =
            |polytope: Option<Polytope>| polytope.and_then(|polytope| polytope.nearest()).map(|near| near.lower);
        found(&PYRAMIDS, |pair, all| {
            // The nearest planes are those over the edges to the far corner, whose triangle is
            // 2/√10 wide and 1 high.
            let least = (2.0_f64 / 7.0).sqrt() / pair.unit;
            for [p, q, r] in [[0, 1, 2], [1, 2, 0], [2, 1, 0]].map(|corners| corners.map(|corner| all[corner])) {
                let bound = lower(around_face(pair, p, q, r)).expect("a double pyramid");
                assert!((bound - least).abs() < 1e-12, "{bound}, not {least}");
            }
            assert!(around_face(pair, all[0], all[1], all[3]).is_none());
        });
        found(&OCTAHEDRON, |pair, all| {
            let least = (1.0_f64 / 3.0).sqrt() / pair.unit;
            for [p, q] in [[0, 1], [1, 0], [2, 3], [5, 4]].map(|corners| corners.map(|corner| all[corner])) {
                let bound = lower(around_edge(pair, p, q)).expect("an octahedron");
                assert!((bound - least).abs() < 1e-12, "{bound}, not {least}");
            }
            assert!(around_edge(pair, all[0], all[2]).is_none());
        });
    }

    #[test]
    fn corners_of_tiny_weight_are_left_out() {
        found(&PYRAMIDS, |pair, all| {
            // The origin is in the face of the first three corners, so the tetrahedron does not
            // hold it with a margin.
            assert_eq!(counting(&all[..4]).len(), 3);
            assert!(Polytope::about_origin(&all[..4]).is_none() && about_origin(pair, &all[..4]).is_some());
            assert!(certainly_intersect(pair, &all[..4]) && certainly_intersect(pair, &[]));
        });
    }
}
