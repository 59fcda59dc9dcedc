//! The points that may be on the sphere: those beyond a distance that nearly all of them keep.

use fearless_simd::Simd;
use rayon::prelude::*;

use super::super::super::rounding::{add_up, length_up};
use super::super::super::{BoundingVolume, MinMax};
use super::super::enclosing::{SQUARE_ERROR, scaled_offset};
use super::approximate;
use super::exact::ExactBall;
use super::frame::Frame;
use crate::input::InputError;
use crate::simd::{best_level, dispatch};
use crate::volume::points::{Coordinate, bounds, judge, widen};

/// Points that are not nearer to a centre than a distance, which is in the scale of a frame.
pub(super) struct Beyond {
    centre: [f64; 3],
    distance: f64,
    pub(super) points: Vec<[f64; 3]>,
}

/// Sets up to this size are candidates as a whole: sampling them would cost more than it saves.
const SMALL: usize = 1 << 13;

/// The box of the points and, by the same pass over memory, what is beyond a sphere that a sample suggests; nothing of the
/// second where there are few points.
///
/// # Errors
/// As [`judge`].
pub(super) fn first_look<T: Coordinate>(points: &[[T; 3]]) -> Result<(MinMax, Option<Beyond>), InputError> {
    if points.len() <= SMALL {
        return Ok((judge(points)?, None));
    }
    let Some(guess) = Guess::of(points) else { return Ok((judge(points)?, None)) };
    let look = |chunk| bounds(chunk).map(|bounds| (bounds, guess.beyond(chunk)));
    let Some(chunks) = points.par_chunks(CHUNK).map(look).collect::<Option<Vec<_>>>() else {
        return Ok((judge(points)?, None));
    };
    let whole = chunks.iter().map(|&(bounds, _)| bounds).reduce(|a, b| a.merged(&b));
    let whole = whole.map_or_else(|| judge(points), Ok)?;
    let kept = chunks.into_iter().flat_map(|(_, kept)| kept).collect();
    // From the scale of the sample to that of the whole, which is no larger: both are powers of two.
    let distance = guess.square.sqrt() * (Frame::of(&whole).scale / guess.scale);
    Ok((whole, Some(Beyond { centre: guess.centre, distance, points: kept })))
}

/// Small enough to stay in the cache for a second look, and large enough to share out cheaply.
const CHUNK: usize = 1 << 13;

impl Beyond {
    /// The next candidates, about the sphere of the last.
    pub(super) fn next<T: Coordinate>(&self, points: &[[T; 3]], ball: &ExactBall, frame: Frame) -> Self {
        let guess = Guess { centre: ball.centre(), square: next_square(&self.points, ball, frame), scale: frame.scale };
        let kept: Vec<Vec<[f64; 3]>> = points.par_chunks(CHUNK).map(|chunk| guess.beyond(chunk)).collect();
        Self { centre: guess.centre, distance: guess.square.sqrt(), points: kept.concat() }
    }

    /// Whether every point nearer to the centre is proved to be strictly inside, by more than what decides the
    /// radius.
    pub(super) fn rest_is_inside(&self, ball: &ExactBall, frame: Frame) -> bool {
        const STRICTLY: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;
        // Differences and the scale are as exact as those of points: a few half units, as are the steps from here on,
        // within the share that is given away.
        let moved = length_up(scaled_offset(ball.centre(), self.centre, frame.scale));
        let far = add_up(add_up(moved, ball.centre_error()), self.distance * (1.0 + 2.0 * SQUARE_ERROR));
        far <= ball.radius_down() * frame.scale * STRICTLY
    }
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

/// Where the sphere may be: a centre, and the square of a distance from it that nearly all points keep, in a scale that is
/// a power of two.
struct Guess {
    centre: [f64; 3],
    square: f64,
    scale: f64,
}

impl Guess {
    /// From a sample: all but about one in 256 points keep the distance. None where the sample is one point, or not to be
    /// used.
    fn of<T: Coordinate>(points: &[[T; 3]]) -> Option<Self> {
        const SAMPLE: usize = 1 << 11;
        const KEPT: usize = SAMPLE / 256;
        let sample: Vec<[f64; 3]> = (0..SAMPLE).map(|i| widen(points[i * (points.len() / SAMPLE)])).collect();
        let bounds = bounds(&sample).filter(|bounds| bounds.min() != bounds.max())?;
        let frame = Frame::of(&bounds);
        let local: Vec<[f64; 3]> = sample.iter().map(|&point| frame.local(point)).collect();
        let centre = approximate::minimal(&local).centre;
        let centre = std::array::from_fn(|axis| frame.origin[axis] + centre[axis] / frame.scale);
        let mut squares: Vec<f64> = sample.iter().map(|&point| frame.squared_distance(point, centre)).collect();
        let (_, &mut square, _) = squares.select_nth_unstable_by(SAMPLE - KEPT, f64::total_cmp);
        Some(Self { centre, square, scale: frame.scale })
    }

    /// The points at least this far from the centre.
    fn beyond<T: Coordinate>(&self, points: &[[T; 3]]) -> Vec<[f64; 3]> {
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || self.beyond_by_lanes(points)))
    }

    #[inline(always)]
    fn beyond_by_lanes<T: Coordinate>(&self, points: &[[T; 3]]) -> Vec<[f64; 3]> {
        const GROUP: usize = 8;
        /// Coordinates of a group, each in a lane of its own.
        const LANES: usize = 3 * GROUP;
        let mut centres = [0.0; LANES];
        for (lane, centre) in centres.iter_mut().enumerate() {
            *centre = self.centre[lane % 3];
        }
        let mut kept = Vec::new();
        let (groups, rest) = points.as_chunks::<GROUP>();
        for group in groups {
            let mut squares = [0.0; LANES];
            for (lane, &x) in group.as_flattened().iter().enumerate() {
                let offset = (x.into() - centres[lane]) * self.scale;
                squares[lane] = offset * offset;
            }
            // Compared as a whole, as nearly every group has none.
            let mut any = false;
            for [x, y, z] in squares.as_chunks::<3>().0 {
                any |= x + y + z >= self.square;
            }
            if any {
                kept.extend(group.iter().map(|&point| widen(point)).filter(|&point| self.is_beyond(point)));
            }
        }
        kept.extend(rest.iter().map(|&point| widen(point)).filter(|&point| self.is_beyond(point)));
        kept
    }

    #[inline(always)]
    fn is_beyond(&self, point: [f64; 3]) -> bool {
        let [x, y, z] = scaled_offset(point, self.centre, self.scale).map(|offset| offset * offset);
        x + y + z >= self.square
    }
}
