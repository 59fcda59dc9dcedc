//! How deep two cylinders or cones with parallel axes are in each other, or a point in one of them.
//!
//! Such a set turns about an axis, and its profile is its section by a plane through the axis. The
//! height of the set along a direction depends only on the parts of the direction along and across
//! the axis. So the set of differences of two of them turns about the direction of the axes, too,
//! and its profile is the set of differences of both profiles. That is a polygon whose edges have
//! the normals of both. The depth is the distance from the origin to the nearest edge.
//!
//! Axes need only be nearly parallel, and poses nearly rigid: the distance between a set and the
//! set that turns about the common direction widens the interval.
//!
//! The proof is docs/notes/proof.md, L47. The test is below, and the benchmark is `shapes` in
//! `impinge-bench`.

use super::differences::is_in_range;
use crate::convex::core_depth::CoreDepth;
use crate::convex::posed::{Core, Swept};
use crate::convex::turned::Turned;
use crate::math::relative::{Offset, UNIT_ROUNDOFF};
use crate::math::vec3::{Vector, add, cross, dot, length, scale, sub};

/// A vector of the profile: its parts across and along the axis.
type Flat = [f64; 2];

/// A set that turns about an axis of the common direction, and stands for a core.
struct Spun {
    /// Center, relative to the translation of A.
    center: Vector,
    /// Corners of the profile, relative to the center.
    corners: [Flat; 4],
    /// Outward normals of the edges, of length 1, on the side that is not negative across.
    normals: [Flat; 3],
    /// Upper bound of the distance of a point of the core from the point that stands for it.
    deviation: f64,
}

/// Returns bounds on the depth of two cores in world units. Returns `None` if the cores are others,
/// may not overlap, or have axes that are so far from parallel that the interval would be wider
/// than `width` and than that of the iteration.
pub(super) fn depth(a: &Swept<'_>, b: &Swept<'_>, width: f64) -> Option<CoreDepth> {
    let axis = match (a.core, b.core) {
        (Core::Turned(_), Core::Turned(_) | Core::Points([_])) => a,
        (Core::Points([_]), Core::Turned(_)) => b,
        _ => return None,
    };
    let upright = axis.pose.linear().map(|row| row[2]);
    let axis = scale(&upright, 1.0 / length(&upright));
    let offset = Offset::between(a.pose, b.pose).rounded;
    let (a, b) = (Spun::of(a, &[0.0; 3], &axis)?, Spun::of(b, &offset, &axis)?);
    let to_b = sub(&b.center, &a.center);
    let extent = a.reach() + b.reach() + length(&to_b);
    let width = width.max(MAX_WIDTH * extent);
    if !is_in_range(extent) || a.deviation + b.deviation > width {
        return None;
    }
    let along = dot(&to_b, &axis);
    let beside = sub(&to_b, &scale(&axis, along));
    let mut error = a.deviation + b.deviation + 64.0 * UNIT_ROUNDOFF * extent;
    let mut distance = length(&beside);
    let across = if distance > SAME_AXIS * extent {
        scale(&beside, 1.0 / distance)
    } else {
        // Every direction across the common axis is as good as any other.
        error += distance;
        distance = 0.0;
        perpendicular(&axis)
    };
    let place = [distance, along];
    let normals = a.normals.into_iter().chain(b.normals.map(|[across, along]| [across, -along]));
    let pushes = normals.map(|normal| (a.highest(normal) - b.lowest(normal) - flat_dot(normal, place), normal));
    let (push, normal) = pushes.min_by(|x, y| x.0.total_cmp(&y.0))?;
    let is_proved = push > 2.0 * error && 2.0 * error <= width;
    let image = |[x, z]: Flat| add(&a.center, &add(&scale(&across, x), &scale(&axis, z)));
    let core = || CoreDepth {
        lower: push - error,
        upper: push + error,
        direction: add(&scale(&across, normal[0]), &scale(&axis, normal[1])),
        points: deepest(&a, &b, place, normal).map(image),
    };
    is_proved.then(core)
}

/// Maximum width of an interval, relative to the sizes: 2^-42. The iteration narrows to 2^-40.
const MAX_WIDTH: f64 = 2048.0 * UNIT_ROUNDOFF;

/// Distance of two axes, relative to the sizes, up to which they count as one: 2^-46.
const SAME_AXIS: f64 = 128.0 * UNIT_ROUNDOFF;

impl Spun {
    /// Returns the set that stands for a core, or `None` for other cores. `offset` is the
    /// translation of its pose, relative to that of A.
    fn of(swept: &Swept<'_>, offset: &Vector, axis: &Vector) -> Option<Self> {
        let linear = swept.pose.linear();
        let Turned { half_height, radius, is_cone } = match swept.core {
            Core::Turned(set) => *set,
            Core::Points([point]) => {
                let center = add(offset, &linear.map(|row| dot(&row, point)));
                return Some(Self { center, corners: [[0.0; 2]; 4], normals: [[0.0, 1.0]; 3], deviation: 0.0 });
            }
            _ => return None,
        };
        let [x, y, z] = [0, 1, 2].map(|k| linear.map(|row| row[k]));
        let side = if dot(&z, axis) < 0.0 { -1.0 } else { 1.0 };
        let first = sub(&x, &scale(axis, dot(&x, axis)));
        let first = scale(&first, 1.0 / length(&first));
        let second = cross(axis, &first);
        let second = if dot(&second, &y) < 0.0 { scale(&second, -1.0) } else { second };
        let apart = [sub(&x, &first), sub(&y, &second), sub(&z, &scale(axis, side))];
        let squared: f64 = apart.iter().map(|apart| dot(apart, apart)).sum();
        let deviation = (squared.sqrt() + 16.0 * UNIT_ROUNDOFF) * length(&[radius, radius, half_height]);
        // A cone that points against the common direction has its base above.
        let (base, top) = (-side * half_height, side * half_height);
        let slant = (4.0 * half_height * half_height + radius * radius).sqrt();
        let (tip, lean) = match is_cone {
            false => (radius, [1.0, 0.0]),
            true if slant > 0.0 => (0.0, [2.0 * half_height / slant, side * radius / slant]),
            true => (0.0, [0.0, side]),
        };
        let corners = [[radius, base], [-radius, base], [tip, top], [-tip, top]];
        // The second normal of a cone is that of its base, too.
        let normals = [[0.0, -side], [0.0, if is_cone { -side } else { side }], lean];
        Some(Self { center: *offset, corners, normals, deviation })
    }

    /// Returns an upper bound of the distance of a point of the profile from the center.
    fn reach(&self) -> f64 {
        self.corners.iter().map(|[x, z]| x.abs() + z.abs()).fold(0.0, f64::max)
    }

    fn highest(&self, direction: Flat) -> f64 {
        self.corners.iter().map(|&corner| flat_dot(corner, direction)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn lowest(&self, direction: Flat) -> f64 {
        self.corners.iter().map(|&corner| flat_dot(corner, direction)).fold(f64::INFINITY, f64::min)
    }
}

/// Returns a point of A that is highest along a normal, and a point of B that is lowest, with the
/// shortest vector between them that there is. `place` is the center of B, and both points are
/// relative to that of A.
fn deepest(a: &Spun, b: &Spun, place: Flat, normal: Flat) -> [Flat; 2] {
    let (highest, lowest) = (a.highest(normal), b.lowest(normal));
    let same = 64.0 * UNIT_ROUNDOFF * (a.reach() + b.reach());
    let tangent = [-normal[1], normal[0]];
    let range = |spun: &Spun, height: f64, start: f64| {
        let level = spun.corners.iter().filter(|&&corner| (flat_dot(corner, normal) - height).abs() <= same);
        let places = level.map(|&corner| start + flat_dot(corner, tangent));
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], at| [least.min(at), most.max(at)])
    };
    let [low_a, high_a] = range(a, highest, 0.0);
    let [low_b, high_b] = range(b, lowest, flat_dot(place, tangent));
    let middle = 0.5 * (low_a.max(low_b) + high_a.min(high_b));
    let point = |height: f64, at: f64| [0, 1].map(|k| height * normal[k] + at * tangent[k]);
    [
        point(highest, middle.max(low_a).min(high_a)),
        point(lowest + flat_dot(place, normal), middle.max(low_b).min(high_b)),
    ]
}

fn flat_dot(a: Flat, b: Flat) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Returns a vector of length 1 that is perpendicular to a vector of length 1.
fn perpendicular(axis: &Vector) -> Vector {
    let least = (0..3).min_by(|&i, &j| axis[i].abs().total_cmp(&axis[j].abs())).unwrap_or(0);
    let beside = cross(axis, &std::array::from_fn(|k| f64::from(u8::from(k == least))));
    scale(&beside, 1.0 / length(&beside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::depth::{Effort, by_iteration};
    use crate::convex::posed::Pair;
    use crate::convex::push::Push;
    use crate::math::Pose;
    use impinge_testkit::generate::{Rng, poses};

    /// Cylinders, cones and points with sizes and places on a grid, so that many normals are
    /// equally good. Some are turned about their axis by any angle.
    #[test]
    fn depths_of_parallel_axes_are_those_of_the_iteration() {
        let mut rng = Rng::new(471);
        let (mut found, mut opposite, mut coaxial, mut of_points) = (0, 0, 0, 0);
        for round in 0..1_500 {
            let mut turned = || {
                let mut size = || rng.choose(&[0.25, 0.5, 1.0]);
                Turned { half_height: size(), radius: size(), is_cone: rng.one_in(2) }
            };
            let [one, other] = [turned(), turned()];
            let rotation =
                if round % 2 == 0 { poses::cube_symmetry(&mut rng) } else { poses::rotation(&mut rng).linear };
            let angle = if round % 4 == 0 { 0.0 } else { rng.uniform(0.0, 6.0) };
            let (sin, cos) = angle.sin_cos();
            let flip = if rng.one_in(2) { 1.0 } else { -1.0 };
            let spin = [[cos, -sin * flip, 0.0], [sin, cos * flip, 0.0], [0.0, 0.0, flip]];
            let there: [[f64; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| rotation[i][k] * spin[k][j]).sum()));
            let steps = if rng.one_in(3) { [0.0; 3] } else { [0; 3].map(|_| 0.25 * rng.integer(-4, 4) as f64) };
            let here = Pose::new(rotation, [0.5, -2.0, 1.0]).expect("a pose");
            let at: [f64; 3] = std::array::from_fn(|i| here.translation()[i] + dot(&rotation[i], &steps));
            let there = Pose::new(there, at).expect("a pose");
            let point = [[0.0, 0.25, -0.25]];
            let core = if rng.one_in(4) { Core::Points(&point) } else { Core::Turned(&other) };
            let (a, b) = (
                Swept { core: Core::Turned(&one), pose: &here, radius: [0.0; 2] },
                Swept { core, pose: &there, radius: [0.0; 2] },
            );
            for (a, b) in [(&a, &b), (&b, &a)] {
                let pair = Pair::new(a, b);
                let (slow, _) = by_iteration(&pair, Effort::ROUND_DEPTH);
                let slow = slow.scaled(pair.unit);
                let Some(core) = depth(a, b, 0.0) else {
                    assert!(slow.lower < 1e-12, "{one:?} {other:?} {steps:?}: {}", slow.lower);
                    continue;
                };
                assert!(core.lower <= slow.upper && slow.lower <= core.upper, "{one:?} {other:?} {steps:?} {round}");
                assert!(core.upper - core.lower < 1e-12);
                let push = Push::along(&pair, core.direction).height * pair.unit;
                assert!((push - core.upper).abs() < 1e-12, "{push} {}", core.upper);
                let between = sub(&core.points[0], &core.points[1]);
                assert!((dot(&between, &core.direction) - core.upper).abs() < 1e-12, "{between:?} {round}");
                found += 1;
                opposite += u32::from(flip < 0.0);
                coaxial += u32::from(steps == [0.0; 3]);
                of_points += u32::from(matches!(b.core, Core::Points(_)));
            }
        }
        assert!(
            found > 1_000 && opposite > 300 && coaxial > 300 && of_points > 50,
            "{found} {opposite} {coaxial} {of_points}"
        );
    }

    #[test]
    fn axes_that_are_not_parallel_are_left_to_the_iteration() {
        let set = Turned { half_height: 1.0, radius: 0.5, is_cone: false };
        for (tilt, is_found) in [(0.0, true), (1e-15, true), (1e-9, false), (0.5, false)] {
            let (sin, cos) = f64::sin_cos(tilt);
            let tilted = Pose::new([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]], [0.25, 0.0, 0.0]);
            let tilted = tilted.expect("a pose");
            let swept = |pose| Swept { core: Core::Turned(&set), pose, radius: [0.0; 2] };
            assert_eq!(depth(&swept(&Pose::IDENTITY), &swept(&tilted), 0.0).is_some(), is_found, "{tilt}");
            assert!(tilt > 1e-8 || depth(&swept(&Pose::IDENTITY), &swept(&tilted), 1e-6).is_some());
        }
    }
}
