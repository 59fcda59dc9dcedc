//! The part of a ray that is inside a volume.
//!
//! Tests: `impinge-files/tests/it/characters/rays.rs`. Benchmark: `characters`.

use crate::volume::Lozenge;

use super::volume::HitVolume;
use crate::math::vec3::{Vector, add, cross, dot, length, scale, sub, unit};

/// The interval of a ray that is inside a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// Start and end of the interval in units of the direction's length. The start is at least 0.
    pub(super) t: [f64; 2],
    /// Unit normal. It points out of the volume where the ray enters, or against the ray if it
    /// starts inside.
    pub(super) normal: Vector,
}

/// Padding that thickens the volume, relative to its size and its distance from the ray's origin:
/// 2^-46. A projection onto the ray and the offset from it take about 20 roundings of numbers of
/// that size, in total below 2^-47 of it. A larger value makes grazing intervals too long.
const RAY_PADDING: f64 = 1.0 / (1_u64 << 46) as f64;

impl HitVolume {
    /// Returns the interval of the ray inside the volume, or `None` if the ray misses it. The
    /// direction must have a nonzero length.
    ///
    /// The interval is never too short. For a grazing ray it may be slightly too long, because the
    /// volume is thickened by about 2^-46 of its size and of its distance from the origin.
    pub(super) fn crossing(&self, origin: Vector, direction: Vector) -> Option<Crossing> {
        let (middle, reach) = self.bounding_sphere();
        let squared = dot(&direction, &direction);
        // Starts near the volume, so that cancellation errors are small.
        let shift = dot(&direction, &sub(&middle, &origin)) / squared;
        let near = [0, 1, 2].map(|k| origin[k] + shift * direction[k]);
        let padding = RAY_PADDING * (length(&sub(&middle, &origin)) + length(&origin) + length(&middle) + reach);
        let radius = self.radius() + padding;
        let found = match self {
            Self::Sphere(sphere) => through_sphere(near, direction, sphere.center(), radius),
            Self::Capsule(capsule) => through_capsule(near, direction, capsule.ends(), radius),
            Self::Lozenge(lozenge) => through_lozenge(near, direction, lozenge, radius),
            Self::Box(obb) => {
                let offset = sub(&near, &obb.center());
                let slabs = [0, 1, 2].map(|k| (dot(&obb.axes()[k], &offset), dot(&obb.axes()[k], &direction)));
                between_planes((0..6).map(|side| {
                    let (k, sign) = (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
                    (sign * slabs[k].0 - obb.half_extents()[k] - padding, sign * slabs[k].1)
                }))
            }
            Self::Hull(hull) => between_planes(
                hull.planes()
                    .iter()
                    .map(|&(normal, level)| (dot(&normal, &near) - level - padding, dot(&normal, &direction))),
            ),
        }?;
        let [enter, leave] = found.map(|t| t + shift);
        if leave < 0.0 {
            return None;
        }
        if enter <= 0.0 {
            return Some(Crossing { t: [0.0, leave], normal: scale(&direction, -1.0 / squared.sqrt()) });
        }
        let point = [0, 1, 2].map(|k| origin[k] + enter * direction[k]);
        Some(Crossing { t: [enter, leave], normal: self.normal_at(point) })
    }

    /// Returns the outward unit normal at a point of the surface, up to rounding.
    fn normal_at(&self, point: Vector) -> Vector {
        const ANY: Vector = [0.0, 0.0, 1.0];
        match self {
            Self::Sphere(_) | Self::Capsule(_) | Self::Lozenge(_) => {
                unit(&sub(&point, &self.closest_on_core(point))).unwrap_or(ANY)
            }
            Self::Box(obb) => {
                let offset = sub(&point, &obb.center());
                let beyond = [0, 1, 2].map(|k| dot(&obb.axes()[k], &offset));
                let excess = |k: usize| beyond[k].abs() - obb.half_extents()[k];
                let k = (0..3).max_by(|&i, &j| excess(i).total_cmp(&excess(j))).unwrap_or(0);
                scale(&obb.axes()[k], 1_f64.copysign(beyond[k]))
            }
            Self::Hull(hull) => {
                let excess = |plane: &(Vector, f64)| dot(&plane.0, &point) - plane.1;
                hull.planes().iter().max_by(|a, b| excess(a).total_cmp(&excess(b))).map_or(ANY, |plane| plane.0)
            }
        }
    }
}

fn through_sphere(from: Vector, direction: Vector, center: Vector, radius: f64) -> Option<[f64; 2]> {
    let offset = sub(&from, &center);
    let (a, b) = (dot(&direction, &direction), dot(&direction, &offset));
    // The offset perpendicular to the ray, computed without cancellation.
    let across = sub(&offset, &scale(&direction, b / a));
    let left = radius * radius - dot(&across, &across);
    (left >= 0.0).then(|| {
        let half = (left / a).sqrt();
        [-b / a - half, -b / a + half]
    })
}

/// Returns the interval inside the two end spheres and the cylinder between them.
fn through_capsule(from: Vector, direction: Vector, [p, q]: [Vector; 2], radius: f64) -> Option<[f64; 2]> {
    let ends = [p, q].into_iter().filter_map(|end| through_sphere(from, direction, end, radius));
    let axis = sub(&q, &p);
    let tube = unit(&axis).and_then(|axis_unit| {
        let flat = |v: Vector| sub(&v, &scale(&axis_unit, dot(&axis_unit, &v)));
        let (offset, along) = (flat(sub(&from, &p)), flat(direction));
        let a = dot(&along, &along);
        let inside = if a > 0.0 {
            let b = dot(&along, &offset);
            let across = sub(&offset, &scale(&along, b / a));
            let left = radius * radius - dot(&across, &across);
            if left < 0.0 {
                return None;
            }
            let half = (left / a).sqrt();
            [-b / a - half, -b / a + half]
        } else if dot(&offset, &offset) <= radius * radius {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            return None;
        };
        let (height, speed) = (dot(&axis_unit, &sub(&from, &p)), dot(&axis_unit, &direction));
        let caps = between_planes([(-height, -speed), (height - length(&axis), speed)].into_iter())?;
        let both = [inside[0].max(caps[0]), inside[1].min(caps[1])];
        (both[0] <= both[1]).then_some(both)
    });
    ends.chain(tube).reduce(hull_of_intervals)
}

/// Returns the interval inside the four rounded sides and the plate between them.
fn through_lozenge(from: Vector, direction: Vector, lozenge: &Lozenge, radius: f64) -> Option<[f64; 2]> {
    let ([u, v], c) = (lozenge.edges(), lozenge.corner());
    let (cu, cv, cuv) = (add(&c, &u), add(&c, &v), add(&add(&c, &u), &v));
    let sides = [[c, cu], [c, cv], [cu, cuv], [cv, cuv]];
    let rims = sides.into_iter().filter_map(|side| through_capsule(from, direction, side, radius));
    let plate = match (unit(&u), unit(&v), unit(&cross(&u, &v))) {
        (Some(along), Some(aside), Some(normal)) => {
            let offset = sub(&from, &c);
            let slab = |axis: Vector, low: f64, high: f64| {
                let (x, speed) = (dot(&axis, &offset), dot(&axis, &direction));
                [(low - x, -speed), (x - high, speed)]
            };
            let slabs = [slab(along, 0.0, length(&u)), slab(aside, 0.0, length(&v)), slab(normal, -radius, radius)];
            between_planes(slabs.into_iter().flatten())
        }
        _ => None,
    };
    rims.chain(plate).reduce(hull_of_intervals)
}

fn hull_of_intervals(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Returns the interval of a ray below all planes. Each plane is given by the ray's initial height
/// over it and its upward speed.
fn between_planes(planes: impl Iterator<Item = (f64, f64)>) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for (height, speed) in planes {
        if speed == 0.0 {
            if height > 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            enter = enter.max(-height / speed);
        } else {
            leave = leave.min(-height / speed);
        }
    }
    (enter <= leave && enter < f64::INFINITY && leave > f64::NEG_INFINITY).then_some([enter, leave])
}
