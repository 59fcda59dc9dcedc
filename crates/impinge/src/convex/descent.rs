//! A local search for the direction of least depth, from a direction along which the depth is
//! nearly least.
//!
//! Each step takes a point outside of the set of differences, beyond the best direction so far. The
//! direction to that point from the nearest point of the set is closer to that of a local minimum.
//! Their angle shrinks by the ratio of the distances of both points from the center of curvature.
//! The nearest point is found as in `gjk`: each farthest difference brings the simplex nearer.
//!
//! The search only proposes directions. The height of the set along each of them is an upper bound
//! of the depth, even if the search fails. The lower bound is the one that was known before.
//!
//! # Source
//! Kim, Lin, Manocha, *Incremental penetration depth estimation between convex polytopes using
//! dual-space expansion*, IEEE Transactions on Visualization and Computer Graphics 10, 2004, who
//! walk over vertices. Ours walks over any set with a support function.
//!
//! The tests are below and in `tests/it/shapes/round_contacts.rs`.

use super::core_depth::CoreDepth;
use super::gjk::means;
use super::posed::{Difference, Pair, to_unit_entries, to_unit_length};
use super::push::Push;
use super::simplex::Simplex;
use crate::math::vec3::{dot, length};

/// Maximum number of steps. Ellipsoids take about 12, cylinders and cones 6 to 9.
const MAX_STEPS: usize = 32;

/// Distance of the search from the set of differences, relative to the smaller set. With a smaller
/// distance the nearest points take more steps. With a larger one the direction does.
const RELATIVE_DISTANCE: f64 = 0.25;

/// Improves the direction, the upper bound and the points of a depth that is above zero. The search
/// ends when a step gains at most `accuracy` and the points are within `accuracy` of the border of
/// the set. `start` has three differences near the point of the set along the best direction, and
/// `size` is that of the smaller set. All lengths are in the common unit.
pub(super) fn descend(pair: &Pair<'_>, start: &[Difference; 3], best: &mut CoreDepth, size: f64, accuracy: f64) {
    let mut simplex = Simplex::of(start);
    let mut points = best.points;
    for _ in 0..MAX_STEPS {
        let away = best.upper + RELATIVE_DISTANCE * size;
        let outside = to_unit_length(best.direction).map(|x| x * away);
        let nearest = simplex.nearest_to(&outside);
        let direction = to_unit_entries(nearest.towards_origin);
        if direction == [0.0; 3] {
            break;
        }
        points = means(&simplex, &nearest.weights);
        simplex.keep(&nearest.weights);
        let push = Push::along(pair, direction);
        let below = push.height - height(&points, &direction);
        let gain = best.upper - push.height;
        if gain > 0.0 {
            (best.upper, best.direction) = (push.height, direction);
        }
        let is_known = simplex.iter().any(|known| known.vector == push.farthest.vector);
        if gain <= accuracy && (below <= accuracy || is_known) {
            break;
        }
        if !is_known {
            simplex.push(push.farthest);
        }
    }
    if height(&points, &best.direction) > height(&best.points, &best.direction) {
        best.points = points;
    }
}

/// Returns how far the first of two points is beyond the second along a direction.
fn height(points: &[[f64; 3]; 2], direction: &[f64; 3]) -> f64 {
    (dot(direction, &points[0]) - dot(direction, &points[1])) / length(direction)
}

#[cfg(test)]
mod tests {
    use crate::convex::depth::{Effort, depth_in_order};
    use crate::convex::posed::{Core, Pair, Swept};
    use crate::convex::turned::Turned;
    use crate::math::Pose;
    use impinge_testkit::generate::{Rng, poses};

    /// Compares depths for contacts with depths that the polytope narrows as far as floats allow,
    /// for shapes with sizes that are powers of two, on a grid, and for others.
    #[test]
    fn the_search_gains_as_much_as_many_steps_of_the_polytope() {
        let mut rng = Rng::new(572);
        let (mut searched, mut close) = ([0; 2], [0; 2]);
        for round in 0..1_000 {
            let on_grid = round % 2 == 0;
            let turned = [0; 2].map(|_: i32| {
                let mut size = || if on_grid { rng.choose(&[0.25, 0.5, 1.0]) } else { rng.uniform(0.25, 1.0) };
                Turned { half_height: size(), radius: size(), is_cone: rng.one_in(2) }
            });
            let [here, there] = [0; 2].map(|_: i32| {
                let linear = if on_grid { poses::cube_symmetry(&mut rng) } else { poses::rotation(&mut rng).linear };
                let mut at = || if on_grid { 0.25 * rng.integer(-3, 3) as f64 } else { rng.uniform(-0.5, 0.5) };
                Pose::new(linear, [at(), at(), at()]).expect("a pose")
            });
            let swept = |at: usize, pose| Swept { core: Core::Turned(&turned[at]), pose, radius: [0.0; 2] };
            let (a, b) = (swept(0, &here), swept(1, &there));
            let pair = Pair::new(&a, &b);
            let size = pair.a.reach().min(pair.b.reach());
            let quick = depth_in_order(&pair, &a, &b, Effort::for_contact(&pair, size)).depth;
            let tight = depth_in_order(&pair, &a, &b, Effort::ROUND_DEPTH).depth;
            assert!(quick.lower <= tight.upper && tight.lower <= quick.upper, "{quick:?} {tight:?}");
            let (width, unit) = (quick.upper - quick.lower, size * pair.unit);
            // Contacts compute wider intervals again, with more steps.
            let is_searched = quick.lower > 0.0 && (unit / 16_777_216.0..unit / 8192.0).contains(&width);
            searched[round % 2] += u32::from(is_searched);
            close[round % 2] += u32::from(is_searched && quick.upper - tight.upper < unit / 1_048_576.0);
        }
        assert!(searched[0] > 10 && searched[1] > 200, "{searched:?}");
        assert!((0..2).all(|at| 10 * close[at] > 9 * searched[at]), "{close:?} of {searched:?}");
    }
}
