//! The distance of a point from a triangle, a cylinder or a cone: the closed forms of spheres and
//! those shapes.
//!
//! As for `nearest`, the nearest point is only proposed. The support of the other core along the
//! vector to it proves the interval.

use super::differences::{Gap, is_in_range};
use crate::convex::posed::{Core, Swept, to_unit_entries};
use crate::convex::turned::Turned;
use crate::math::relative::{Offset, UNIT_ROUNDOFF};
use crate::math::vec3::{Vector, add, dot, length, sub};
use crate::primitive::point_triangle;

/// Proved bounds on the distance of two cores, with the proposed nearest points.
pub(super) struct Found {
    pub(super) gap: Gap,
    /// Vector from the point of A to the point of B.
    pub(super) vector: Vector,
    /// A point of each core, relative to the translation of A.
    pub(super) points: [Vector; 2],
    pub(super) extent: f64,
}

/// Returns bounds on the distance of two points. Returns `None` for any other cores, and if the
/// sizes are extreme.
#[inline]
pub(super) fn found_of_points(a: &Swept<'_>, b: &Swept<'_>) -> Option<Found> {
    let (Core::Points([one]), Core::Points([other])) = (a.core, b.core) else { return None };
    let [(center_a, extent_a), (center_b, extent_b)] = [image(a, one), image(b, other)];
    let offset = Offset::between(a.pose, b.pose).rounded;
    let extent = extent_a + extent_b + (offset[0].abs() + offset[1].abs() + offset[2].abs());
    let to_b = add(&offset, &center_b);
    let vector = sub(&to_b, &center_a);
    let length = length(&vector);
    let off = 32.0 * UNIT_ROUNDOFF * (length + extent);
    let gap = Gap { lower: (length - off).max(0.0), upper: length + off, length };
    is_in_range(extent).then_some(Found { gap, vector, points: [center_a, to_b], extent })
}

/// Returns the image of a point relative to the translation of the pose, and the sum of the
/// magnitudes of its terms.
#[inline]
fn image(swept: &Swept<'_>, point: &Vector) -> (Vector, f64) {
    if *point == [0.0; 3] {
        return ([0.0; 3], 0.0);
    }
    (swept.pose.linear().map(|row| dot(&row, point)), extent(swept))
}

/// Returns bounds on the distance of two cores of which one is a point and the other a triangle, a
/// cylinder or a cone. Returns `None` for any other cores, and if the sizes are extreme.
pub(super) fn found(a: &Swept<'_>, b: &Swept<'_>) -> Option<Found> {
    match (a.core, b.core) {
        (Core::Points([point]), Core::Turned(_) | Core::Points([_, _, _])) => {
            let offset = Offset::between(a.pose, b.pose).rounded;
            let center = a.pose.linear().map(|row| dot(&row, point));
            let near = Near::of(a, &sub(&center, &offset), b, &offset)?;
            let points = [center, add(&near.foot, &offset)];
            Some(Found { gap: near.gap, vector: near.vector, points, extent: near.extent })
        }
        (Core::Turned(_) | Core::Points([_, _, _]), Core::Points([point])) => {
            let offset = Offset::between(a.pose, b.pose).rounded;
            let center = add(&offset, &b.pose.linear().map(|row| dot(&row, point)));
            let near = Near::of(b, &center, a, &offset)?;
            let vector = near.vector.map(|x| -x);
            Some(Found { gap: near.gap, vector, points: [near.foot, center], extent: near.extent })
        }
        _ => None,
    }
}

/// Bounds on the distance of a point from another core, with the proposed nearest point of it.
struct Near {
    gap: Gap,
    /// Nearest point, relative to the translation of the other core.
    foot: Vector,
    /// Vector from the point to the foot.
    vector: Vector,
    extent: f64,
}

impl Near {
    /// Computes the bounds, for a point relative to the translation of the other core.
    fn of(sphere: &Swept<'_>, point: &Vector, other: &Swept<'_>, offset: &Vector) -> Option<Self> {
        let linear = other.pose.linear();
        let image = |local: &Vector| linear.map(|row| dot(&row, local));
        let extent = extent(sphere) + extent(other) + offset.map(f64::abs).iter().sum::<f64>();
        if !is_in_range(extent) {
            return None;
        }
        let foot = match other.core {
            Core::Points([p, q, r]) => point_triangle(point, &[p, q, r].map(image)).1,
            Core::Turned(set) => {
                let local = std::array::from_fn(|k| (0..3).map(|row| linear[row][k] * point[row]).sum());
                image(&set.nearest(&local))
            }
            _ => return None,
        };
        let vector = sub(&foot, point);
        let length = self::length(&vector);
        let upper = length * (1.0 + 4.0 * UNIT_ROUNDOFF) + 32.0 * UNIT_ROUNDOFF * extent;
        // The least distance along a vector, from the point of the other core that is nearest along
        // it.
        let lower_along = |vector: &Vector, length: f64| {
            let back = std::array::from_fn(|k| -(0..3).map(|row| linear[row][k] * vector[row]).sum::<f64>());
            let (farthest, _) = other.core.farthest(to_unit_entries(back), 0);
            let along = if length > 0.0 { dot(vector, &sub(&image(&farthest), point)) / length } else { 0.0 };
            along - 4.0 * UNIT_ROUNDOFF * along.abs() - 64.0 * UNIT_ROUNDOFF * extent
        };
        let (mut vector, mut lower) = (vector, lower_along(&vector, length));
        if lower <= 0.5 * upper
            && let Core::Turned(_) = other.core
        {
            // A short vector to a flat end is so tilted by rounding that the rim is beyond the
            // point along it. The axis is not.
            let axis = linear.map(|row| row[2]);
            let sign = if dot(&axis, &vector) < 0.0 { -1.0 } else { 1.0 };
            let scale = sign * length / self::length(&axis);
            let upright = axis.map(|x| scale * x);
            let lower_upright = lower_along(&upright, length);
            if lower_upright > lower {
                (vector, lower) = (upright, lower_upright);
            }
        }
        Some(Self { gap: Gap { lower: lower.max(0.0), upper, length }, foot, vector, extent })
    }
}

/// Returns the sum of the magnitudes of all terms of the coordinates of a core.
fn extent(swept: &Swept<'_>) -> f64 {
    let reach = swept.core.reach();
    swept.pose.linear().iter().map(|row| dot(&row.map(f64::abs), &reach)).sum()
}

impl Turned {
    /// Returns a nearest point to a point, both in the frame of the set, rounded.
    fn nearest(&self, point: &Vector) -> Vector {
        let [x, y, z] = *point;
        let across = (x * x + y * y).sqrt();
        let [near_across, near_z] = if self.is_cone {
            self.nearest_of_profile(across, z)
        } else {
            [across.min(self.radius), z.clamp(-self.half_height, self.half_height)]
        };
        let scale = if near_across < across { near_across / across } else { 1.0 };
        [x * scale, y * scale, near_z]
    }

    /// Returns the nearest point of half of the section of a cone through its axis, as the distance
    /// from the axis and the height.
    fn nearest_of_profile(&self, across: f64, z: f64) -> [f64; 2] {
        let (half, radius) = (self.half_height, self.radius);
        let is_above_base = z >= -half;
        let is_within = is_above_base && z <= half && across <= radius;
        if is_within && 2.0 * half * across + radius * (z - half) <= 0.0 {
            return [across, z];
        }
        let squared = radius * radius + 4.0 * half * half;
        let share = if squared > 0.0 { (across * radius + (half - z) * 2.0 * half) / squared } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        let on_slant = [share * radius, half - 2.0 * half * share];
        let on_base = [across.min(radius), -half];
        let squared_distance = |[x, y]: [f64; 2]| (x - across) * (x - across) + (y - z) * (y - z);
        if !is_above_base && squared_distance(on_base) < squared_distance(on_slant) { on_base } else { on_slant }
    }
}
