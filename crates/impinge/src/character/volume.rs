//! The volumes that stand for the parts of a character, in the rigid frame of a bone, and rays against them.

use std::sync::Arc;

use crate::convex::Support;
use crate::hull::{Hull, HullKind};
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::shape::{PlacedShape, Shape};
use crate::volume::{BoundingSphere, BoundingVolume, Capsule, Lozenge, Obb};

use super::transform::{Vector, apply, matrix, normalised};
use super::vector::{add, cross, dot, length, scale, sub, unit};

/// The kinds of hit volumes, from the cheapest to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VolumeKind {
    /// A sphere.
    Sphere,
    /// A pill: a segment swept by a sphere.
    Capsule,
    /// An oriented box.
    Box,
    /// A rectangle swept by a sphere.
    Lozenge,
    /// A convex hull.
    Hull,
}

impl VolumeKind {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Sphere, Self::Capsule, Self::Box, Self::Lozenge, Self::Hull];

    /// A short stable name: `sphere`, `capsule`, `box`, `lozenge`, `hull`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Capsule => "capsule",
            Self::Box => "box",
            Self::Lozenge => "lozenge",
            Self::Hull => "hull",
        }
    }

    /// The kind of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A convex volume in a frame of its own.
#[derive(Clone, Debug)]
pub enum HitVolume {
    /// A sphere.
    Sphere(BoundingSphere),
    /// A pill.
    Capsule(Capsule),
    /// An oriented box.
    Box(Obb),
    /// A rounded plate.
    Lozenge(Lozenge),
    /// A convex hull.
    Hull(HitHull),
}

/// A hull with the planes of its faces, for rays.
#[derive(Clone, Debug)]
pub struct HitHull {
    hull: Arc<Hull>,
    /// Outward normals of length 1 and levels.
    planes: Arc<[(Vector, f64)]>,
}

impl HitHull {
    /// The hull of some points as a hit volume. One that is flat or less is made as thick as a millionth of its coordinates, as
    /// the planes of its faces would not bound it.
    ///
    /// # Errors
    /// As [`Hull::new`].
    pub fn new(points: &[[f64; 3]]) -> Result<Self, InputError> {
        let hull = Hull::new(points)?;
        if hull.kind() == HullKind::Solid {
            return Ok(Self::of_solid(hull));
        }
        let most = hull.positions().as_flattened().iter().fold(1e-30_f64, |most, x| most.max(x.abs()));
        let thick: Vec<Vector> = hull.positions().iter().flat_map(|&p| cube_about(p, 1e-6 * most)).collect();
        Ok(Self::of_solid(Hull::new(&thick)?))
    }

    fn of_solid(hull: Hull) -> Self {
        let planes = hull.faces().iter().filter_map(|face| {
            let [a, b, c] = face.map(|corner| hull.positions()[corner as usize]);
            let normal = unit(cross(sub(b, a), sub(c, a)))?;
            // The farthest vertex, so that rounding leaves none outside.
            let level = hull.positions().iter().map(|&p| dot(normal, p)).fold(f64::NEG_INFINITY, f64::max);
            Some((normal, level))
        });
        let planes = planes.collect();
        Self { hull: Arc::new(hull), planes }
    }

    /// Outward normals of length 1, and levels.
    pub(super) fn planes(&self) -> &[(Vector, f64)] {
        &self.planes
    }

    /// The hull.
    #[must_use]
    pub fn hull(&self) -> &Arc<Hull> {
        &self.hull
    }
}

/// The corners of a cube about a point.
pub(super) fn cube_about(point: Vector, half: f64) -> [Vector; 8] {
    std::array::from_fn(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { point[k] + half } else { point[k] - half }))
}

/// The part of a ray that is within a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// In units of the direction; the first is not below zero.
    pub(super) t: [f64; 2],
    /// Out of the volume where the ray enters; against the ray where it starts inside.
    pub(super) normal: Vector,
}

/// Of the distance from a ray's origin and of a volume's size: what rays are taken as thicker by. A projection onto the ray and
/// the offset from it are some 20 roundings of numbers of that size, in all below 2^-47 of it.
const RAY_PADDING: f64 = 1.0 / (1_u64 << 46) as f64;

impl HitVolume {
    /// Which kind it is.
    #[must_use]
    pub fn kind(&self) -> VolumeKind {
        match self {
            Self::Sphere(_) => VolumeKind::Sphere,
            Self::Capsule(_) => VolumeKind::Capsule,
            Self::Box(_) => VolumeKind::Box,
            Self::Lozenge(_) => VolumeKind::Lozenge,
            Self::Hull(_) => VolumeKind::Hull,
        }
    }

    /// The area of its surface, rounded: what rays from everywhere meet it by.
    #[must_use]
    pub fn surface_area(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.surface_area(),
            Self::Capsule(capsule) => capsule.surface_area(),
            Self::Box(obb) => obb.surface_area(),
            Self::Lozenge(lozenge) => lozenge.surface_area(),
            Self::Hull(HitHull { hull, .. }) => {
                let area = |face: &[u32; 3]| {
                    let [a, b, c] = face.map(|corner| hull.positions()[corner as usize]);
                    0.5 * length(cross(sub(b, a), sub(c, a)))
                };
                hull.faces().iter().map(area).sum()
            }
        }
    }

    /// Bytes that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Sphere(sphere) => size_of_val(sphere),
            Self::Capsule(capsule) => size_of_val(capsule),
            Self::Box(obb) => size_of_val(obb),
            Self::Lozenge(lozenge) => size_of_val(lozenge),
            Self::Hull(HitHull { hull, planes }) => hull.memory() + size_of_val(&planes[..]),
        }
    }

    /// A sphere that holds it, up to rounding: its centre and radius.
    #[must_use]
    pub fn bounding_sphere(&self) -> ([f64; 3], f64) {
        match self {
            Self::Sphere(sphere) => (sphere.centre(), sphere.radius()),
            Self::Capsule(capsule) => {
                let [a, b] = capsule.ends();
                (scale(add(a, b), 0.5), 0.5 * length(sub(b, a)) + capsule.radius())
            }
            Self::Box(obb) => (obb.centre(), length(obb.half_extents())),
            Self::Lozenge(lozenge) => {
                let diagonal = add(lozenge.edges()[0], lozenge.edges()[1]);
                let other = sub(lozenge.edges()[0], lozenge.edges()[1]);
                let centre = add(lozenge.corner(), scale(diagonal, 0.5));
                (centre, 0.5 * length(diagonal).max(length(other)) + lozenge.radius())
            }
            Self::Hull(HitHull { hull, .. }) => {
                let [low, high] = box_of(hull.positions());
                let centre = scale(add(low, high), 0.5);
                let radius = hull.positions().iter().map(|&p| length(sub(p, centre))).fold(0.0, f64::max);
                (centre, radius)
            }
        }
    }

    /// The point of the volume that is farthest along a direction, rounded; the direction needs no length of 1.
    #[must_use]
    pub fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let out = |radius: f64| unit(direction).map_or([0.0; 3], |direction| scale(direction, radius));
        match self {
            Self::Sphere(sphere) => add(sphere.centre(), out(sphere.radius())),
            Self::Capsule(capsule) => {
                let [a, b] = capsule.ends();
                add(if dot(sub(b, a), direction) > 0.0 { b } else { a }, out(capsule.radius()))
            }
            Self::Box(obb) => (0..3).fold(obb.centre(), |at, k| {
                let axis = obb.axes()[k];
                add(at, scale(axis, obb.half_extents()[k].copysign(dot(axis, direction))))
            }),
            Self::Lozenge(lozenge) => RoundedPlate(*lozenge).support(direction),
            Self::Hull(HitHull { hull, .. }) => hull.positions()[hull.support(direction) as usize],
        }
    }

    /// How far a point is outside, and below zero how far it is inside, up to rounding. For points outside of a hull it may be
    /// less than the distance, but not zero.
    #[must_use]
    pub fn signed_distance(&self, point: [f64; 3]) -> f64 {
        match self {
            Self::Sphere(_) | Self::Capsule(_) | Self::Lozenge(_) => {
                length(sub(point, self.closest_on_core(point))) - self.radius()
            }
            Self::Box(obb) => {
                let offset = sub(point, obb.centre());
                let beyond = [0, 1, 2].map(|k| dot(obb.axes()[k], offset).abs() - obb.half_extents()[k]);
                let deepest = beyond.into_iter().fold(f64::NEG_INFINITY, f64::max);
                if deepest <= 0.0 { deepest } else { length(beyond.map(|x| x.max(0.0))) }
            }
            Self::Hull(HitHull { planes, .. }) => {
                planes.iter().map(|&(normal, level)| dot(normal, point) - level).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// Of the sphere that sweeps it; zero where none does.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.radius(),
            Self::Capsule(capsule) => capsule.radius(),
            Self::Lozenge(lozenge) => lozenge.radius(),
            Self::Box(_) | Self::Hull(_) => 0.0,
        }
    }

    /// The point of what the sphere sweeps that is closest to another, rounded.
    pub(super) fn closest_on_core(&self, point: Vector) -> Vector {
        match self {
            Self::Sphere(sphere) => sphere.centre(),
            Self::Capsule(capsule) => {
                let [from, to] = capsule.ends();
                toward(from, sub(to, from), sub(point, from))
            }
            Self::Lozenge(lozenge) => {
                // The edges are at right angles.
                let offset = sub(point, lozenge.corner());
                lozenge.edges().into_iter().fold(lozenge.corner(), |at, edge| toward(at, edge, offset))
            }
            Self::Box(obb) => obb.centre(),
            Self::Hull(HitHull { hull, .. }) => hull.positions()[0],
        }
    }

    /// The shape in the world, for everything but rays.
    ///
    /// # Errors
    /// A volume beyond the range of shapes.
    pub fn placed(&self, world_from_local: Pose) -> Result<PlacedShape, InputError> {
        match self {
            Self::Sphere(sphere) => Shape::sphere(sphere.centre(), sphere.radius())?.at(world_from_local),
            Self::Capsule(capsule) => {
                let [a, b] = capsule.ends();
                Shape::capsule(a, b, capsule.radius())?.at(world_from_local)
            }
            Self::Lozenge(lozenge) => Shape::custom(Arc::new(RoundedPlate(*lozenge)))?.at(world_from_local),
            Self::Box(obb) => {
                let columns = obb.axes();
                let linear = [0, 1, 2].map(|i| [0, 1, 2].map(|k| columns[k][i]));
                Shape::cuboid(obb.half_extents())?.at(world_from_local.compose(&Pose::new(linear, obb.centre())?)?)
            }
            Self::Hull(HitHull { hull, .. }) => Shape::hull(hull.clone()).at(world_from_local),
        }
    }

    /// Where a ray is in the volume; the direction has a length. The part that is found is never too short, but for a grazing
    /// one it may be a little long: the volume is taken as thicker by some 2^-46 of its size and its distance from the origin.
    pub(super) fn crossing(&self, origin: Vector, direction: Vector) -> Option<Crossing> {
        let (middle, reach) = self.bounding_sphere();
        let squared = dot(direction, direction);
        // From near the volume, so that what cancels is small.
        let shift = dot(direction, sub(middle, origin)) / squared;
        let near = [0, 1, 2].map(|k| origin[k] + shift * direction[k]);
        let padding = RAY_PADDING * (length(sub(middle, origin)) + length(origin) + length(middle) + reach);
        let radius = self.radius() + padding;
        let found = match self {
            Self::Sphere(sphere) => through_sphere(near, direction, sphere.centre(), radius),
            Self::Capsule(capsule) => through_capsule(near, direction, capsule.ends(), radius),
            Self::Lozenge(lozenge) => through_lozenge(near, direction, lozenge, radius),
            Self::Box(obb) => {
                let offset = sub(near, obb.centre());
                let slabs = [0, 1, 2].map(|k| (dot(obb.axes()[k], offset), dot(obb.axes()[k], direction)));
                between_planes((0..6).map(|side| {
                    let (k, sign) = (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
                    (sign * slabs[k].0 - obb.half_extents()[k] - padding, sign * slabs[k].1)
                }))
            }
            Self::Hull(HitHull { planes, .. }) => between_planes(
                planes.iter().map(|&(normal, level)| (dot(normal, near) - level - padding, dot(normal, direction))),
            ),
        }?;
        let [enter, leave] = found.map(|t| t + shift);
        if leave < 0.0 {
            return None;
        }
        if enter <= 0.0 {
            return Some(Crossing { t: [0.0, leave], normal: scale(direction, -1.0 / squared.sqrt()) });
        }
        let point = [0, 1, 2].map(|k| origin[k] + enter * direction[k]);
        Some(Crossing { t: [enter, leave], normal: self.normal_at(point) })
    }

    /// The outward normal at a point of the surface, or nearly.
    fn normal_at(&self, point: Vector) -> Vector {
        const ANY: Vector = [0.0, 0.0, 1.0];
        match self {
            Self::Sphere(_) | Self::Capsule(_) | Self::Lozenge(_) => {
                unit(sub(point, self.closest_on_core(point))).unwrap_or(ANY)
            }
            Self::Box(obb) => {
                let offset = sub(point, obb.centre());
                let beyond = [0, 1, 2].map(|k| dot(obb.axes()[k], offset));
                let excess = |k: usize| beyond[k].abs() - obb.half_extents()[k];
                let k = (0..3).max_by(|&i, &j| excess(i).total_cmp(&excess(j))).unwrap_or(0);
                scale(obb.axes()[k], 1_f64.copysign(beyond[k]))
            }
            Self::Hull(HitHull { planes, .. }) => {
                let excess = |plane: &(Vector, f64)| dot(plane.0, point) - plane.1;
                planes.iter().max_by(|a, b| excess(a).total_cmp(&excess(b))).map_or(ANY, |plane| plane.0)
            }
        }
    }
}

fn through_sphere(from: Vector, direction: Vector, centre: Vector, radius: f64) -> Option<[f64; 2]> {
    let offset = sub(from, centre);
    let (a, b) = (dot(direction, direction), dot(direction, offset));
    // The offset across the ray, so that nothing cancels.
    let across = sub(offset, scale(direction, b / a));
    let left = radius * radius - dot(across, across);
    (left >= 0.0).then(|| {
        let half = (left / a).sqrt();
        [-b / a - half, -b / a + half]
    })
}

/// The two ends and the cylinder between.
fn through_capsule(from: Vector, direction: Vector, [p, q]: [Vector; 2], radius: f64) -> Option<[f64; 2]> {
    let ends = [p, q].into_iter().filter_map(|end| through_sphere(from, direction, end, radius));
    let axis = sub(q, p);
    let tube = unit(axis).and_then(|axis_unit| {
        let flat = |v: Vector| sub(v, scale(axis_unit, dot(axis_unit, v)));
        let (offset, along) = (flat(sub(from, p)), flat(direction));
        let a = dot(along, along);
        let inside = if a > 0.0 {
            let b = dot(along, offset);
            let across = sub(offset, scale(along, b / a));
            let left = radius * radius - dot(across, across);
            if left < 0.0 {
                return None;
            }
            let half = (left / a).sqrt();
            [-b / a - half, -b / a + half]
        } else if dot(offset, offset) <= radius * radius {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            return None;
        };
        let (height, speed) = (dot(axis_unit, sub(from, p)), dot(axis_unit, direction));
        let caps = between_planes([(-height, -speed), (height - length(axis), speed)].into_iter())?;
        let both = [inside[0].max(caps[0]), inside[1].min(caps[1])];
        (both[0] <= both[1]).then_some(both)
    });
    ends.chain(tube).reduce(hull_of_intervals)
}

/// The four sides, and the plate between them.
fn through_lozenge(from: Vector, direction: Vector, lozenge: &Lozenge, radius: f64) -> Option<[f64; 2]> {
    let ([u, v], c) = (lozenge.edges(), lozenge.corner());
    let (cu, cv, cuv) = (add(c, u), add(c, v), add(add(c, u), v));
    let sides = [[c, cu], [c, cv], [cu, cuv], [cv, cuv]];
    let rims = sides.into_iter().filter_map(|side| through_capsule(from, direction, side, radius));
    let plate = match (unit(u), unit(v), unit(cross(u, v))) {
        (Some(along), Some(aside), Some(normal)) => {
            let offset = sub(from, c);
            let slab = |axis: Vector, low: f64, high: f64| {
                let (x, speed) = (dot(axis, offset), dot(axis, direction));
                [(low - x, -speed), (x - high, speed)]
            };
            let slabs = [slab(along, 0.0, length(u)), slab(aside, 0.0, length(v)), slab(normal, -radius, radius)];
            between_planes(slabs.into_iter().flatten())
        }
        _ => None,
    };
    rims.chain(plate).reduce(hull_of_intervals)
}

fn hull_of_intervals(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Where a ray is inside of planes, given by its height over each at its start and its speed upwards.
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

/// A point moved along an edge as far as an offset goes with it, and not beyond.
fn toward(at: Vector, edge: Vector, offset: Vector) -> Vector {
    let squared = dot(edge, edge);
    let share = if squared > 0.0 { (dot(edge, offset) / squared).clamp(0.0, 1.0) } else { 0.0 };
    add(at, scale(edge, share))
}

/// The corners of the axis-aligned box of some points.
pub(super) fn box_of(points: &[Vector]) -> [Vector; 2] {
    points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [[0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k]))]
    })
}

/// A lozenge by its support function.
#[derive(Debug)]
struct RoundedPlate(Lozenge);

impl Support for RoundedPlate {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let edges = self.0.edges().into_iter().filter(|&edge| dot(edge, direction) > 0.0);
        let corner = edges.fold(self.0.corner(), add);
        let out = unit(direction).map_or([0.0; 3], |direction| scale(direction, self.0.radius()));
        add(corner, out)
    }

    fn reach(&self) -> [f64; 3] {
        let ([u, v], c, r) = (self.0.edges(), self.0.corner(), self.0.radius());
        let corners = [c, add(c, u), add(c, v), add(add(c, u), v)];
        // Up to rounding of the corner and of the sum.
        [0, 1, 2].map(|k| (corners.iter().fold(0.0_f64, |m, p| m.max(p[k].abs())) + r) * (1.0 + 1e-14))
    }
}

/// A rigid frame of a bone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub(super) rotation_wxyz: [f64; 4],
    pub(super) rotation: [[f64; 3]; 3],
    pub(super) origin: [f64; 3],
}

impl Frame {
    /// The frame with a rotation (w, x, y, z) of length 1.
    pub(super) fn new(rotation_wxyz: [f64; 4], origin: Vector) -> Self {
        Self { rotation_wxyz, rotation: matrix(rotation_wxyz), origin }
    }

    /// Where a point of the frame is in the world.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        add(apply(&self.rotation, point), self.origin)
    }

    /// Where a point of the world is in the frame.
    #[must_use]
    pub fn local(&self, point: [f64; 3]) -> [f64; 3] {
        super::transform::apply_transposed(&self.rotation, sub(point, self.origin))
    }

    /// The frame as a pose.
    ///
    /// # Errors
    /// An origin out of range, which no pose of a rig has.
    pub fn pose(&self) -> Result<Pose, InputError> {
        Pose::new(self.rotation, self.origin)
    }
}

/// The frame of a pose, and how far a point within a unit of its origin is from where the pose has it.
///
/// # Errors
/// A pose that is no rotation within 1e-4, or mirrors.
pub(super) fn frame_of(pose: &Pose) -> Result<(Frame, f64), InputError> {
    const RIGID: f64 = 1e-4;
    let m = pose.linear();
    let [a, b, c] = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    let [d, e, f] = [m[0][1] + m[1][0], m[1][2] + m[2][1], m[2][0] + m[0][2]];
    let (p, q, r) = (m[0][0], m[1][1], m[2][2]);
    // Four expressions for the quaternion, of different lengths.
    let candidates = [
        [1.0 + p + q + r, a, b, c],
        [a, 1.0 + p - q - r, d, f],
        [b, d, 1.0 - p + q - r, e],
        [c, f, e, 1.0 - p - q + r],
    ];
    let longest = (0..4).max_by(|&i, &j| candidates[i][i].total_cmp(&candidates[j][j])).unwrap_or(0);
    let rotation = normalised(candidates[longest]).unwrap_or([1.0, 0.0, 0.0, 0.0]);
    let frame = Frame::new(rotation, *pose.translation());
    let difference = (0..9).map(|k| (frame.rotation[k / 3][k % 3] - m[k / 3][k % 3]).powi(2)).sum::<f64>().sqrt();
    if difference > RIGID {
        return Err(InputError::new(InputErrorKind::NotRigid { deviation: 2.0 * difference }));
    }
    Ok((frame, difference))
}
