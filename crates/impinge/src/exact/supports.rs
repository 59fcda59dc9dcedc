//! Supporting planes: a proof that two sets of points are farther apart than a given distance.
//!
//! Both planes are perpendicular to one direction, from A to B. All points of A lie behind the
//! plane of A, and all points of B lie in front of the plane of B. So the sets are at least as far
//! apart as the planes. The distance of the planes is evaluated in world units, in double-double
//! numbers with an error bound, so a proof is exact (docs/notes/proof.md, L13a). A gap that exceeds
//! the distance by less than the bound proves nothing. Two triangles take about 1 microsecond; the
//! exact comparison takes about 10.
//!
//! Source: the support planes of Gilbert, Johnson, Keerthi, *A fast procedure for computing the
//! distance between complex objects in three-dimensional space*, IEEE Journal of Robotics and
//! Automation 4(2), 1988. Ours departs in the exact evaluation.
//!
//! The direction decides how much is proved. If the sets face each other with edges or faces, the
//! floats nearest to the right direction are tilted by a rounding error, which loses a part of the
//! gap that grows with the length of the edge. So the direction is made perpendicular to the edges
//! that rest on the planes.
//!
//! The tests `supports_*` below, and `plates_*` in `tests/it/distance/clearances.rs` and
//! `plates.rs`, guard this file.

use super::double_double::{DoubleDouble, cross, difference, dot};
use super::exact_points::Corners;
use super::placement::Placement;
use crate::math::Pose;
use crate::math::vec3::{self, Vector};

/// Maximum distance of a corner that counts as resting on a plane, relative to the size of the
/// triangle: about 2^-30. It is above the rounding of a direction, and below the distances between
/// separate corners. It affects which gaps are proved, but never makes a proof wrong.
const RESTING_TOLERANCE: f64 = 1e-9;

/// Squared sine of the angle below which two edges count as parallel.
const PARALLEL_SINE_SQUARED: f64 = 1e-12;

/// Maximum relative difference of squared distances that count as equal. The given points differ
/// from the nearest ones by a rounding error across the line between them, so the squared distance
/// changes only by the square of this error.
const EQUAL_DISTANCES: f64 = 1e-24;

/// A direction in the world frame, of any length, with twice the digits of a float.
pub(crate) struct Supports {
    direction: [DoubleDouble; 3],
}

impl Supports {
    /// Builds the direction near `from_a_to_b`, in the world frame, that is perpendicular to the
    /// edges resting on the planes across it.
    pub(crate) fn of_triangles(placement: &Placement, a: &Corners, b: &Corners, from_a_to_b: Vector) -> Self {
        let edges_of = |pose: &Pose, corners: &Corners, towards: Vector| {
            let world = corners.map(|corner| DoubleDouble::world_point(pose, &corner));
            let edges = [[0, 1], [1, 2], [2, 0]].map(|[from, to]| difference(&world[to], &world[from]));
            let size = edges.iter().map(|edge| vec3::length(&rounded(edge))).fold(0.0, f64::max);
            // Height of each corner along the direction, from the heights of the edges that lead to
            // it.
            let [to_1, to_2, _] = edges.each_ref().map(|edge| vec3::dot(&towards, &rounded(edge)));
            let heights = [0.0, to_1, to_1 + to_2];
            let highest = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let rests = heights.map(|height| highest - height <= RESTING_TOLERANCE * size * vec3::length(&towards));
            let resting = [[0, 1], [1, 2], [2, 0]].map(|[from, to]| rests[from] && rests[to]);
            edges.into_iter().zip(resting).filter_map(|(edge, rests)| rests.then_some(edge))
        };
        let (a_pose, b_pose) = (placement.world_from_a(), placement.world_from_b());
        let resting = edges_of(a_pose, a, from_a_to_b).chain(edges_of(b_pose, b, from_a_to_b.map(|x| -x)));
        Self { direction: perpendicular(from_a_to_b, resting) }
    }

    /// Reports whether all points of A and B, placed in the world, are proved to be farther apart
    /// than `clearance`, in world units. Returns `false` if that is not proved.
    pub(crate) fn are_farther_than(
        &self,
        placement: &Placement,
        a: impl Iterator<Item = [f64; 3]> + Clone,
        b: impl Iterator<Item = [f64; 3]> + Clone,
        clearance: f64,
    ) -> bool {
        let gap = self.gap(placement, a, b);
        let least = DoubleDouble::of(clearance);
        let squared = dot(&self.direction, &self.direction).times(&least.times(&least));
        gap.is_positive() && gap.times(&gap).minus(&squared).is_positive()
    }

    /// Returns an interval that holds the distance of A and B, in world units, a few units of the
    /// last place wide. Returns `None` unless it proves that no two points of A and B are nearer
    /// than two given points, to within the tolerance [`EQUAL_DISTANCES`]. Each given point lies on
    /// one of the triangles `corners`; `shares` are its barycentric coordinates for the second and
    /// the third corner.
    pub(crate) fn distance(
        &self,
        placement: &Placement,
        a: impl Iterator<Item = [f64; 3]> + Clone,
        b: impl Iterator<Item = [f64; 3]> + Clone,
        corners: [&Corners; 2],
        shares: [[f64; 2]; 2],
    ) -> Option<[f64; 2]> {
        let gap = self.gap(placement, a, b);
        if !gap.is_positive() {
            return None;
        }
        let least = gap.times(&gap).over(&dot(&self.direction, &self.direction));
        let of_points = squared_distance(placement, corners, shares)?;
        let [difference, error] = of_points.minus(&least).rounded();
        let are_equal = difference + error <= EQUAL_DISTANCES * least.rounded()[0];
        if are_equal { Some([least.root_below()?, of_points.root_above()?]) } else { None }
    }

    /// Returns a lower bound on the distance between the planes, times the length of the direction.
    fn gap(
        &self,
        placement: &Placement,
        a: impl Iterator<Item = [f64; 3]> + Clone,
        b: impl Iterator<Item = [f64; 3]> + Clone,
    ) -> DoubleDouble {
        let towards_a = self.direction.each_ref().map(DoubleDouble::negated);
        let reach_a = reach(&self.direction, placement.world_from_a(), a);
        let reach_b = reach(&towards_a, placement.world_from_b(), b);
        reach_a.plus(&reach_b).negated()
    }
}

/// Returns the squared distance of two points of triangles, in world units. `shares` are their
/// barycentric coordinates for the second and the third corner. Returns `None` if one is negative
/// or their sum is above 1.
fn squared_distance(placement: &Placement, corners: [&Corners; 2], shares: [[f64; 2]; 2]) -> Option<DoubleDouble> {
    let poses = [placement.world_from_a(), placement.world_from_b()];
    let point = |side: usize| {
        let [s, t] = shares[side];
        let world = corners[side].map(|corner| DoubleDouble::world_point(poses[side], &corner));
        let [u, v] = [1, 2].map(|corner| difference(&world[corner], &world[0]));
        // The epsilon leaves room for the rounding of the sum.
        let is_inside = s >= 0.0 && t >= 0.0 && s + t <= 1.0 - f64::EPSILON;
        let [s, t] = [s, t].map(DoubleDouble::of);
        is_inside.then(|| [0, 1, 2].map(|k| world[0][k].plus(&u[k].times(&s)).plus(&v[k].times(&t))))
    };
    let between = difference(&point(1)?, &point(0)?);
    Some(dot(&between, &between))
}

/// Returns the maximum dot product of a world direction with points of a mesh under its pose.
/// `points` are in the mesh frame. The true maximum is at most the returned value plus its error
/// bound.
fn reach(
    direction: &[DoubleDouble; 3],
    world_from_mesh: &Pose,
    points: impl Iterator<Item = [f64; 3]> + Clone,
) -> DoubleDouble {
    // direction · (R p + t) = (Rᵀ direction) · p + direction · t.
    let linear = world_from_mesh.linear();
    let gradient: [DoubleDouble; 3] =
        std::array::from_fn(|k| dot(direction, &[0, 1, 2].map(|row| DoubleDouble::of(linear[row][k]))));
    let base = dot(direction, &world_from_mesh.translation().map(DoubleDouble::of));
    // Plain floats first: points that are surely not the farthest need no more digits.
    let rough_gradient = rounded(&gradient);
    let (mut farthest, mut size, mut extents) = (f64::NEG_INFINITY, 0.0_f64, [0.0_f64; 3]);
    for point in points.clone() {
        farthest = farthest.max(vec3::dot(&rough_gradient, &point));
        size = size.max(rough_gradient.iter().zip(&point).map(|(g, x)| (g * x).abs()).sum());
        extents = [0, 1, 2].map(|k| extents[k].max(point[k].abs()));
    }
    let surely_less = farthest - 16.0 * f64::EPSILON * size;
    // A point that differs from the last one only along axes on which the gradient is zero up to
    // rounding has the same product, and is skipped. `left_out` bounds the difference.
    let off_zero = gradient.each_ref().map(DoubleDouble::off_zero);
    let left_out: f64 = (0..3).filter_map(|k| Some(off_zero[k]? * extents[k])).sum();
    let mut last = [f64::NAN; 3];
    let mut most = DoubleDouble::of(f64::NEG_INFINITY);
    for point in points {
        // A comparison with NaN proves nothing.
        let is_surely_less = vec3::dot(&rough_gradient, &point) < surely_less;
        let is_like_last = (0..3).all(|k| point[k] == last[k] || (off_zero[k].is_some() && point[k].is_finite()));
        if !is_surely_less && !is_like_last {
            most = most.greater(&dot(&gradient, &point.map(DoubleDouble::of)));
            last = point;
        }
    }
    most.plus(&base).widened(left_out)
}

/// Returns the direction near `direction` that is perpendicular to the first edge and to the next
/// one that is not parallel to it.
fn perpendicular(direction: Vector, mut edges: impl Iterator<Item = [DoubleDouble; 3]>) -> [DoubleDouble; 3] {
    let exact = direction.map(DoubleDouble::of);
    let is_edge = |edge: &[DoubleDouble; 3]| rounded(edge) != [0.0; 3];
    let Some(first) = edges.find(is_edge) else { return exact };
    let is_across = |second: &[DoubleDouble; 3]| {
        let (u, v) = (rounded(&first), rounded(second));
        let normal = vec3::cross(&u, &v);
        vec3::dot(&normal, &normal) > PARALLEL_SINE_SQUARED * vec3::dot(&u, &u) * vec3::dot(&v, &v)
    };
    if let Some(second) = edges.find(is_across) {
        let normal = cross(&first, &second);
        let faces_away = vec3::dot(&rounded(&normal), &direction) < 0.0;
        return if faces_away { normal.each_ref().map(DoubleDouble::negated) } else { normal };
    }
    let along = dot(&exact, &first).over(&dot(&first, &first));
    difference(&exact, &first.each_ref().map(|x| x.times(&along)))
}

fn rounded(vector: &[DoubleDouble; 3]) -> Vector {
    vector.each_ref().map(|x| x.rounded()[0])
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;
    use impinge_testkit::generate::poses::rotation;

    use super::*;
    use crate::exact::triangles_within;
    use crate::math::vec3::{length, sub};
    use crate::primitive::triangle_triangle;

    /// Returns the vector between the nearest points, in floats.
    fn between(placement: &Placement, a: &Corners, b: &Corners) -> Vector {
        let world = |pose: &Pose, corners: &Corners| corners.map(|corner| pose.apply(corner));
        let nearest = triangle_triangle(&world(placement.world_from_a(), a), &world(placement.world_from_b(), b));
        sub(&nearest.on_b, &nearest.on_a)
    }

    fn is_proved(placement: &Placement, a: &Corners, b: &Corners, clearance: f64) -> bool {
        Supports::of_triangles(placement, a, b, between(placement, a, b)).are_farther_than(
            placement,
            a.iter().copied(),
            b.iter().copied(),
            clearance,
        )
    }

    /// Triangles of a lattice, flat ones included, so that corners, edges and faces are nearest to
    /// each other in turn. Every proof is true, at the distance and one float to either side.
    /// Nearly all pairs that are farther apart are proved.
    #[test]
    fn supports_prove_what_is_true_and_nearly_all_of_it() {
        let mut rng = Rng::new(4711);
        let (mut apart, mut proved) = (0, 0);
        for case in 0..4000 {
            let mut triangle = || [[0; 3]; 3].map(|p| p.map(|_: i32| rng.integer(0, 4) as f64));
            let (a, b) = (triangle(), triangle());
            let turn = rotation(&mut rng);
            let linear = if case % 2 == 0 { Pose::IDENTITY.linear().to_owned() } else { turn.linear };
            let shift = [[5.0, 0.0, 0.3], [0.0, 0.0, 4.25], [3.0, 5.0, 7.0]][case % 3];
            let moved = linear.map(|row| (0..3).map(|k| row[k] * shift[k]).sum::<f64>());
            let pose = |translation: [f64; 3]| Pose::new(linear, translation).expect("a pose");
            let placement = Placement::new(&pose([0.0; 3]), &pose(moved));
            let distance = length(&between(&placement, &a, &b));
            for clearance in [distance * (1.0 - 1e-15), distance.next_down(), distance, distance.next_up()] {
                let is_proved = is_proved(&placement, &a, &b, clearance);
                let is_near = triangles_within(&placement, &a, &b, clearance);
                assert!(!(is_proved && is_near), "{a:?} {b:?} {linear:?} {clearance:e}");
                apart += usize::from(!is_near);
                proved += usize::from(is_proved);
            }
        }
        assert!(apart > 5000 && proved * 100 >= apart * 98, "{proved} of {apart}");
    }

    /// Inputs that overflow, vanish or are NaN prove nothing.
    #[test]
    fn supports_prove_nothing_beyond_the_range_of_floats() {
        let placement = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let triangle = |scale: f64, height: f64| [[0.0, 0.0], [scale, 0.0], [0.0, scale]].map(|[x, y]| [x, y, height]);
        for (scale, height) in
            [(1e200, 1e200), (1e-200, 1e-200), (f64::INFINITY, 1.0), (f64::NAN, 1.0), (1.0, f64::NAN)]
        {
            assert!(!is_proved(&placement, &triangle(scale, 0.0), &triangle(scale, height), 0.5 * height));
        }
        assert!(is_proved(&placement, &triangle(1.0, 0.0), &triangle(1.0, 1.0), 0.5));
        let none = [[0.0; 3]; 0];
        let supports = Supports::of_triangles(&placement, &triangle(1.0, 0.0), &triangle(1.0, 1.0), [0.0, 0.0, 1.0]);
        assert!(!supports.are_farther_than(&placement, none.into_iter(), none.into_iter(), 0.5));
    }
}
