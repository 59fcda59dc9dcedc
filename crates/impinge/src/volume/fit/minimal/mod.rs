//! The minimal sphere, exactly: its centre is the real one rounded once (*Notes*, 2.3, end).
//!
//! 1. A sample says where the sphere is about to be, and how far from its centre all but a few points are.
//! 2. One pass over memory keeps the points beyond that distance, the *candidates*.
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
mod exact;

use rayon::prelude::*;

use super::super::rounding::{add_up, length_up};
use super::super::{BoundingSphere, MinMax};
use super::enclosing::{SQUARE_ERROR, about, scaled_offset, squared, unit_scale};
use super::points::{Coordinate, judge, widen};
use super::spheres::FittedSphere;
use crate::input::InputError;
use exact::ExactBall;

/// Where points are about one large: about an origin, in a scale that is a power of two.
#[derive(Clone, Copy)]
struct Frame {
    origin: [f64; 3],
    scale: f64,
}

/// Points that are not nearer to a centre than the root of a square, which is in the scale of the frame.
struct Beyond {
    centre: [f64; 3],
    square: f64,
    points: Vec<[f64; 3]>,
}

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
/// units in the last place of the radius (tests: `tests/volumes/minimal.rs`).
///
/// # Complexity
/// Two passes over memory for a generic cloud, one of them to judge it; linear for any set met so far, a million points
/// that all lie on one sphere included.
pub fn minimal_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let bounds = judge(points)?;
    let frame = Frame::of(&bounds);
    if bounds.min() == bounds.max() {
        return Ok(FittedSphere { sphere: BoundingSphere::from_valid(bounds.min(), 0.0), lower: 0.0 });
    }
    let (ball, rim) = solve(points, frame);
    let sphere = about(ball.centre(), &rim, frame.scale);
    Ok(FittedSphere { sphere, lower: ball.radius_down() })
}

/// The minimal circle of points in a plane through the origin, about one large: its centre and squared radius, rounded.
pub(super) fn circle(points: &[[f64; 3]]) -> ([f64; 3], f64) {
    let centre = approximate::minimal(points).centre;
    let squared_radius = points.iter().map(|&point| squared(scaled_offset(point, centre, 1.0))).fold(0.0, f64::max);
    (centre, squared_radius)
}

/// Sets up to this size are candidates as a whole: sampling them would cost more than it saves.
const SMALL: usize = 1 << 13;

/// The minimal sphere, and points among which are all that are nearly on it.
fn solve<T: Coordinate>(points: &[[T; 3]], frame: Frame) -> (ExactBall, Vec<[f64; 3]>) {
    /// One for each point that the sphere rests on, and one to begin with.
    const ROUNDS: usize = 5;
    if points.len() > SMALL {
        let (mut centre, mut square) = first_guess(points, frame);
        for _ in 0..ROUNDS {
            let beyond = gather(points, frame, centre, square);
            let ball = sphere_of(&beyond.points, frame);
            if passed_over_are_inside(&beyond, &ball, frame) {
                return (ball, beyond.points);
            }
            centre = ball.centre();
            square = next_square(&beyond.points, &ball, frame);
        }
    }
    let all: Vec<[f64; 3]> = points.iter().map(|&point| widen(point)).collect();
    (sphere_of(&all, frame), all)
}

/// A centre, and the square of a distance from it that all but about one in 256 points keep, from a sample.
fn first_guess<T: Coordinate>(points: &[[T; 3]], frame: Frame) -> ([f64; 3], f64) {
    const SAMPLE: usize = 1 << 12;
    const KEPT: usize = SAMPLE / 256;
    let sample: Vec<[f64; 3]> = (0..SAMPLE).map(|i| widen(points[i * (points.len() / SAMPLE)])).collect();
    let local: Vec<[f64; 3]> = sample.iter().map(|&point| frame.local(point)).collect();
    let centre = approximate::minimal(&local).centre;
    let centre = std::array::from_fn(|axis| frame.origin[axis] + centre[axis] / frame.scale);
    let mut squares: Vec<f64> = sample.iter().map(|&point| frame.squared_distance(point, centre)).collect();
    let (_, &mut square, _) = squares.select_nth_unstable_by(SAMPLE - KEPT, f64::total_cmp);
    (centre, square)
}

/// The points at least this far, squared, from the centre.
fn gather<T: Coordinate>(points: &[[T; 3]], frame: Frame, centre: [f64; 3], least: f64) -> Beyond {
    const GROUP: usize = 8;
    /// Large enough to share out cheaply, and small enough for a share each.
    const CHUNK: usize = 1 << 15;
    let of_chunk = |chunk: &[[T; 3]]| {
        let mut kept = Vec::new();
        let (groups, rest) = chunk.as_chunks::<GROUP>();
        for group in groups {
            let squares = group.map(|point| frame.squared_distance(widen(point), centre));
            // Compared as a whole, as nearly every group has none.
            if squares.iter().fold(false, |any, &square| any | (square >= least)) {
                kept.extend((0..GROUP).filter(|&i| squares[i] >= least).map(|i| widen(group[i])));
            }
        }
        kept.extend(rest.iter().map(|&p| widen(p)).filter(|&p| frame.squared_distance(p, centre) >= least));
        kept
    };
    let kept: Vec<Vec<[f64; 3]>> = points.par_chunks(CHUNK).map(of_chunk).collect();
    Beyond { centre, square: least, points: kept.concat() }
}

/// The minimal sphere of these points, exactly.
fn sphere_of(points: &[[f64; 3]], frame: Frame) -> ExactBall {
    let local: Vec<[f64; 3]> = points.iter().map(|&point| frame.local(point)).collect();
    let support: Vec<[f64; 3]> = approximate::minimal(&local).support.iter().map(|&i| points[i]).collect();
    exact::minimal(points, &support, frame)
}

/// Whether every point nearer to the centre is proved to be strictly inside, by more than what decides the
/// radius.
fn passed_over_are_inside(beyond: &Beyond, ball: &ExactBall, frame: Frame) -> bool {
    const STRICTLY: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;
    // Differences and the scale are as exact as those of points: a few half units, as are the steps from here on, within
    // the share that is given away.
    let moved = length_up(scaled_offset(ball.centre(), beyond.centre, frame.scale));
    let far = add_up(add_up(moved, ball.centre_error()), beyond.square.sqrt() * (1.0 + 2.0 * SQUARE_ERROR));
    far <= ball.radius_down() * frame.scale * STRICTLY
}

/// From the new centre: near enough for half of the candidates to be passed over next time, and below the sphere by a
/// margin that the next one may use up.
fn next_square(candidates: &[[f64; 3]], ball: &ExactBall, frame: Frame) -> f64 {
    const MARGIN: f64 = 1.0 - 1.0 / (1 << 20) as f64;
    let centre = ball.centre();
    let mut squares: Vec<f64> = candidates.iter().map(|&point| frame.squared_distance(point, centre)).collect();
    let middle = squares.len() / 2;
    let (_, &mut median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    let inside = ball.radius_down() * frame.scale * MARGIN;
    median.min(inside * inside)
}

impl Frame {
    fn of(bounds: &MinMax) -> Self {
        let (min, max) = (bounds.min(), bounds.max());
        Self { origin: std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]), scale: unit_scale(bounds) }
    }

    #[inline(always)]
    fn local(&self, point: [f64; 3]) -> [f64; 3] {
        scaled_offset(point, self.origin, self.scale)
    }

    #[inline(always)]
    fn squared_distance(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        squared(scaled_offset(p, q, self.scale))
    }
}
