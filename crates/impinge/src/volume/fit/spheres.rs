//! Five constructions of a bounding sphere that are quick and not minimal (*Notes*, 2.3; Ericson 4.3).
//!
//! All end alike: whatever centre was found, the radius is the distance of the most distant point, rounded up. So each
//! holds every point by construction, and none is worse than its centre.

use super::super::rounding::{HALF_ULP, add_down};
use super::super::{BoundingSphere, MinMax};
use super::enclosing::{about, scaled_offset, squared, unit_scale};
use super::moments;
use crate::input::InputError;
use crate::volume::points::{Coordinate, judge, widen};

/// A sphere that holds the points, and how small one could be at best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedSphere {
    /// It holds every point.
    pub sphere: BoundingSphere,
    /// No sphere that holds the points has a radius below this.
    pub lower: f64,
}

/// Points, their box, and the scale in which it is about one.
struct Set<'a, T> {
    points: &'a [[T; 3]],
    bounds: MinMax,
    scale: f64,
}

impl<'a, T: Coordinate> Set<'a, T> {
    fn new(points: &'a [[T; 3]]) -> Result<Self, InputError> {
        let bounds = judge(points)?;
        Ok(Self { points, bounds, scale: unit_scale(&bounds) })
    }

    fn middle(&self) -> [f64; 3] {
        let (min, max) = (self.bounds.min(), self.bounds.max());
        std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis])
    }

    /// The sphere about a centre, with what two known points and the box say of the least radius.
    fn fitted(&self, centre: [f64; 3], pair: Option<[[f64; 3]; 2]>) -> FittedSphere {
        let (min, max) = (self.bounds.min(), self.bounds.max());
        let by_box = (0..3).map(|axis| 0.5 * add_down(max[axis], -min[axis])).fold(0.0, f64::max);
        let by_pair = pair.map_or(0.0, |[p, q]| {
            // Half of a rounded distance, less the roundings of its square, root and division.
            0.5 * squared(scaled_offset(p, q, self.scale)).sqrt() / self.scale * (1.0 - 8.0 * HALF_ULP)
        });
        let sphere = about(centre, self.points, self.scale);
        FittedSphere { sphere, lower: by_box.max(by_pair).min(sphere.radius()) }
    }

    /// The two points that are extreme along a direction.
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

    /// The sphere that grows, from one with these two as poles, to each point that it does not hold yet.
    fn grown(&self, [p, q]: [[f64; 3]; 2]) -> Growing {
        let centre = std::array::from_fn(|axis| 0.5 * p[axis] + 0.5 * q[axis]);
        let mut growing =
            Growing { centre, radius: squared(scaled_offset(p, centre, self.scale)).sqrt(), scale: self.scale };
        self.points.iter().for_each(|&point| growing.take(widen(point)));
        growing
    }
}

/// A sphere that grows; its radius is in the scale.
#[derive(Clone, Copy)]
struct Growing {
    centre: [f64; 3],
    radius: f64,
    scale: f64,
}

impl Growing {
    /// Takes in one more point: the new diameter is from there to the far pole, so that the old sphere stays inside.
    #[inline(always)]
    fn take(&mut self, point: [f64; 3]) {
        let offset = scaled_offset(point, self.centre, self.scale);
        let square = squared(offset);
        if square > self.radius * self.radius {
            let distance = square.sqrt();
            let radius = 0.5 * (self.radius + distance);
            let share = (distance - radius) / distance / self.scale;
            self.centre = std::array::from_fn(|axis| self.centre[axis] + offset[axis] * share);
            self.radius = radius;
        }
    }
}

/// About the mean of the points. The mean lies in their hull, so the radius is less than twice the minimal one.
///
/// # Errors
/// As [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Four passes over memory, as many as all of these but the ones that say more.
///
/// # Source
/// *Notes*, 2.3, the first attempt.
pub fn mean_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let set = Set::new(points)?;
    Ok(set.fitted(moments::mean(points, set.middle(), set.scale), None))
}

/// About the centre of the box. The box has half a diagonal of at most √3 times the minimal radius, and so has the sphere.
///
/// # Errors
/// As [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
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

/// Ritter's: from the farthest pair of the points that are extreme along the axes, grown to all others.
///
/// # Errors
/// As [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Seven passes over memory.
///
/// # Source
/// Ritter, *An efficient bounding sphere*, Graphics Gems 1990; *Notes*, 2.3. The six extremal points are compared in all
/// fifteen pairs, not in the three of an axis, and the radius is what the points need about the final centre, which is at
/// most what growing left.
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
    Ok(set.fitted(set.grown(pair).centre, Some(pair)))
}

/// From the two points that are extreme along the first principal axis, grown to all others.
///
/// # Errors
/// As [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Seven passes over memory.
///
/// # Source
/// *Notes*, 2.3; Wu 1992 by Ericson 4.3.3. The distance of the two extremes is the diameter of the first sphere, not its
/// radius, as the *Notes* have it; and the covariance takes two passes (`moments`).
pub fn principal_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    let set = Set::new(points)?;
    let pair = set.extremes(moments::principal_axes(points, set.middle(), set.scale)[0]);
    Ok(set.fitted(set.grown(pair).centre, Some(pair)))
}

/// Ritter's, shrunk and grown again in other orders, the smallest kept.
///
/// # Errors
/// As [`BoundingVolume::of_points`](super::super::BoundingVolume::of_points).
///
/// # Complexity
/// Sixteen rounds of growing, some forty passes over memory.
///
/// # Source
/// Ericson 4.3.4, *Bounding sphere using iterative refinement*: shrink by 5 %, grow in random order, eight times. Here the
/// order is fixed, so that the result is (blocks of points by a stride), there are sixteen rounds, and the shrinking eases
/// from 5 % towards none.
pub fn refined_sphere<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedSphere, InputError> {
    const ROUNDS: u32 = 16;
    let first = ritter_sphere(points)?;
    let set = Set::new(points)?;
    let mut best = first;
    let mut growing =
        Growing { centre: first.sphere.centre(), radius: first.sphere.radius() * set.scale, scale: set.scale };
    for round in 0..ROUNDS {
        growing.radius *= 0.95 + 0.05 * f64::from(round) / f64::from(ROUNDS);
        in_order(points, round, |point| growing.take(point));
        let sphere = about(growing.centre, points, set.scale);
        if sphere.radius() < best.sphere.radius() {
            best.sphere = sphere;
        }
    }
    best.lower = best.lower.min(best.sphere.radius());
    Ok(best)
}

/// All points once, in an order of the round's own: blocks, for the sake of memory, visited at a stride that is coprime to
/// their number.
fn in_order<T: Coordinate>(points: &[[T; 3]], round: u32, mut visit: impl FnMut([f64; 3])) {
    const BLOCK: usize = 16;
    let count = points.len().div_ceil(BLOCK);
    let greatest_common_divisor = |mut a: usize, mut b: usize| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    // The golden section of the number spreads neighbours; the round moves it.
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
