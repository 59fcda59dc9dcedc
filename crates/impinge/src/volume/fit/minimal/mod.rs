//! The minimal sphere, exactly: its centre is the real one rounded once (*Notes*, 2.3, end).
//!
//! 1. A sample says where the sphere is about to be, and how far from its centre all but a few points are.
//! 2. One pass over memory keeps the points beyond that distance, the *candidates*; it judges all points too.
//! 3. The sphere of the candidates is found in doubles ([`approximate`]), then *judged* in exact arithmetic
//!    ([`exact`]): at most four of them have a sphere whose centre is in their hull, and no candidate lies outside. Where
//!    doubles erred, exact steps follow.
//! 4. The points passed over are proved to lie inside by the triangle inequality. Where they are not, another pass keeps
//!    what lies beyond the sphere found so far; each such pass finds a point that the final sphere rests on, so five are
//!    enough.
//!
//! The minimal sphere is unique and is found exactly, so its rounded centre, and with it the radius, depend on nothing but
//! the set of points: not on their order, nor on duplicates, threads or the sample.
//!
//! Source: Welzl, *Smallest enclosing disks (balls and ellipsoids)*, 1991; Gärtner, *Fast and robust smallest enclosing
//! balls*, 1999 (stepping to the most distant point); Clarkson, *Las Vegas algorithms for linear and integer
//! programming*, 1995 (adding all that lies outside). The exact judgement, and the points passed over, are ours.

mod approximate;
mod beyond;
mod exact;
mod frame;

use super::super::BoundingSphere;
use super::enclosing::{about, scaled_offset, squared};
use super::spheres::FittedSphere;
use crate::input::InputError;
use crate::volume::points::{Coordinate, widen};
use beyond::{Beyond, first_look};
use exact::ExactBall;
use frame::Frame;

/// The smallest sphere that holds the points.
///
/// The centre is that of the real minimal sphere, each coordinate rounded to nearest; the radius is the least that holds all
/// points about it, rounded up; `lower` is the real minimal radius rounded down. The same set of points gives the same bits
/// in any order.
///
/// ```
/// use impinge::volume::fit::minimal_sphere;
/// let corners: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
/// let fitted = minimal_sphere(&corners)?;
/// assert_eq!(fitted.sphere.centre(), [0.5; 3]);
/// assert!(fitted.lower <= 0.75_f64.sqrt() && fitted.sphere.radius() - fitted.lower < 3e-16);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// As [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Accuracy
/// `radius - lower` is at most the distance that rounding moves the centre, below one unit in its last place, and eight
/// units in the last place of the radius (tests: `tests/it/volumes/minimal.rs`).
///
/// # Complexity
/// One pass over memory for a generic cloud; linear for any set met so far, a million points that all lie on one sphere
/// included.
pub fn minimal_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let (bounds, beyond) = first_look(points)?;
    let frame = Frame::of(&bounds);
    if bounds.min() == bounds.max() {
        return Ok(FittedSphere { sphere: BoundingSphere::from_valid(bounds.min(), 0.0), lower: 0.0 });
    }
    let (ball, rim) = solve(points, frame, beyond);
    let sphere = about(ball.centre(), &rim, frame.scale);
    Ok(FittedSphere { sphere, lower: ball.radius_down() })
}

/// The minimal circle of points in a plane through the origin, about one large: its centre and squared radius, rounded.
pub(super) fn circle(points: &[[f64; 3]]) -> ([f64; 3], f64) {
    let centre = approximate::minimal(points).centre;
    let squared_radius = points.iter().map(|&point| squared(scaled_offset(point, centre, 1.0))).fold(0.0, f64::max);
    (centre, squared_radius)
}

/// The minimal sphere, and points among which are all that are nearly on it.
fn solve<T: Coordinate>(points: &[[T; 3]], frame: Frame, mut beyond: Option<Beyond>) -> (ExactBall, Vec<[f64; 3]>) {
    /// One for each point that the sphere rests on, and one to begin with.
    const ROUNDS: usize = 5;
    for _ in 0..ROUNDS {
        let Some(candidates) = beyond else { break };
        let ball = sphere_of(&candidates.points, frame);
        if candidates.rest_is_inside(&ball, frame) {
            return (ball, candidates.points);
        }
        beyond = Some(candidates.next(points, &ball, frame));
    }
    let all: Vec<[f64; 3]> = points.iter().map(|&point| widen(point)).collect();
    (sphere_of(&all, frame), all)
}

/// The minimal sphere of these points, exactly.
fn sphere_of(points: &[[f64; 3]], frame: Frame) -> ExactBall {
    let local: Vec<[f64; 3]> = points.iter().map(|&point| frame.local(point)).collect();
    let support: Vec<[f64; 3]> = approximate::minimal(&local).support.iter().map(|&i| points[i]).collect();
    exact::minimal(points, &support, frame)
}
