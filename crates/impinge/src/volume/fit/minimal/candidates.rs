//! The candidates: points that may be on the minimal sphere, because they lie beyond a distance
//! within which nearly all points are.

use fearless_simd::Simd;
use rayon::prelude::*;

use super::super::super::rounding::{add_up, length_up};
use super::super::super::{BoundingVolume, MinMax};
use super::super::enclosing::{SQUARE_ERROR, scaled_offset};
use super::approximate;
use super::exact::ExactSphere;
use super::frame::Frame;
use crate::input::InputError;
use crate::simd::{best_level, dispatch};
use crate::volume::points::{Coordinate, bounds, validated_bounds, widen};

/// The points at or beyond a distance from a center. The distance is in the scale of a frame.
pub(super) struct Candidates {
    center: [f64; 3],
    distance: f64,
    pub(super) points: Vec<[f64; 3]>,
}

/// Maximum number of points that are all candidates. Sampling smaller sets costs more than it
/// saves.
const MAX_UNSAMPLED: usize = 1 << 13;

/// Returns the box of the points and, from the same pass over memory, the candidates beyond a
/// sphere that a sample suggests. The candidates are `None` if there are few points or the sample
/// is unusable.
///
/// # Errors
/// Same as [`validated_bounds`].
pub(super) fn first_candidates<T: Coordinate>(points: &[[T; 3]]) -> Result<(MinMax, Option<Candidates>), InputError> {
    if points.len() <= MAX_UNSAMPLED {
        return Ok((validated_bounds(points)?, None));
    }
    let Some(guess) = Guess::of(points) else { return Ok((validated_bounds(points)?, None)) };
    let look = |chunk| bounds(chunk).map(|bounds| (bounds, guess.beyond(chunk)));
    let Some(chunks) = points.par_chunks(CHUNK).map(look).collect::<Option<Vec<_>>>() else {
        return Ok((validated_bounds(points)?, None));
    };
    let whole = chunks.iter().map(|&(bounds, _)| bounds).reduce(|a, b| a.merged(&b));
    let whole = whole.map_or_else(|| validated_bounds(points), Ok)?;
    let kept = chunks.into_iter().flat_map(|(_, kept)| kept).collect();
    // Converts from the scale of the sample to that of all points, which is not larger. Both are
    // powers of two.
    let distance = guess.square.sqrt() * (Frame::of(&whole).scale / guess.scale);
    Ok((whole, Some(Candidates { center: guess.center, distance, points: kept })))
}

/// Number of points per parallel task: small enough to stay in the cache for a second pass, large
/// enough to be distributed at low cost.
const CHUNK: usize = 1 << 13;

impl Candidates {
    /// Returns the next candidates, around the sphere of the last ones.
    pub(super) fn next<T: Coordinate>(&self, points: &[[T; 3]], sphere: &ExactSphere, frame: Frame) -> Self {
        let guess =
            Guess { center: sphere.center(), square: next_square(&self.points, sphere, frame), scale: frame.scale };
        let kept: Vec<Vec<[f64; 3]>> = points.par_chunks(CHUNK).map(|chunk| guess.beyond(chunk)).collect();
        Self { center: guess.center, distance: guess.square.sqrt(), points: kept.concat() }
    }

    /// Reports whether every point nearer to the center is proved to be strictly inside the sphere,
    /// by more than the difference that could decide the radius.
    pub(super) fn rest_is_inside(&self, sphere: &ExactSphere, frame: Frame) -> bool {
        const STRICTLY: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;
        // Differences and the scale have the same error as those of points, a few half units. The
        // following steps add a few more. `STRICTLY` covers all of them.
        let moved = length_up(scaled_offset(sphere.center(), self.center, frame.scale));
        let far = add_up(add_up(moved, sphere.center_error()), self.distance * (1.0 + 2.0 * SQUARE_ERROR));
        far <= sphere.radius_down() * frame.scale * STRICTLY
    }
}

/// Returns the squared distance from the new center beyond which points are candidates next time.
/// It excludes half of the current candidates, and it is below the sphere by a margin that the next
/// sphere may use up.
fn next_square(candidates: &[[f64; 3]], sphere: &ExactSphere, frame: Frame) -> f64 {
    const MARGIN: f64 = 1.0 - 1.0 / (1 << 20) as f64;
    let center = sphere.center();
    let mut squares: Vec<f64> = candidates.iter().map(|&point| frame.squared_distance(point, center)).collect();
    let middle = squares.len() / 2;
    let (_, &mut median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    let inside = sphere.radius_down() * frame.scale * MARGIN;
    median.min(inside * inside)
}

/// A guess of the sphere: a center, and the square of a distance from it within which nearly all
/// points are. The scale is a power of two.
struct Guess {
    center: [f64; 3],
    square: f64,
    scale: f64,
}

impl Guess {
    /// Guesses from a sample, so that about one point in 256 lies beyond the distance. Returns
    /// `None` if the sample is a single point or invalid.
    fn of<T: Coordinate>(points: &[[T; 3]]) -> Option<Self> {
        const SAMPLE: usize = 1 << 11;
        const KEPT: usize = SAMPLE / 256;
        let sample: Vec<[f64; 3]> = (0..SAMPLE).map(|i| widen(points[i * (points.len() / SAMPLE)])).collect();
        let bounds = bounds(&sample).filter(|bounds| bounds.min() != bounds.max())?;
        let frame = Frame::of(&bounds);
        let local: Vec<[f64; 3]> = sample.iter().map(|&point| frame.local(point)).collect();
        let center = approximate::minimal(&local).center;
        let center = std::array::from_fn(|axis| frame.origin[axis] + center[axis] / frame.scale);
        let mut squares: Vec<f64> = sample.iter().map(|&point| frame.squared_distance(point, center)).collect();
        let (_, &mut square, _) = squares.select_nth_unstable_by(SAMPLE - KEPT, f64::total_cmp);
        Some(Self { center, square, scale: frame.scale })
    }

    /// Returns the points at or beyond the distance from the center.
    fn beyond<T: Coordinate>(&self, points: &[[T; 3]]) -> Vec<[f64; 3]> {
        dispatch!(best_level(), simd => simd.vectorize(#[inline(always)] || self.beyond_by_lanes(points)))
    }

    #[inline(always)]
    fn beyond_by_lanes<T: Coordinate>(&self, points: &[[T; 3]]) -> Vec<[f64; 3]> {
        const GROUP: usize = 8;
        /// Number of coordinates of a group, each in its own lane.
        const LANES: usize = 3 * GROUP;
        let mut centers = [0.0; LANES];
        for (lane, center) in centers.iter_mut().enumerate() {
            *center = self.center[lane % 3];
        }
        let mut kept = Vec::new();
        let (groups, rest) = points.as_chunks::<GROUP>();
        for group in groups {
            let mut squares = [0.0; LANES];
            for (lane, &x) in group.as_flattened().iter().enumerate() {
                let offset = (x.into() - centers[lane]) * self.scale;
                squares[lane] = offset * offset;
            }
            // One comparison for the whole group, because nearly every group has no candidate.
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
        let [x, y, z] = scaled_offset(point, self.center, self.scale).map(|offset| offset * offset);
        x + y + z >= self.square
    }
}
