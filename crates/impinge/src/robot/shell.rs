//! Convex hulls of the pieces of links, and a search for a direction that separates two of them.
//!
//! The iteration of Gilbert, Johnson and Keerthi proposes directions and proves nothing. Along each
//! direction the gap between two hulls is bounded from below (lemma L43 of the proofs). Directions
//! are divided into [cells](cell_of). Each cell has a list of the vertices that are the highest
//! along some direction of the cell, which are compared eight at a time in single precision.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, u32x8};

use super::frame::Frame;
use super::outline::Ball;
use crate::convex::nearest_of_hull;
use crate::hull::Hull;
use crate::math::vec3::{dot, sub};
use crate::simd::{LANES, Level, dispatch};

/// Maximum number of directions that are tried for two hulls. With more of them a few more pairs
/// are proved to be apart, but pairs that overlap take longer.
const MAX_STEPS: usize = 8;

/// Share of the distance of two hulls at which their lower bound is near enough. With a larger
/// share intervals are a little longer, but more directions are tried.
const MIN_SHARE: f64 = 0.9;

/// Share of the size of a hull that covers the rounding of heights in single precision, 2^-20.
const SINGLE: f64 = 16.0 * (f32::EPSILON as f64) * 0.5;

/// Bound on what heights in single precision lose by underflow, 2^-120.
const UNDERFLOW: f64 = 64.0 * (f32::MIN_POSITIVE as f64);

/// Number of cells of directions: one for each axis along which a direction is the longest, and for
/// each of the signs of its entries.
const CELLS: usize = 24;

/// Maximum number of vertices for which all cells share one list.
const MAX_SHARED: usize = 2 * LANES;

/// Maximum size of a hull, 2^100.
const MAX_SIZE: f64 = (1_u128 << 100) as f64;

/// Factor that covers the rounding of squares, 1 + 2^-46.
pub(super) const ROUNDING: f64 = 1.0 + 64.0 * f64::EPSILON;

/// A convex hull of points, grown by a radius, in the frame of a link.
#[derive(Clone, Debug)]
pub(super) struct Shell {
    center: [f64; 3],
    /// Offsets of vertices from the center by axis, the lists of all cells in turn. Unused lanes
    /// repeat a vertex.
    blocks: Vec<[[f32; LANES]; 3]>,
    /// First and last block of the list of each cell.
    lists: [[u32; 2]; CELLS],
    /// Radius, and the rounding of heights along a direction of length 1.
    radius: f64,
}

impl Shell {
    /// Returns the hull of spheres, if its size is in range. `grown` returns the radius of the hull
    /// for that of the spheres.
    pub(super) fn about(spheres: &[Ball], grown: impl Fn(f64) -> f64) -> Option<Self> {
        let points: Vec<[f64; 3]> = spheres.iter().map(|(center, _)| *center).collect();
        let hull = Hull::new(&points).ok()?;
        let vertices = hull.positions();
        let end = |pick: fn(f64, f64) -> f64, k: usize| vertices.iter().map(|vertex| vertex[k]).reduce(pick);
        let mut center = [0.0; 3];
        for (k, middle) in center.iter_mut().enumerate() {
            *middle = 0.5 * end(f64::min, k)? + 0.5 * end(f64::max, k)?;
        }
        let offsets: Vec<[f64; 3]> = vertices.iter().map(|vertex| sub(vertex, &center)).collect();
        let size = offsets.iter().map(|offset| dot(offset, offset)).fold(0.0, f64::max).sqrt();
        if size.is_nan() || size >= MAX_SIZE {
            return None;
        }
        let offsets: Vec<[f32; 3]> = offsets.iter().map(|offset| offset.map(|x| x as f32)).collect();
        let (mut blocks, mut lists) = (Vec::new(), [[0; 2]; CELLS]);
        for (cell, list) in lists.iter_mut().enumerate() {
            if cell > 0 && offsets.len() <= MAX_SHARED {
                *list = [0, blocks.len() as u32];
                continue;
            }
            let first = blocks.len() as u32;
            let highest = if offsets.len() <= MAX_SHARED { offsets.clone() } else { highest_in(cell, &offsets) };
            blocks.extend(highest.chunks(LANES).map(|chunk| {
                let coordinate = |k: usize, lane: usize| chunk.get(lane).unwrap_or(&chunk[0])[k];
                [0, 1, 2].map(|k| std::array::from_fn(|lane| coordinate(k, lane)))
            }));
            *list = [first, blocks.len() as u32];
        }
        let radius = spheres.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
        let radius = grown(radius) + SINGLE * size + UNDERFLOW;
        Some(Self { center, blocks, lists, radius })
    }

    /// Returns the greatest height of the offsets along a direction in the frame of the link, and
    /// the offset that has it.
    #[inline(always)]
    fn support<S: Simd>(&self, simd: S, direction: [f64; 3]) -> (f64, [f64; 3]) {
        let direction = direction.map(|entry| entry as f32);
        let [first, last] = self.lists[cell_of(direction)];
        let blocks = &self.blocks[first as usize..last as usize];
        let [x, y, z] = [0, 1, 2].map(|k| f32x8::splat(simd, direction[k]));
        let mut highest = f32x8::splat(simd, f32::NEG_INFINITY);
        let (mut places, mut place) = (u32x8::splat(simd, 0), u32x8::splat(simd, 0));
        for [p, q, r] in blocks {
            let [p, q, r] = [p, q, r].map(|lanes| f32x8::from_slice(simd, lanes));
            let height = x * p + y * q + z * r;
            let is_higher = height.simd_gt(highest);
            highest = is_higher.select(height, highest);
            places = is_higher.select(place, places);
            place += 1;
        }
        let (heights, places) = (<[f32; LANES]>::from(highest), <[u32; LANES]>::from(places));
        let mut lane = 0;
        for other in 1..LANES {
            if heights[other] > heights[lane] {
                lane = other;
            }
        }
        let block = &blocks[places[lane] as usize];
        (f64::from(heights[lane]), [0, 1, 2].map(|k| f64::from(block[k][lane])))
    }
}

/// Returns the cell of a direction: which entry is the greatest in magnitude, and the signs of all.
#[inline(always)]
fn cell_of(direction: [f32; 3]) -> usize {
    let [x, y, z] = direction.map(f32::abs);
    let axis = if x >= y && x >= z { 0 } else { 1 + usize::from(y < z) };
    let sign = |k: usize| usize::from(direction[k] < 0.0) << k;
    8 * axis + sign(0) + sign(1) + sign(2)
}

/// Returns the points that may be the highest along a direction of a cell. A point is left out if
/// another is higher along all four edges of the cell, and so along all directions between them.
fn highest_in(cell: usize, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let (axis, signs) = (cell / 8, cell % 8);
    let sign = |k: usize| if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
    let edge = |others: usize| -> [f64; 3] {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut edge = [0.0; 3];
        edge[axis] = sign(axis);
        edge[i] = sign(i) * (others & 1) as f64;
        edge[j] = sign(j) * (others >> 1) as f64;
        edge
    };
    let edges = [0, 1, 2, 3].map(edge);
    let heights = |point: &[f32; 3]| edges.map(|edge| dot(&edge, &point.map(f64::from)));
    let all: Vec<[f64; 4]> = points.iter().map(heights).collect();
    // Points that are high along the edges, or along all of them together.
    let sum = |heights: &[f64; 4]| heights.iter().sum::<f64>();
    let along_edge = |k: usize| all.iter().max_by(|p, q| p[k].total_cmp(&q[k]).then(sum(p).total_cmp(&sum(q))));
    let middle = all.iter().max_by(|p, q| sum(p).total_cmp(&sum(q)));
    let high: Vec<[f64; 4]> = [0, 1, 2, 3].into_iter().filter_map(along_edge).chain(middle).copied().collect();
    let is_below = |own: &[f64; 4]| high.iter().any(|other| (0..4).all(|k| other[k] > own[k]));
    points.iter().zip(&all).filter(|(_, own)| !is_below(own)).map(|(point, _)| *point).collect()
}

/// Reports whether two hulls at their frames are proved to be farther apart than a margin. The
/// search starts with the direction `between`, from the first to the second.
pub(super) fn are_apart(
    level: Level,
    (a, frame_a): (&Shell, &Frame),
    (b, frame_b): (&Shell, &Frame),
    between: [f64; 3],
    margin: f64,
) -> bool {
    let reach = a.radius + b.radius + margin;
    let mut is_apart = false;
    // NaN proves nothing.
    let is_done = |gap: f64, squared_length: f64, _| {
        is_apart = gap > 0.0 && gap * gap > reach * reach * squared_length * ROUNDING;
        is_apart
    };
    dispatch!(level, simd => search(simd, (a, frame_a), (b, frame_b), between, is_done));
    is_apart
}

/// Returns a lower bound of the distance of two hulls at their frames, zero if they may overlap.
/// Its rounding is in the slack of the culling. The search starts with the direction `between`,
/// from the first to the second. It ends if the bound reaches `enough`, or is near the distance.
pub(super) fn least_distance(
    level: Level,
    (a, frame_a): (&Shell, &Frame),
    (b, frame_b): (&Shell, &Frame),
    between: [f64; 3],
    enough: f64,
) -> f64 {
    let radii = a.radius + b.radius;
    let mut least = 0.0_f64;
    let is_done = |gap: f64, squared_length: f64, farthest: f64| {
        let distance = if gap > 0.0 { gap / (squared_length.sqrt() * ROUNDING) } else { 0.0 };
        least = least.max(distance - radii);
        least >= enough || least > MIN_SHARE * (farthest - radii)
    };
    dispatch!(level, simd => search(simd, (a, frame_a), (b, frame_b), between, is_done));
    least
}

/// Searches for directions that separate two hulls. Calls `is_done` with the gap between the hulls
/// along each direction, the squared length of the direction, and a distance of two points of the
/// hulls, rounded; the search ends if it returns `true`.
#[inline(always)]
fn search<S: Simd>(
    simd: S,
    (a, frame_a): (&Shell, &Frame),
    (b, frame_b): (&Shell, &Frame),
    between: [f64; 3],
    mut is_done: impl FnMut(f64, f64, f64) -> bool,
) {
    let apart = sub(&frame_b.apply(b.center), &frame_a.apply(a.center));
    let (mut simplex, mut count) = ([[0.0; 3]; 4], 0);
    let (mut direction, mut farthest) = (between, f64::INFINITY);
    for _ in 0..MAX_STEPS {
        let largest = direction.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if largest == 0.0 {
            return;
        }
        direction = direction.map(|x| x / largest);
        let (height_a, point_a) = a.support(simd, frame_a.along(direction));
        let (height_b, point_b) = b.support(simd, frame_b.along(direction.map(|x| -x)));
        let gap = dot(&direction, &apart) - height_a - height_b;
        if is_done(gap, dot(&direction, &direction), farthest) {
            return;
        }
        let (point_a, point_b) = (frame_a.turn(point_a), frame_b.turn(point_b));
        let difference = std::array::from_fn(|k| point_a[k] - point_b[k] - apart[k]);
        if simplex[..count].contains(&difference) {
            return;
        }
        simplex[count] = difference;
        let nearest = nearest_of_hull(&simplex[..=count]);
        let kept = simplex;
        count = 0;
        for (point, weight) in kept.iter().zip(nearest.weights) {
            if weight > 0.0 {
                simplex[count] = *point;
                count += 1;
            }
        }
        direction = nearest.towards_origin;
        farthest = dot(&direction, &direction).sqrt();
        if count == 4 {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::math::Pose;
    use crate::query::{self, Proximity};
    use crate::shape::Shape;
    use crate::simd::levels;

    /// Returns points on a grid, or others.
    fn points(rng: &mut Rng) -> Vec<[f64; 3]> {
        let count = rng.integer(1, 60);
        let is_on_grid = !rng.one_in(3);
        let coordinate = |rng: &mut Rng| if is_on_grid { 0.25 * rng.integer(-4, 4) as f64 } else { rng.unit() };
        (0..count).map(|_| [0; 3].map(|_| coordinate(rng))).collect()
    }

    /// Returns a pose on a grid that is a quarter turn or another turn.
    fn pose(rng: &mut Rng) -> Pose {
        let at = [0; 3].map(|_| 0.5 * rng.integer(-5, 5) as f64);
        let axis = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 2.0, -0.5]][rng.integer(0, 2) as usize];
        let angle = 0.125 * std::f64::consts::PI * rng.integer(-8, 8) as f64;
        Pose::from_axis_angle(axis, angle, at).expect("a pose")
    }

    #[test]
    fn hulls_that_are_proved_apart_are_apart() {
        let mut rng = Rng::new(5);
        let (mut found, mut near, mut apart, mut ties, mut all) = (0, 0, 0, 0, 0);
        for round in 0..4000 {
            let [points_a, points_b] = [points(&mut rng), points(&mut rng)];
            let [pose_a, pose_b] = [pose(&mut rng), pose(&mut rng)];
            let margin = [0.0, 0.25, 0.5][round % 3];
            let shells = [&points_a, &points_b].map(|points| {
                let spheres: Vec<Ball> = points.iter().map(|point| (*point, 0.0)).collect();
                Shell::about(&spheres, |radius| radius + 1e-13).expect("a hull")
            });
            let frames = [Frame::of(&pose_a), Frame::of(&pose_b)];
            let start = [0; 3].map(|_| rng.integer(-2, 2) as f64);
            let pair = || ((&shells[0], &frames[0]), (&shells[1], &frames[1]));
            let enough = [f64::INFINITY, margin][round / 3 % 2];
            let (mut is_apart, mut bound) = (false, 0.0_f64);
            for (_, level) in levels() {
                is_apart |= are_apart(level, pair().0, pair().1, start, margin);
                bound = bound.max(least_distance(level, pair().0, pair().1, start, enough));
            }
            let place = |points: &[[f64; 3]], pose| {
                Shape::hull(Arc::new(Hull::new(points).expect("a hull"))).at(pose).expect("a place")
            };
            let (a, b) = (place(&points_a, pose_a), place(&points_b, pose_b));
            let truth = query::nearness(&a, &b, margin);
            assert!(!is_apart || truth == Proximity::Apart, "{points_a:?} {pose_a:?} {points_b:?} {pose_b:?} {margin}");
            let distance = query::distance(&a, &b).upper;
            assert!(bound <= distance, "{points_a:?} {pose_a:?} {points_b:?} {pose_b:?} {bound} {distance}");
            ties += usize::from((distance - margin).abs() < 1e-9);
            let is_well_apart = distance > margin + 1e-4 && start != [0.0; 3];
            near += usize::from(is_well_apart && bound > (0.85 * distance).min(enough - 1e-9));
            (found, apart) = (found + usize::from(is_apart && is_well_apart), apart + usize::from(is_well_apart));
            all += 1;
        }
        assert!(found * 50 > apart * 49, "{found} of {apart}");
        assert!(near * 50 > apart * 49, "{near} of {apart}");
        assert!(apart * 4 > all && apart * 10 < 9 * all, "{apart} of {all}");
        assert!(ties > 100, "{ties}");
    }
}
