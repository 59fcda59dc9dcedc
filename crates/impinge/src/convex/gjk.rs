//! The distance of two cores as a proved interval.
//!
//! The iteration only proposes: a direction, and a point of either core. The direction is worth the gap between the supports
//! along it, which no two points can be closer than; the points are worth their distance. However the iteration ends, by
//! arriving, by running in a circle or by running out of steps, what was proved on the way holds.
//!
//! # Source
//! Gilbert, Johnson, Keerthi, *A fast procedure for computing the distance between complex objects in three-dimensional
//! space*, IEEE Journal of Robotics and Automation 4, 1988; van den Bergen, *Collision Detection in Interactive 3D
//! Environments*, 2003, chapter 4, for how it goes astray in floats. Ours departs in that it decides nothing.

use super::posed::{Difference, Pair, to_unit_entries};
use super::simplex::Simplex;
use crate::math::vec3::{dot, length, scaled_length};

/// The most steps. Polytopes of thousands of vertices take 10 to 20; cylinders and their like approach the end by a factor a
/// step, which makes the interval some 2^-40 wide by then.
const STEPS: usize = 64;

/// The width of an interval, in the common unit, at which more steps would only shuffle the last digits: 2^-50.
const NARROW: f64 = 4.0 * f64::EPSILON;

/// More than the relative error of the last few roundings of a bound: 2^-49.
pub(super) const SLACK: f64 = 8.0 * f64::EPSILON;

/// What is proved of the distance of two cores, in the common unit, and by what.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    /// Not above the distance; not negative.
    pub(super) lower: f64,
    /// The direction from A to B along which the cores are that far apart; any where the bound is zero.
    pub(super) direction: [f64; 3],
    /// Not below the distance.
    pub(super) upper: f64,
    /// A point of each core, up to rounding, as close as the upper bound says.
    pub(super) points: [[f64; 3]; 2],
    /// Up to four differences whose hull is nearly as near to the origin as that of all.
    pub(super) simplex: Simplex,
}

/// Bounds of the distance of two cores, as narrow as they become.
pub(super) fn gap(pair: &Pair<'_>) -> Gap {
    gap_until(pair, |_| false)
}

/// Bounds of the distance of two cores that are `enough`, or as narrow as they become.
#[inline(always)]
pub(super) fn gap_until(pair: &Pair<'_>, enough: impl Fn(&Gap) -> bool) -> Gap {
    let towards_b: [f64; 3] = std::array::from_fn(|k| pair.b.spot([0.0; 3]).point[k] - pair.a.spot([0.0; 3]).point[k]);
    let mut direction = to_unit_entries(towards_b);
    let mut simplex = Simplex::EMPTY;
    let mut gap = Gap { lower: 0.0, direction, upper: f64::INFINITY, points: [[0.0; 3]; 2], simplex };
    for _ in 0..STEPS {
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
        if direction == [0.0; 3] || gap.upper - gap.lower <= NARROW || enough(&gap) {
            break;
        }
    }
    gap
}

/// The means of the differences' points of A and of B.
pub(super) fn means(differences: &[Difference], weights: &[f64]) -> [[f64; 3]; 2] {
    let mut points = [[0.0; 3]; 2];
    for (difference, weight) in differences.iter().zip(weights) {
        for (point, spot) in points.iter_mut().zip([&difference.a, &difference.b]) {
            *point = std::array::from_fn(|k| point[k] + weight * spot.point[k]);
        }
    }
    points
}

/// By how much the cores are certainly apart along a direction from A to B; zero where that is not certain.
pub(super) fn separation(pair: &Pair<'_>, direction: [f64; 3], farthest: &Difference) -> f64 {
    let height = dot(&direction, &farthest.a.point) - dot(&direction, &farthest.b.point);
    let apart = -height - pair.height_error(direction);
    // Compared so that NaN proves nothing.
    if apart > 0.0 { apart / length(&direction) * (1.0 - SLACK) } else { 0.0 }
}

/// A float not below the length of a vector of the common frame.
pub(super) fn length_above(vector: [f64; 3]) -> f64 {
    scaled_length(&vector) * (1.0 + SLACK)
}
