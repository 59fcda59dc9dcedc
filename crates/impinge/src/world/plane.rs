//! The plane of a half-space in the world, for proving in a few nanoseconds that a box is apart
//! from the half-space.

use crate::convex::HalfSpace;
use crate::math::vec3::length;
use crate::volume::MinMax;

/// A half-space: the points x with `direction·(x - origin) ≤ level`.
///
/// Every entry of the direction, and the level, is the exact value rounded once, in units of the
/// normal's largest entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    direction: [f64; 3],
    origin: [f64; 3],
    level: f64,
}

/// Bound on the relative error of a height. The error is at most 7 units of 2^-53: 1 for the
/// direction, 1 for the difference to the origin, 1 for the product, 3 for the sum with the level,
/// 1 for the level. The bound is more than twice that.
const ROUNDING: f64 = 16.0 * 0.5 * f64::EPSILON;

/// Bound on the error by underflow, if an entry of the direction or a product vanishes: 2^-1074
/// times a coordinate below 2^321, generously rounded up.
const UNDERFLOW: f64 = f64::from_bits((1023 - 700) << 52);

impl Plane {
    pub(super) fn of(half_space: &HalfSpace<'_>) -> Self {
        let (direction, origin, level) = half_space.rounded();
        Self { direction, origin, level }
    }

    /// Returns a half-space that holds all points within a distance of this one.
    pub(super) fn raised(&self, by: f64) -> Self {
        // The direction is at most √3 long, and its length is wrong by a few roundings.
        let raise = by * length(&self.direction) * (1.0 + ROUNDING);
        Self { level: (self.level + raise).next_up(), ..*self }
    }

    /// Returns `false` if the box is proved to be apart from the half-space, and `true` otherwise.
    pub(super) fn reaches(&self, bounds: &MinMax) -> bool {
        let (min, max) = (bounds.min(), bounds.max());
        let (mut least, mut size) = (-self.level, self.level.abs());
        for k in 0..3 {
            let (low, high) = (min[k] - self.origin[k], max[k] - self.origin[k]);
            least += (self.direction[k] * low).min(self.direction[k] * high);
            size += self.direction[k].abs() * low.abs().max(high.abs());
        }
        // Negated, so that a NaN proves nothing.
        let is_clear = least > ROUNDING * size + UNDERFLOW;
        !is_clear
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::query;
    use crate::shape::Shape;
    use impinge_testkit::generate::{Rng, poses};

    /// A box that is proved apart is apart by exact arithmetic, and a box far away is proved apart.
    #[test]
    fn boxes_that_are_clear_are_apart() {
        let mut rng = Rng::new(71);
        let (mut clear, mut doubtful) = (0, 0);
        for round in 0..4000 {
            let map = if round % 2 == 0 { poses::large_integer_map(&mut rng) } else { poses::rotation(&mut rng) };
            let pose = Pose::new(map.linear, map.translation).unwrap();
            let normal = [0; 3].map(|_| rng.integer(-3, 3) as f64);
            if normal == [0.0; 3] {
                continue;
            }
            let level = rng.integer(-5, 5) as f64;
            let plane = Plane::of(&HalfSpace::new(normal, level, &pose));
            // A point of the plane, and boxes that touch it in a corner or nearly so.
            let squared: f64 = normal.iter().map(|x| x * x).sum();
            let on = pose.apply(normal.map(|x| x * level / squared));
            let corner = on.map(|x| if rng.one_in(2) { x } else { x + rng.uniform(-1.0, 1.0) * 1e-9 * x.abs() });
            let size = rng.choose(&[0.0, 1e-9, 1.0, 100.0]);
            let bounds = MinMax::of(&[corner, corner.map(|x| x + size * rng.choose(&[-1.0, 1.0]))]).unwrap();
            let (min, max) = (bounds.min(), bounds.max());
            let center: [f64; 3] = std::array::from_fn(|k| 0.5 * (min[k] + max[k]));
            let outer = [0, 1, 2].map(|k| (max[k] - center[k]).max(center[k] - min[k]));
            let shape = Shape::cuboid(outer).unwrap().at(Pose::from_translation(center).unwrap()).unwrap();
            let half_space = Shape::half_space(normal, level).unwrap().at(pose).unwrap();
            let intersects = query::intersects(&shape, &half_space);
            if plane.reaches(&bounds) {
                doubtful += u32::from(!intersects);
            } else {
                clear += 1;
                // The cuboid may be a rounding larger than the box.
                assert!(
                    !intersects
                        || size > 0.0
                            && query::penetration(&shape, &half_space).is_some_and(|p| p.lower < 1e-12 * size),
                    "{normal:?} {level} {pose:?} {bounds:?}"
                );
            }
        }
        assert!(clear > 500 && doubtful < 200, "{clear} {doubtful}");
    }
}
