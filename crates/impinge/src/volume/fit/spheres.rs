//! Five fast, not minimal constructions of a bounding sphere (*Notes*, 2.3; Ericson 4.3).
//!
//! All end in the same way: for the center that was found, the radius is the distance of the most
//! distant point, rounded up. So each sphere encloses every point by construction, with the best
//! radius for its center.
//!
//! Tests: `tests/it/volumes/spheres.rs`. Benchmark: `volumes`.

use super::super::rounding::{HALF_ULP, add_down};
use super::super::{BoundingSphere, MinMax};
use super::enclosing::{about, scaled_offset, squared, unit_scale};
use super::moments;
use crate::input::InputError;
use crate::volume::points::{Coordinate, validated_bounds, widen};

/// A sphere that encloses the points, and a lower bound of the minimal radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedSphere {
    /// The sphere. It encloses every point.
    pub sphere: BoundingSphere,
    /// Lower bound of the radius of any sphere that encloses the points.
    pub lower: f64,
}

/// Points, their box, and the scale in which its size is about 1.
struct Set<'a, T> {
    points: &'a [[T; 3]],
    bounds: MinMax,
    scale: f64,
}

impl<'a, T: Coordinate> Set<'a, T> {
    fn new(points: &'a [[T; 3]]) -> Result<Self, InputError> {
        let bounds = validated_bounds(points)?;
        Ok(Self { points, bounds, scale: unit_scale(&bounds) })
    }

    fn middle(&self) -> [f64; 3] {
        let (min, max) = (self.bounds.min(), self.bounds.max());
        std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis])
    }

    /// Returns the sphere around a center. The lower bound of the radius comes from the box and, if
    /// given, from two of the points.
    fn fitted(&self, center: [f64; 3], pair: Option<[[f64; 3]; 2]>) -> FittedSphere {
        let (min, max) = (self.bounds.min(), self.bounds.max());
        let by_box = (0..3).map(|axis| 0.5 * add_down(max[axis], -min[axis])).fold(0.0, f64::max);
        let by_pair = pair.map_or(0.0, |[p, q]| {
            // Half of a rounded distance, less the roundings of its square, root and division.
            0.5 * squared(scaled_offset(p, q, self.scale)).sqrt() / self.scale * (1.0 - 8.0 * HALF_ULP)
        });
        let sphere = about(center, self.points, self.scale);
        FittedSphere { sphere, lower: by_box.max(by_pair).min(sphere.radius()) }
    }

    /// Returns the two points that are extreme along a direction.
    fn extremes(&self, direction: [f64; 3]) -> [[f64; 3]; 2] {
        let origin = self.middle();
        let (mut low, mut high) = ((f64::INFINITY, origin), (f64::NEG_INFINITY, origin));
        for &point in self.points {
            let point = widen(point);
            let [x, y, z] = scaled_offset(point, origin, self.scale);
            let t = direction[0] * x + direction[1] * y + direction[2] * z;
            if t < low.0 {
                low = (t, point);
            }
            if t > high.0 {
                high = (t, point);
            }
        }
        [low.1, high.1]
    }

    /// Starts with the sphere that has the two points as poles, and grows it to each point that it
    /// does not enclose yet.
    fn grown(&self, [p, q]: [[f64; 3]; 2]) -> GrowingSphere {
        let center = std::array::from_fn(|axis| 0.5 * p[axis] + 0.5 * q[axis]);
        let mut growing =
            GrowingSphere { center, radius: squared(scaled_offset(p, center, self.scale)).sqrt(), scale: self.scale };
        self.points.iter().for_each(|&point| growing.include(widen(point)));
        growing
    }
}

/// A sphere that grows. Its radius is in scaled units.
#[derive(Clone, Copy)]
struct GrowingSphere {
    center: [f64; 3],
    radius: f64,
    scale: f64,
}

impl GrowingSphere {
    /// Includes one more point. The new diameter reaches from the point to the far pole, so the old
    /// sphere stays inside.
    #[inline(always)]
    fn include(&mut self, point: [f64; 3]) {
        let offset = scaled_offset(point, self.center, self.scale);
        let square = squared(offset);
        if square > self.radius * self.radius {
            let distance = square.sqrt();
            let radius = 0.5 * (self.radius + distance);
            let share = (distance - radius) / distance / self.scale;
            self.center = std::array::from_fn(|axis| self.center[axis] + offset[axis] * share);
            self.radius = radius;
        }
    }
}

/// Returns a sphere that encloses all points, around their mean. The mean lies in their hull, so
/// the radius is less than twice the minimal one.
///
/// # Errors
/// Same as [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Four passes over memory.
///
/// # Source
/// *Notes*, 2.3, the first attempt.
pub fn mean_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let set = Set::new(points)?;
    Ok(set.fitted(moments::mean(points, set.middle(), set.scale), None))
}

/// Returns a sphere that encloses all points, around the center of their axis-aligned box. Half the
/// diagonal of the box is at most √3 times the minimal radius, so the radius of the sphere is, too.
///
/// # Errors
/// Same as [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Three passes over memory.
///
/// # Source
/// *Notes*, 2.3; Ericson 4.3.
pub fn box_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let set = Set::new(points)?;
    Ok(set.fitted(set.middle(), None))
}

/// Returns Ritter's sphere, which encloses all points. It starts with the two most distant of the
/// points that are extreme along the axes, and grows to all others.
///
/// # Errors
/// Same as [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Seven passes over memory.
///
/// # Source
/// Ritter, *An efficient bounding sphere*, Graphics Gems 1990; *Notes*, 2.3. The six extremal
/// points are compared in all fifteen pairs, not only in the three pairs of an axis. The radius is
/// recomputed for the final center; it is at most the grown one.
pub fn ritter_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let set = Set::new(points)?;
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let extremal: Vec<[f64; 3]> = axes.into_iter().flat_map(|axis| set.extremes(axis)).collect();
    let mut pair = [extremal[0], extremal[1]];
    let mut furthest = 0.0;
    for (i, &p) in extremal.iter().enumerate() {
        for &q in &extremal[..i] {
            let distance = squared(scaled_offset(p, q, set.scale));
            if distance > furthest {
                (furthest, pair) = (distance, [q, p]);
            }
        }
    }
    Ok(set.fitted(set.grown(pair).center, Some(pair)))
}

/// Returns a sphere that encloses all points. It starts with the two points that are extreme along
/// the first principal axis, and grows to all others.
///
/// # Errors
/// Same as [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Seven passes over memory.
///
/// # Source
/// *Notes*, 2.3; Wu 1992 by Ericson 4.3.3. The *Notes* take the distance of the two extremes as the
/// radius of the first sphere; it is the diameter. The covariance takes two passes (`moments`).
pub fn principal_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let set = Set::new(points)?;
    let pair = set.extremes(moments::principal_axes(points, set.middle(), set.scale)[0]);
    Ok(set.fitted(set.grown(pair).center, Some(pair)))
}

/// Returns a sphere that encloses all points: the smallest of Ritter's sphere and of those that
/// come from shrinking it and growing it again in other orders.
///
/// # Errors
/// Same as [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Sixteen rounds of growing; about 40 passes over memory.
///
/// # Source
/// Ericson 4.3.4, *Bounding sphere using iterative refinement*: shrink by 5 %, grow in random
/// order, eight times. Here the order is fixed (blocks of points, visited at a stride), so the
/// result is reproducible. There are sixteen rounds, and the shrinking decreases from 5 % towards
/// zero.
pub fn refined_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    const ROUNDS: u32 = 16;
    let first = ritter_sphere(points)?;
    let set = Set::new(points)?;
    let mut best = first;
    let mut growing =
        GrowingSphere { center: first.sphere.center(), radius: first.sphere.radius() * set.scale, scale: set.scale };
    for round in 0..ROUNDS {
        growing.radius *= 0.95 + 0.05 * f64::from(round) / f64::from(ROUNDS);
        visit_in_blocks(points, round, |point| growing.include(point));
        let sphere = about(growing.center, points, set.scale);
        if sphere.radius() < best.sphere.radius() {
            best.sphere = sphere;
        }
    }
    best.lower = best.lower.min(best.sphere.radius());
    Ok(best)
}

/// Visits all points once, in an order that depends on the round. Blocks of neighbors, which suit
/// the cache, are visited at a stride that is coprime to their number.
fn visit_in_blocks<T: Coordinate>(points: &[[T; 3]], round: u32, mut visit: impl FnMut([f64; 3])) {
    const BLOCK: usize = 16;
    let count = points.len().div_ceil(BLOCK);
    let greatest_common_divisor = |mut a: usize, mut b: usize| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    // The golden ratio of the number of blocks separates neighbors; the round shifts it.
    let mut stride = (count as f64 * 0.618) as usize + 1 + round as usize;
    while greatest_common_divisor(stride, count) != 1 {
        stride += 1;
    }
    let mut block = round as usize % count;
    for _ in 0..count {
        let start = block * BLOCK;
        points[start..points.len().min(start + BLOCK)].iter().for_each(|&point| visit(widen(point)));
        block = (block + stride) % count;
    }
}
