//! The minimal sphere, exactly: its center is the real one rounded once (*Notes*, 2.3, end).
//!
//! 1. A sample suggests a sphere and a distance from its center within which all but a few points
//!    are.
//! 2. One pass over memory keeps the points beyond that distance, the *candidates*; it also
//!    validates all points.
//! 3. The sphere of the candidates is found in doubles ([`approximate`]) and then *verified* in
//!    exact arithmetic ([`exact`]): at most four candidates have a sphere whose center is in their
//!    hull, and no candidate lies outside. If the doubles were wrong, exact steps follow.
//! 4. The other points are proved to lie inside by the triangle inequality. If that fails, another
//!    pass keeps the points beyond the sphere found so far. Each such pass finds a point that the
//!    final sphere rests on, so five passes are enough.
//!
//! The minimal sphere is unique and is found exactly. So its rounded center, and with it the
//! radius, depend only on the set of points: not on their order, nor on duplicates, threads or the
//! sample.
//!
//! Source: Welzl, *Smallest enclosing disks (balls and ellipsoids)*, 1991; Gärtner, *Fast and
//! robust smallest enclosing balls*, 1999 (stepping to the most distant point); Clarkson, *Las
//! Vegas algorithms for linear and integer programming*, 1995 (adding all points outside). The
//! exact verification, and the points left out of the candidates, are ours.
//!
//! Tests: `tests/it/volumes/minimal.rs`. Benchmark: `volumes`.

mod approximate;
mod candidates;
mod exact;
mod frame;

use super::super::BoundingSphere;
use super::enclosing::{about, scaled_offset, squared};
use super::spheres::FittedSphere;
use crate::input::InputError;
use crate::volume::points::{Coordinate, widen};
use candidates::{Candidates, first_candidates};
use exact::ExactSphere;
use frame::Frame;

/// Returns the smallest sphere that encloses the points.
///
/// The center is that of the real minimal sphere, each coordinate rounded to nearest. The radius is
/// the smallest that encloses all points around it, rounded up. `lower` is the real minimal radius,
/// rounded down. The same set of points gives the same bits in any order.
///
/// ```
/// use impinge::volume::fit::minimal_sphere;
/// let corners: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
/// let fitted = minimal_sphere(&corners)?;
/// assert_eq!(fitted.sphere.center(), [0.5; 3]);
/// assert!(fitted.lower <= 0.75_f64.sqrt() && fitted.sphere.radius() - fitted.lower < 3e-16);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// Same as [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Accuracy
/// `radius - lower` is at most the distance by which rounding moves the center (less than one unit
/// in its last place) plus eight units in the last place of the radius (tests:
/// `tests/it/volumes/minimal.rs`).
///
/// # Complexity
/// One pass over memory for a generic point cloud. Linear for every set tested, including a million
/// points that all lie on one sphere.
pub fn minimal_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let (bounds, candidates) = first_candidates(points)?;
    let frame = Frame::of(&bounds);
    if bounds.min() == bounds.max() {
        return Ok(FittedSphere { sphere: BoundingSphere::from_valid(bounds.min(), 0.0), lower: 0.0 });
    }
    let (minimal, rim) = solve(points, frame, candidates);
    let sphere = about(minimal.center(), &rim, frame.scale);
    Ok(FittedSphere { sphere, lower: minimal.radius_down() })
}

/// Returns the minimal circle of points in a plane through the origin: its center and squared
/// radius, rounded. The coordinates are about 1 in magnitude.
pub(super) fn circle(points: &[[f64; 3]]) -> ([f64; 3], f64) {
    let center = approximate::minimal(points).center;
    let squared_radius = points.iter().map(|&point| squared(scaled_offset(point, center, 1.0))).fold(0.0, f64::max);
    (center, squared_radius)
}

/// Returns the minimal sphere, and a set of points that includes all those that are nearly on it.
fn solve<T: Coordinate>(points: &[[T; 3]], frame: Frame, mut next: Option<Candidates>) -> (ExactSphere, Vec<[f64; 3]>) {
    /// Maximum number of candidate passes: one for each of the four points that the sphere rests
    /// on, and one for the start.
    const ROUNDS: usize = 5;
    for _ in 0..ROUNDS {
        let Some(candidates) = next else { break };
        let sphere = sphere_of(&candidates.points, frame);
        if candidates.rest_is_inside(&sphere, frame) {
            return (sphere, candidates.points);
        }
        next = Some(candidates.next(points, &sphere, frame));
    }
    let all: Vec<[f64; 3]> = points.iter().map(|&point| widen(point)).collect();
    (sphere_of(&all, frame), all)
}

/// Returns the minimal sphere of the points, exactly.
fn sphere_of(points: &[[f64; 3]], frame: Frame) -> ExactSphere {
    let local: Vec<[f64; 3]> = points.iter().map(|&point| frame.local(point)).collect();
    let support: Vec<[f64; 3]> = approximate::minimal(&local).support.iter().map(|&i| points[i]).collect();
    exact::minimal(points, &support, frame)
}
