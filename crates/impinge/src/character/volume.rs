//! The volumes of the parts of a character, in the rigid frame of a bone.
//!
//! Tests: `impinge-files/tests/it/characters/rays.rs`. Benchmark: `characters`.

use std::sync::Arc;

use crate::convex::Support;
use crate::hull::{Hull, HullKind};
use crate::input::InputError;
use crate::math::Pose;
use crate::shape::{PlacedShape, Shape};
use crate::volume::{BoundingSphere, BoundingVolume, Capsule, Lozenge, Obb};

use super::corners::Corners;
use crate::math::vec3::{Vector, add, cross, dot, length, scale, sub, unit};

/// The kinds of hit volumes, sorted by the cost of a query, fastest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum VolumeKind {
    /// A sphere.
    Sphere,
    /// A capsule: a segment swept by a sphere.
    Capsule,
    /// An oriented box.
    Box,
    /// A lozenge: a rectangle swept by a sphere.
    Lozenge,
    /// A convex hull.
    Hull,
}

impl VolumeKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Sphere, Self::Capsule, Self::Box, Self::Lozenge, Self::Hull];

    /// Returns a short stable name: `sphere`, `capsule`, `box`, `lozenge` or `hull`.
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

    /// Returns the kind with the given name, or `None` for an unknown name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A convex volume in its own frame, which rays and other volumes may hit.
#[derive(Clone, Debug)]
pub enum HitVolume {
    /// A sphere.
    Sphere(BoundingSphere),
    /// A capsule.
    Capsule(Capsule),
    /// An oriented box.
    Box(Obb),
    /// A lozenge: a rounded rectangular plate.
    Lozenge(Lozenge),
    /// A convex hull.
    Hull(HitHull),
}

/// A hull with the planes of its faces, for rays.
#[derive(Clone, Debug)]
pub struct HitHull {
    hull: Arc<Hull>,
    /// Outward unit normals n and levels: the plane of a face is n · x = level.
    planes: Arc<[(Vector, f64)]>,
    corners: Arc<Corners>,
}

impl HitHull {
    /// Builds the hull of some points as a hit volume, in the frame of the points. A hull without
    /// volume has no face planes that bound it, so each of its points is replaced by a cube. The
    /// cube's half-edge is one millionth of the largest coordinate (in magnitude).
    ///
    /// # Errors
    /// Same as [`Hull::new`].
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
            let normal = unit(&cross(&sub(&b, &a), &sub(&c, &a)))?;
            // The level is that of the farthest vertex, so that rounding leaves no vertex outside.
            let level = hull.positions().iter().map(|&p| dot(&normal, &p)).fold(f64::NEG_INFINITY, f64::max);
            Some((normal, level))
        });
        let planes = planes.collect();
        let corners = Arc::new(Corners::new(hull.positions()));
        Self { hull: Arc::new(hull), planes, corners }
    }

    /// Returns the outward unit normals and the levels of the face planes.
    pub(super) fn planes(&self) -> &[(Vector, f64)] {
        &self.planes
    }

    /// Returns the convex hull, in the frame of the volume.
    #[must_use]
    pub fn hull(&self) -> &Arc<Hull> {
        &self.hull
    }
}

/// Maximum number of corners that are scanned for the farthest. For more corners it is faster to
/// walk the edges of the hull.
const MAX_SCANNED_CORNERS: usize = 256;

/// Returns the corners of a cube around a point, with half its edge length given.
pub(super) fn cube_about(point: Vector, half: f64) -> [Vector; 8] {
    std::array::from_fn(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { point[k] + half } else { point[k] - half }))
}

impl HitVolume {
    /// Returns the kind of the volume.
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

    /// Returns the surface area in square units of its frame, rounded. The number of random rays
    /// that hit a convex volume is proportional to it.
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
                    0.5 * length(&cross(&sub(&b, &a), &sub(&c, &a)))
                };
                hull.faces().iter().map(area).sum()
            }
        }
    }

    /// Returns the size of the volume in memory, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Sphere(sphere) => size_of_val(sphere),
            Self::Capsule(capsule) => size_of_val(capsule),
            Self::Box(obb) => size_of_val(obb),
            Self::Lozenge(lozenge) => size_of_val(lozenge),
            Self::Hull(HitHull { hull, planes, corners }) => hull.memory() + size_of_val(&planes[..]) + corners.bytes(),
        }
    }

    /// Returns the center and radius of a sphere that encloses the volume, in the volume's frame,
    /// up to rounding.
    #[must_use]
    pub fn bounding_sphere(&self) -> ([f64; 3], f64) {
        match self {
            Self::Sphere(sphere) => (sphere.center(), sphere.radius()),
            Self::Capsule(capsule) => {
                let [a, b] = capsule.ends();
                (scale(&add(&a, &b), 0.5), 0.5 * length(&sub(&b, &a)) + capsule.radius())
            }
            Self::Box(obb) => (obb.center(), length(&obb.half_extents())),
            Self::Lozenge(lozenge) => {
                let diagonal = add(&lozenge.edges()[0], &lozenge.edges()[1]);
                let other = sub(&lozenge.edges()[0], &lozenge.edges()[1]);
                let center = add(&lozenge.corner(), &scale(&diagonal, 0.5));
                (center, 0.5 * length(&diagonal).max(length(&other)) + lozenge.radius())
            }
            Self::Hull(HitHull { hull, .. }) => {
                let [low, high] = box_of(hull.positions());
                let center = scale(&add(&low, &high), 0.5);
                let radius = hull.positions().iter().map(|&p| length(&sub(&p, &center))).fold(0.0, f64::max);
                (center, radius)
            }
        }
    }

    /// Returns the point of the volume that is farthest along a direction, both in the volume's
    /// frame, rounded. The direction need not have length 1. For the zero direction, returns any
    /// point of the volume.
    #[must_use]
    pub fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let out = |radius: f64| unit(&direction).map_or([0.0; 3], |direction| scale(&direction, radius));
        match self {
            Self::Sphere(sphere) => add(&sphere.center(), &out(sphere.radius())),
            Self::Capsule(capsule) => {
                let [a, b] = capsule.ends();
                add(&if dot(&sub(&b, &a), &direction) > 0.0 { b } else { a }, &out(capsule.radius()))
            }
            Self::Box(obb) => (0..3).fold(obb.center(), |at, k| {
                let axis = obb.axes()[k];
                add(&at, &scale(&axis, obb.half_extents()[k].copysign(dot(&axis, &direction))))
            }),
            Self::Lozenge(lozenge) => RoundedPlate(*lozenge).support(direction),
            Self::Hull(HitHull { hull, corners, .. }) if hull.positions().len() <= MAX_SCANNED_CORNERS => {
                corners.support(direction)
            }
            Self::Hull(HitHull { hull, .. }) => hull.positions()[hull.support(direction) as usize],
        }
    }

    /// Returns the distance from a point in the volume's frame to the volume: positive outside,
    /// negative inside, up to rounding. For points outside a hull it may be less than the distance,
    /// but stays positive.
    #[must_use]
    pub fn signed_distance(&self, point: [f64; 3]) -> f64 {
        match self {
            Self::Sphere(_) | Self::Capsule(_) | Self::Lozenge(_) => {
                length(&sub(&point, &self.closest_on_core(point))) - self.radius()
            }
            Self::Box(obb) => {
                let offset = sub(&point, &obb.center());
                let beyond = [0, 1, 2].map(|k| dot(&obb.axes()[k], &offset).abs() - obb.half_extents()[k]);
                let deepest = beyond.into_iter().fold(f64::NEG_INFINITY, f64::max);
                if deepest <= 0.0 { deepest } else { length(&beyond.map(|x| x.max(0.0))) }
            }
            Self::Hull(HitHull { planes, .. }) => {
                planes.iter().map(|&(normal, level)| dot(&normal, &point) - level).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// Returns the radius of the sphere that sweeps the volume, or 0 if none does.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.radius(),
            Self::Capsule(capsule) => capsule.radius(),
            Self::Lozenge(lozenge) => lozenge.radius(),
            Self::Box(_) | Self::Hull(_) => 0.0,
        }
    }

    /// Returns the point of the core (which the sphere sweeps) that is closest to a point, rounded.
    /// For a box it returns the center, for a hull any of its corners.
    pub(super) fn closest_on_core(&self, point: Vector) -> Vector {
        match self {
            Self::Sphere(sphere) => sphere.center(),
            Self::Capsule(capsule) => {
                let [from, to] = capsule.ends();
                toward(from, sub(&to, &from), sub(&point, &from))
            }
            Self::Lozenge(lozenge) => {
                // The edges are perpendicular.
                let offset = sub(&point, &lozenge.corner());
                lozenge.edges().into_iter().fold(lozenge.corner(), |at, edge| toward(at, edge, offset))
            }
            Self::Box(obb) => obb.center(),
            Self::Hull(HitHull { hull, .. }) => hull.positions()[0],
        }
    }

    /// Returns the volume as a shape in the world, for all queries but rays. The pose maps the
    /// volume's frame to the world.
    ///
    /// # Errors
    /// Returns an error if the volume exceeds the range of shapes, or the error of [`Shape::at`].
    pub fn placed(&self, world_from_local: Pose) -> Result<PlacedShape, InputError> {
        let (shape, world_from_shape) = self.shape_in(world_from_local)?;
        shape.at(world_from_shape)
    }

    /// Returns the shape in its own frame, and the pose of that frame in the world, as needed for a
    /// body of a [`World`](crate::world::World). The frame of a box has the box's axes and center,
    /// and the entries of its pose are rounded as by [`Pose::compose`]. All other shapes use the
    /// volume's own frame, and `world_from_local` is returned unchanged.
    ///
    /// # Errors
    /// If the volume exceeds the range of shapes, or the pose of a box exceeds that of poses or is
    /// singular after rounding.
    pub fn shape_in(&self, world_from_local: Pose) -> Result<(Shape, Pose), InputError> {
        let shape = match self {
            Self::Sphere(sphere) => Shape::sphere(sphere.center(), sphere.radius())?,
            Self::Capsule(capsule) => {
                let [a, b] = capsule.ends();
                Shape::capsule(a, b, capsule.radius())?
            }
            Self::Lozenge(lozenge) => Shape::custom(Arc::new(RoundedPlate(*lozenge)))?,
            Self::Box(obb) => Shape::cuboid(obb.half_extents())?,
            Self::Hull(HitHull { hull, .. }) => Shape::hull(hull.clone()),
        };
        Ok((shape, self.pose_in(world_from_local)?))
    }

    /// Returns the pose of the shape's frame. The frame of a box has the box's axes and center; all
    /// other shapes use the volume's own frame.
    ///
    /// # Errors
    /// Returns an error if a box exceeds the range of poses.
    pub(super) fn pose_in(&self, world_from_local: Pose) -> Result<Pose, InputError> {
        let Self::Box(obb) = self else { return Ok(world_from_local) };
        let columns = obb.axes();
        let linear = [0, 1, 2].map(|i| [0, 1, 2].map(|k| columns[k][i]));
        world_from_local.compose(&Pose::new(linear, obb.center())?)
    }
}

/// Returns a point moved along an edge by the projection of an offset, limited to the edge.
fn toward(at: Vector, edge: Vector, offset: Vector) -> Vector {
    let squared = dot(&edge, &edge);
    let share = if squared > 0.0 { (dot(&edge, &offset) / squared).clamp(0.0, 1.0) } else { 0.0 };
    add(&at, &scale(&edge, share))
}

/// Returns the lower and upper corner of the axis-aligned box of the points.
pub(super) fn box_of(points: &[Vector]) -> [Vector; 2] {
    points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [[0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k]))]
    })
}

/// A lozenge described by its support function.
#[derive(Debug)]
struct RoundedPlate(Lozenge);

impl Support for RoundedPlate {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let edges = self.0.edges().into_iter().filter(|&edge| dot(&edge, &direction) > 0.0);
        let corner = edges.fold(self.0.corner(), |sum, edge| add(&sum, &edge));
        let out = unit(&direction).map_or([0.0; 3], |direction| scale(&direction, self.0.radius()));
        add(&corner, &out)
    }

    fn reach(&self) -> [f64; 3] {
        let ([u, v], c, r) = (self.0.edges(), self.0.corner(), self.0.radius());
        let corners = [c, add(&c, &u), add(&c, &v), add(&add(&c, &u), &v)];
        // The factor covers the rounding of the corner and of the sum.
        [0, 1, 2].map(|k| (corners.iter().fold(0.0_f64, |m, p| m.max(p[k].abs())) + r) * (1.0 + 1e-14))
    }
}
