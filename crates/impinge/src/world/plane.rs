//! The plane of a half-space in the world, for telling in a few nanoseconds that a box is clear of it.

use crate::math::Pose;
use crate::volume::MinMax;

/// The points x with `normal·(x - origin) ≤ level`, rounded, and by how much that may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    normal: [f64; 3],
    /// The magnitudes that sum up to each entry of the normal.
    magnitude: [f64; 3],
    origin: [f64; 3],
    level: f64,
    level_magnitude: f64,
}

/// More than the units of 2^-53 by which a height may be off: 2 for a cofactor and 3 for the sum of three products with it,
/// 1 for the product with the box and 1 for its difference to the origin, 3 for their sum and the level; taken fourfold.
const ROUNDING: f64 = 40.0 * 0.5 * f64::EPSILON;

/// More than what is lost where products vanish: at most 2^-1074 each, times two entries below 2^64 of a pose, one of a
/// normal below 2^128 and a coordinate below 2^321.
const VANISHED: f64 = f64::from_bits((1023 - 400) << 52);

impl Plane {
    /// The image of {v : normal·v ≤ level}: {x : m·(x - t) ≤ |det R| level}, where m is the cofactor matrix of R times the
    /// normal and the sign of det R.
    pub(super) fn new(normal: [f64; 3], level: f64, pose: &Pose) -> Self {
        let rows = pose.linear();
        let (mut image, mut magnitude) = ([0.0; 3], [0.0; 3]);
        let (mut determinant, mut determinant_magnitude) = (0.0, 0.0);
        let sign = if pose.mirrors() { -1.0 } else { 1.0 };
        for i in 0..3 {
            let (next, last) = (&rows[(i + 1) % 3], &rows[(i + 2) % 3]);
            for j in 0..3 {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                let cofactor = next[k] * last[l] - next[l] * last[k];
                let size = (next[k] * last[l]).abs() + (next[l] * last[k]).abs();
                image[i] += sign * cofactor * normal[j];
                magnitude[i] += size * normal[j].abs();
                if i == 0 {
                    determinant += sign * cofactor * rows[0][j];
                    determinant_magnitude += size * rows[0][j].abs();
                }
            }
        }
        Self {
            normal: image,
            magnitude,
            origin: *pose.translation(),
            level: determinant * level,
            level_magnitude: determinant_magnitude * level.abs(),
        }
    }

    /// Whether a box is not proved clear of the half-space.
    pub(super) fn reaches(&self, bounds: &MinMax) -> bool {
        let (min, max) = (bounds.min(), bounds.max());
        let (mut least, mut size) = (0.0, self.level_magnitude);
        for k in 0..3 {
            let (low, high) = (min[k] - self.origin[k], max[k] - self.origin[k]);
            least += (self.normal[k] * low).min(self.normal[k] * high);
            // The difference rounds by a unit of itself, not of what it is the difference of.
            size += self.magnitude[k] * low.abs().max(high.abs());
        }
        // What is no number is not proved.
        let is_clear = least - self.level > ROUNDING * size + VANISHED;
        !is_clear
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::shapes;
    use crate::shape::Shape;
    use impinge_testkit::generate::{Rng, poses};

    /// A box that is not reached is apart from the half-space by exact arithmetic; one far off is not reached.
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
            let plane = Plane::new(normal, level, &pose);
            // A point of the plane, and boxes that touch it in a corner or nearly so.
            let squared: f64 = normal.iter().map(|x| x * x).sum();
            let on = pose.apply(normal.map(|x| x * level / squared));
            let corner = on.map(|x| if rng.one_in(2) { x } else { x + rng.uniform(-1.0, 1.0) * 1e-9 * x.abs() });
            let size = rng.choose(&[0.0, 1e-9, 1.0, 100.0]);
            let bounds = MinMax::of(&[corner, corner.map(|x| x + size * rng.choose(&[-1.0, 1.0]))]).unwrap();
            let (min, max) = (bounds.min(), bounds.max());
            let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (min[k] + max[k]));
            let outer = [0, 1, 2].map(|k| (max[k] - centre[k]).max(centre[k] - min[k]));
            let shape = Shape::cuboid(outer).unwrap().at(Pose::from_translation(centre).unwrap()).unwrap();
            let half_space = Shape::half_space(normal, level).unwrap().at(pose).unwrap();
            let meets = shapes::intersects(&shape, &half_space);
            if plane.reaches(&bounds) {
                doubtful += u32::from(!meets);
            } else {
                clear += 1;
                // The cuboid may be a rounding larger than the box.
                assert!(!meets || size > 0.0 && shapes::penetration(&shape, &half_space).is_some_and(|p| p.lower < 1e-12 * size), "{normal:?} {level} {pose:?} {bounds:?}");
            }
        }
        assert!(clear > 500 && doubtful < 200, "{clear} {doubtful}");
    }
}
