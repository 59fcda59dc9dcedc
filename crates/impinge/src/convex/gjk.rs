//! The distance of two cores as a proved interval.
//!
//! The iteration only proposes a direction, and a point of either core. The direction gives a lower
//! bound: the gap between the supports along it. The points give an upper bound: their distance.
//! The iteration may converge, run in a circle or run out of steps. In each case the bounds that
//! were proved on the way hold.
//!
//! # Source
//! Gilbert, Johnson, Keerthi, *A fast procedure for computing the distance between complex objects
//! in three-dimensional space*, IEEE Journal of Robotics and Automation 4, 1988; van den Bergen,
//! *Collision Detection in Interactive 3D Environments*, 2003, chapter 4, for its failures in
//! floats. Ours departs in that it decides nothing.
//!
//! The proof is docs/notes/proof.md, L20, and the tests are in `tests/it/shapes`.

use super::posed::{Difference, Pair, to_unit_entries};
use super::simplex::Simplex;
use crate::math::vec3::{dot, length, scaled_length, sub};

/// Maximum number of steps. Polytopes of thousands of vertices take 10 to 20. Cylinders and similar
/// shapes converge by a constant factor a step, and their interval is about 2^-40 wide after 64
/// steps.
const MAX_STEPS: usize = 64;

/// Width of an interval, in the common unit, at which more steps would only change the last digits:
/// 2^-50.
const TARGET_WIDTH: f64 = 4.0 * f64::EPSILON;

/// Bound on the relative error of the last few roundings of a bound: 2^-49.
pub(super) const SLACK: f64 = 8.0 * f64::EPSILON;

/// Proved bounds on the distance of two cores, in the common unit, with the direction and the
/// points that prove them.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    /// Lower bound on the distance, at least zero.
    pub(super) lower: f64,
    /// Direction from A to B along which the cores are at least `lower` apart. Any direction if
    /// `lower` is zero.
    pub(super) direction: [f64; 3],
    /// Upper bound on the distance.
    pub(super) upper: f64,
    /// A point of each core, up to rounding. Their distance is at most `upper`.
    pub(super) points: [[f64; 3]; 2],
    /// Up to four differences whose hull is nearly as near to the origin as the set of all
    /// differences.
    pub(super) simplex: Simplex,
}

/// Returns bounds on the distance of two cores, as narrow as they become.
pub(super) fn gap(pair: &Pair<'_>) -> Gap {
    gap_until(pair, |_| false)
}

/// Returns bounds on the distance of two cores, as soon as `enough` accepts them, or as narrow as
/// they become.
#[inline(always)]
pub(super) fn gap_until(pair: &Pair<'_>, enough: impl Fn(&Gap) -> bool) -> Gap {
    let mut direction = first_direction(pair);
    let mut simplex = Simplex::EMPTY;
    let mut gap = Gap { lower: 0.0, direction, upper: f64::INFINITY, points: [[0.0; 3]; 2], simplex };
    for _ in 0..MAX_STEPS {
        let farthest = pair.support(direction);
        let apart = separation(pair, direction, &farthest);
        if apart > gap.lower {
            (gap.lower, gap.direction) = (apart, direction);
        }
        if simplex.iter().any(|known| known.vector == farthest.vector) {
            break;
        }
        simplex.push(farthest);
        let nearest = simplex.nearest();
        let points = means(&simplex, &nearest.weights);
        simplex.keep(&nearest.weights);
        let upper = length_above(std::array::from_fn(|k| points[0][k] - points[1][k])) + pair.point_error();
        if upper >= gap.upper {
            break;
        }
        (gap.upper, gap.points, gap.simplex) = (upper, points, simplex);
        direction = to_unit_entries(nearest.towards_origin);
        if direction == [0.0; 3] || gap.upper - gap.lower <= TARGET_WIDTH || enough(&gap) {
            break;
        }
    }
    gap
}

/// Returns a direction from the middle of the first core to the middle of the second, or the first
/// axis if they are at one place. Along an axis, shapes about one place that are placed by hand
/// have opposite points, which a symmetric polytope can be built on.
fn first_direction(pair: &Pair<'_>) -> [f64; 3] {
    let [a, b] = [&pair.a, &pair.b].map(|set| set.spot(set.core().middle()).point);
    let towards_b = to_unit_entries(sub(&b, &a));
    if towards_b == [0.0; 3] { [1.0, 0.0, 0.0] } else { towards_b }
}

/// Returns the weighted means of the differences' points of A and of B.
pub(super) fn means(differences: &[Difference], weights: &[f64]) -> [[f64; 3]; 2] {
    let mut points = [[0.0; 3]; 2];
    for (difference, weight) in differences.iter().zip(weights) {
        for (point, spot) in points.iter_mut().zip([&difference.a, &difference.b]) {
            *point = std::array::from_fn(|k| point[k] + weight * spot.point[k]);
        }
    }
    points
}

/// Returns a lower bound on the gap between the cores along a direction from A to B, in the common
/// unit, or zero if no gap is proved.
pub(super) fn separation(pair: &Pair<'_>, direction: [f64; 3], farthest: &Difference) -> f64 {
    let height = dot(&direction, &farthest.a.point) - dot(&direction, &farthest.b.point);
    let apart = -height - pair.height_error(direction);
    // Written so that NaN proves nothing.
    if apart > 0.0 { apart / length(&direction) * (1.0 - SLACK) } else { 0.0 }
}

/// Returns a float not below the length of a vector of the common frame.
pub(super) fn length_above(vector: [f64; 3]) -> f64 {
    scaled_length(&vector) * (1.0 + SLACK)
}
