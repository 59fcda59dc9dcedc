//! Volumes that are a point, segment or parallelogram swept by a sphere, and the distance between any two of them.
//!
//! The closest points of the cores are computed in the plain way; then the result is *judged*, so that no rounding before
//! can matter. With n the vector between them, no point of B's core is nearer to one of A's than
//! (min n·b - max n·a) / |n|, whatever n is: the lower bound. The points are of the cores up to a known rounding: the upper
//! bound.

use super::core::{Core, closest_points};
use super::rounding::{HALF_ULP, add_down, add_up, distance_up, div_down, length_up};
use crate::math::vec3::{dot, sub};

/// How far two sets are apart: a proved interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceBounds {
    /// The distance is not below this; not negative.
    pub lower: f64,
    /// The distance is not above this; zero where a common point is proved.
    pub upper: f64,
}

/// What is proved of two closed sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proximity {
    /// They have no common point.
    Apart,
    /// They have one.
    Meets,
    /// Rounding leaves it open: they touch, or nearly do. To be taken as a hit.
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

/// A volume that is a core swept by a sphere: [`BoundingSphere`](super::BoundingSphere), [`Capsule`](super::Capsule) or
/// [`Lozenge`](super::Lozenge).
///
/// ```
/// use impinge::volume::{BoundingSphere, Capsule, Proximity, Round};
/// let pill = Capsule::new([0.0; 3], [4.0, 0.0, 0.0], 1.0)?;
/// let ball = BoundingSphere::new([2.0, 5.0, 0.0], 1.0)?;
/// let bounds = pill.distance(&ball);
/// assert!(bounds.lower <= 3.0 && 3.0 <= bounds.upper && bounds.upper - bounds.lower < 1e-12);
/// assert_eq!(pill.proximity(&ball), Proximity::Apart);
/// # Ok::<(), impinge::InputError>(())
/// ```
pub trait Round: sealed::Swept + Sized {
    /// The distance of the two solids, zero where they meet.
    ///
    /// # Accuracy
    /// The interval is at most about 2^-46 of the size of the cores and of their distance wide (tests:
    /// `tests/it/volumes/round.rs`).
    fn distance<B: Round>(&self, other: &B) -> DistanceBounds {
        let (lower, upper) = core_distance(&self.core(), &other.core());
        DistanceBounds {
            lower: add_down(lower, -add_up(self.reach(), other.reach())).max(0.0),
            upper: add_up(upper, -add_down(self.reach(), other.reach())).max(0.0),
        }
    }

    /// Whether the two are proved apart, proved to meet, or neither.
    fn proximity<B: Round>(&self, other: &B) -> Proximity {
        let DistanceBounds { lower, upper } = self.distance(other);
        if lower > 0.0 {
            Proximity::Apart
        } else if upper > 0.0 {
            Proximity::Undecided
        } else {
            Proximity::Meets
        }
    }

    /// Whether the two are not proved apart, whatever their kinds.
    fn meets<B: Round>(&self, other: &B) -> bool {
        self.proximity(other) != Proximity::Apart
    }
}

/// Bounds on the distance of two cores.
fn core_distance(a: &Core, b: &Core) -> (f64, f64) {
    let (p, q) = closest_points(a, b);
    let upper = add_up(distance_up(p, q), add_up(off(a), off(b)));
    (separation(a, b, p, sub(&q, &p)).max(0.0), upper)
}

/// A double not below the distance of a point to a core.
pub(super) fn distance_to_core(point: [f64; 3], core: &Core) -> f64 {
    add_up(distance_up(point, core.closest_to(point)), off(core))
}

/// How far a corner or a point of a core, as computed, may be from the one that is meant: a coordinate is the sum of a
/// corner's and at most two products, rounded four times, and no partial sum exceeds the three magnitudes. Eight half
/// units cover the second order and this sum; the diagonal of a cube is less than twice its edge.
pub(super) fn off(core: &Core) -> f64 {
    if core.dimension == 0 {
        return 0.0;
    }
    let magnitude = |v: [f64; 3]| v.into_iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let size = magnitude(core.corner) + magnitude(core.edges[0]) + magnitude(core.edges[1]);
    2.0 * (8.0 * HALF_ULP * size + f64::MIN_POSITIVE)
}

/// A distance along `n` by which the cores are certainly apart; negative or zero where there is none.
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
    // A product has the roundings of the difference, its own and two sums: 5 half units of |n|·|offset| with the second
    // order, for each of two projections, and one for their difference; 16 in all cover this sum too. What underflows
    // is below 2^-1020 in sum.
    let slope = n[0].abs() + n[1].abs() + n[2].abs();
    let error = 16.0 * HALF_ULP * slope * size + 16.0 * f64::MIN_POSITIVE;
    let gap = (nearest - furthest) - error;
    // Compared so that NaN proves nothing.
    if gap > 0.0 {
        let length = length_up(n);
        add_down(div_down(gap, length), -add_up(off(a), off(b)))
    } else {
        0.0
    }
}
