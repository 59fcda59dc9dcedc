//! Volumes that are a point, segment or parallelogram swept by a sphere, and the distance between
//! any two of them.
//!
//! The closest points of the cores are computed with plain formulas. The bounds are then proved
//! from the result alone, so rounding in those formulas cannot make them wrong. Let n be the vector
//! between the closest points. Lower bound: no point of B's core is nearer to one of A's than (min
//! n·b - max n·a) / |n|, whatever n is. Upper bound: the points lie on the cores up to a known
//! rounding error.
//!
//! Tests: `tests/it/volumes/round.rs`. Benchmark: `volumes`.

use super::core::{Core, closest_points};
use super::rounding::{HALF_ULP, add_down, add_up, distance_up, div_down, length_up};
use crate::math::vec3::{dot, sub};

/// The distance of two sets as a proved interval, in the unit of their coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceBounds {
    /// Lower bound of the distance, never negative.
    pub lower: f64,
    /// Upper bound of the distance. Zero proves a common point.
    pub upper: f64,
}

/// The proved relation of two closed sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proximity {
    /// The sets are proved to have no common point.
    Apart,
    /// The sets are proved to have a common point.
    Intersects,
    /// It is undecided: the sets touch or nearly touch to within rounding, or it depends on the
    /// inside of an open mesh. Treat this as a hit.
    Undecided,
}

pub(super) mod sealed {
    use super::Core;

    /// A core and a radius.
    #[allow(unreachable_pub, private_interfaces, reason = "sealed: its members are for this module alone")]
    pub trait Swept {
        fn core(&self) -> Core;
        fn reach(&self) -> f64;
    }
}

/// A volume that is a core swept by a sphere: [`BoundingSphere`](super::BoundingSphere),
/// [`Capsule`](super::Capsule) or [`Lozenge`](super::Lozenge). Two volumes that are compared must
/// be in one frame and unit.
///
/// ```
/// use impinge::volume::{BoundingSphere, Capsule, Proximity, Round};
/// let pill = Capsule::new([0.0; 3], [4.0, 0.0, 0.0], 1.0)?;
/// let sphere = BoundingSphere::new([2.0, 5.0, 0.0], 1.0)?;
/// let bounds = pill.distance(&sphere);
/// assert!(bounds.lower <= 3.0 && 3.0 <= bounds.upper && bounds.upper - bounds.lower < 1e-12);
/// assert_eq!(pill.proximity(&sphere), Proximity::Apart);
/// # Ok::<(), impinge::InputError>(())
/// ```
pub trait Round: sealed::Swept + Sized {
    /// Returns the distance of the two volumes as a proved interval, in their unit. The distance is
    /// zero if they overlap.
    ///
    /// # Accuracy
    /// The width of the interval is at most about 2^-46 of the size of the cores and of their
    /// distance (tests: `tests/it/volumes/round.rs`).
    fn distance<B: Round>(&self, other: &B) -> DistanceBounds {
        let (lower, upper) = core_distance(&self.core(), &other.core());
        DistanceBounds {
            lower: add_down(lower, -add_up(self.reach(), other.reach())).max(0.0),
            upper: add_up(upper, -add_down(self.reach(), other.reach())).max(0.0),
        }
    }

    /// Reports whether the two volumes are proved apart, proved to overlap, or undecided.
    fn proximity<B: Round>(&self, other: &B) -> Proximity {
        let DistanceBounds { lower, upper } = self.distance(other);
        if lower > 0.0 {
            Proximity::Apart
        } else if upper > 0.0 {
            Proximity::Undecided
        } else {
            Proximity::Intersects
        }
    }

    /// Reports whether the two volumes may overlap: `false` is returned only if they are proved
    /// apart. They may be of different kinds.
    fn meets<B: Round>(&self, other: &B) -> bool {
        self.proximity(other) != Proximity::Apart
    }
}

/// Returns lower and upper bounds of the distance of two cores.
fn core_distance(a: &Core, b: &Core) -> (f64, f64) {
    let (p, q) = closest_points(a, b);
    let upper = add_up(distance_up(p, q), add_up(point_error(a), point_error(b)));
    (separation(a, b, p, sub(&q, &p)).max(0.0), upper)
}

/// Returns a double not below the distance from a point to a core.
pub(super) fn distance_to_core(point: [f64; 3], core: &Core) -> f64 {
    add_up(distance_up(point, core.closest_to(point)), point_error(core))
}

/// Returns a bound on the distance between a computed point or corner of a core and the exact one.
///
/// A coordinate is the sum of a corner's coordinate and at most two products. It is rounded four
/// times, and no partial sum exceeds the sum of the three magnitudes. Eight half units cover the
/// second order and the rounding here. The factor 2 is for three axes: the diagonal of a cube is
/// less than twice its edge.
pub(super) fn point_error(core: &Core) -> f64 {
    if core.dimension == 0 {
        return 0.0;
    }
    let magnitude = |v: [f64; 3]| v.into_iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let size = magnitude(core.corner) + magnitude(core.edges[0]) + magnitude(core.edges[1]);
    2.0 * (8.0 * HALF_ULP * size + f64::MIN_POSITIVE)
}

/// Returns a distance along `n` by which the cores are proved apart; zero or negative if none is
/// proved. `origin` is a point near the cores that keeps the numbers small.
fn separation(a: &Core, b: &Core, origin: [f64; 3], n: [f64; 3]) -> f64 {
    let (mut furthest, mut nearest, mut size) = (f64::NEG_INFINITY, f64::INFINITY, 0.0_f64);
    let mut project = |corner: [f64; 3]| {
        let offset = sub(&corner, &origin);
        size = offset.into_iter().fold(size, |largest, x| largest.max(x.abs()));
        dot(&n, &offset)
    };
    for &corner in &a.corners()[..a.count()] {
        furthest = furthest.max(project(corner));
    }
    for &corner in &b.corners()[..b.count()] {
        nearest = nearest.min(project(corner));
    }
    // A product has the rounding of the difference, its own and two sums. That makes 5 half units
    // of |n|·|offset| with the second order, for each of two projections, and one for their
    // difference. 16 half units cover this and the rounding of `slope` and `size`. Underflow loses
    // less than 2^-1020 in total.
    let slope = n[0].abs() + n[1].abs() + n[2].abs();
    let error = 16.0 * HALF_ULP * slope * size + 16.0 * f64::MIN_POSITIVE;
    let gap = (nearest - furthest) - error;
    // NaN fails this comparison, so it proves nothing.
    if gap > 0.0 {
        let length = length_up(n);
        add_down(div_down(gap, length), -add_up(point_error(a), point_error(b)))
    } else {
        0.0
    }
}
