//! Rays against worlds: the first body that a ray hits, or all of them.

use super::World;
use super::body::{BodyId, Traits};
use super::outline::Bounds;
use super::placed::Placed;
use crate::convex::Surface;
use crate::math::Pose;
use crate::math::vec3::{cross, dot, length, sub};
use crate::mesh;
use crate::partition::Ray;
use crate::query::{self, Proximity};
use crate::shape::{Form, PlacedShape, Shape};

/// First point at which a ray hits a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRayHit {
    /// Ray parameter: the distance along the ray in multiples of its direction. It is zero if the
    /// ray starts inside a shape or a solid mesh.
    ///
    /// # Accuracy
    /// For meshes the relative error is at most 2^-40, compared with the ray that is transformed to
    /// the mesh's frame and rounded there. For other shapes the error is the resolution of
    /// distances, 2^-36 of the sizes (2^-23 for a cone), divided by the cosine of the angle of
    /// incidence.
    pub t: f64,
    /// Tag of the body.
    pub tag: u64,
    /// Handle of the body.
    pub body: BodyId,
    /// Point on the ray, in the world frame, rounded.
    pub point: [f64; 3],
    /// Index of the face that was hit, for meshes. `None` for other shapes, and if the ray starts
    /// inside a solid mesh.
    pub face: Option<u32>,
}

/// Maximum number of advances along a ray. Flat sides take one, a sphere about five, a grazed
/// needle many.
const MAX_STEPS: usize = 64;

/// Distance below which a point counts as on the surface, relative to the coordinates.
const CONTACT_TOLERANCE: f64 = 1.0 / (1_u64 << 42) as f64;

impl World {
    /// Returns the first body that a ray in the world frame hits within its reach, out of the
    /// bodies for which `wanted` returns `true`. If several are hit at the same `t`, returns the
    /// body with the smallest tag, then handle. Returns `None` if no body is hit. If it is
    /// undecided whether the ray hits a round shape, the shape may count as hit or as missed.
    ///
    /// ```
    /// use impinge::partition::Ray;
    /// use impinge::{Pose, shape::Shape, world::{Body, World}};
    ///
    /// let mut world = World::new();
    /// let sphere = Body::new(Shape::sphere([0.0; 3], 1.0)?);
    /// let near = world.insert(sphere.clone().at(Pose::from_translation([5.0, 0.0, 0.0])?))?;
    /// world.insert(sphere.at(Pose::from_translation([9.0, 0.0, 0.0])?))?;
    /// let ray = Ray::new([0.0; 3], [2.0, 0.0, 0.0], f64::INFINITY)?;
    /// let hit = world.ray_cast(&ray, |_| true).expect("the near sphere");
    /// assert!(hit.body == near && (hit.t - 2.0).abs() < 1e-9);
    /// assert_eq!(world.ray_cast_all(&ray, |_| true).len(), 2);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray, mut wanted: impl FnMut(&Traits) -> bool) -> Option<BodyRayHit> {
        let mut best: Option<BodyRayHit> = None;
        self.along(ray, &mut wanted, &mut |hit| {
            if best.is_none_or(|best| is_before(&hit, &best)) {
                best = Some(hit);
            }
            best.map_or(f64::INFINITY, |best| best.t)
        });
        best
    }

    /// Returns every body that a ray in the world frame hits within its reach, out of the bodies
    /// for which `wanted` returns `true`, each with its first hit. The hits are sorted by `t`, then
    /// by tag and handle. Undecided hits are treated as in [`ray_cast`](Self::ray_cast).
    #[must_use]
    pub fn ray_cast_all(&self, ray: &Ray, mut wanted: impl FnMut(&Traits) -> bool) -> Vec<BodyRayHit> {
        let mut hits = Vec::new();
        self.along(ray, &mut wanted, &mut |hit| {
            hits.push(hit);
            f64::INFINITY
        });
        hits.sort_by(|one, other| one.t.total_cmp(&other.t).then((one.tag, one.body).cmp(&(other.tag, other.body))));
        hits
    }

    /// Calls `report` for hits, in no particular order, that are no farther than the parameter that
    /// `report` last returned.
    fn along(&self, ray: &Ray, wanted: &mut dyn FnMut(&Traits) -> bool, report: &mut dyn FnMut(BodyRayHit) -> f64) {
        let mut reach = ray.reach();
        let mut look = |index: u32| {
            if let Some((body, resident)) = self.state.residents.at(index)
                && wanted(&resident.traits)
                && let Some((t, face)) = first_hit(&resident.placed, self.state.bounds_of(index), ray)
                && t <= reach
            {
                let (from, direction) = (ray.origin(), ray.direction());
                let point = std::array::from_fn(|k| from[k] + t * direction[k]);
                reach = reach.min(report(BodyRayHit { t, tag: resident.traits.tag, body, point, face }));
            }
            reach
        };
        self.state.broad.along(ray, &mut look);
    }
}

fn is_before(one: &BodyRayHit, other: &BodyRayHit) -> bool {
    one.t < other.t || one.t == other.t && (one.tag, one.body) < (other.tag, other.body)
}

/// Returns the parameter at which a ray first hits a body, and the face that it hits.
fn first_hit(placed: &Placed, bounds: &Bounds, ray: &Ray) -> Option<(f64, Option<u32>)> {
    let [enter, leave] = match bounds {
        Bounds::Nowhere => return None,
        Bounds::Box(bounds) => ray.through(bounds)?,
        Bounds::Behind(_) | Bounds::Anywhere => [0.0, f64::MAX],
    };
    if enter > ray.reach() {
        return None;
    }
    let part_hit = |part: &PlacedShape| match part.form() {
        Form::Surface(surface) => hit_mesh(&surface, ray, enter),
        Form::Convex(_) | Form::HalfSpace(_) => Some((hit_shape(part, ray, [enter, leave])?, None)),
    };
    let parts = placed.in_world().parts().iter().filter_map(part_hit);
    parts.min_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)))
}

/// Returns the first hit with a mesh. The ray is transformed to the mesh's frame, in which
/// parameters are the same. If the transformed ray is out of range, the hit is at the parameter at
/// which the ray enters the box.
fn hit_mesh(surface: &Surface<'_>, ray: &Ray, enter: f64) -> Option<(f64, Option<u32>)> {
    let &Surface { mesh, pose: world_from_mesh, is_solid } = surface;
    let inverse = Inverse::of(world_from_mesh);
    let origin = inverse.apply(sub(&ray.origin(), world_from_mesh.translation()));
    let Ok(local) = mesh::Ray::new(origin, inverse.apply(ray.direction())) else { return Some((enter, None)) };
    if is_solid && mesh.contains(&[origin]).is_ok_and(|found| found.iter().any(|found| found.is_contained())) {
        return Some((0.0, None));
    }
    mesh.ray_cast(&local).filter(|hit| hit.t <= ray.reach()).map(|hit| (hit.t, Some(hit.face)))
}

/// Inverse of a linear map, rounded.
struct Inverse([[f64; 3]; 3]);

impl Inverse {
    fn of(pose: &Pose) -> Self {
        let [x, y, z] = pose.linear();
        // The columns of the inverse are cross products of the rows, divided by the determinant.
        let columns = [cross(y, z), cross(z, x), cross(x, y)];
        let determinant = dot(&columns[0], x);
        Self(std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row] / determinant)))
    }

    fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| dot(&row, &v))
    }
}

/// Returns the parameter at which a ray hits a shape between `enter` and `leave`, by conservative
/// advancement. The nearest points of the shape and of the current point on the ray define a plane
/// with the shape on its far side, so the current point can advance to the plane.
///
/// Source: van den Bergen, *Ray casting against general convex objects with application to
/// continuous collision detection*, 2004. Ours computes the distance from scratch at each point,
/// and tilts the plane by the error of the nearest points. Whether the ray hits the shape at all is
/// decided as for a segment. If that is undecided, the ray misses if the current point gets past.
fn hit_shape(shape: &PlacedShape, ray: &Ray, [enter, leave]: [f64; 2]) -> Option<f64> {
    let (origin, direction) = (ray.origin(), ray.direction());
    let at = |t: f64| -> [f64; 3] { std::array::from_fn(|k| origin[k] + t * direction[k]) };
    let steepest = direction.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Beyond this distance the coordinates of a segment are out of range.
    const FAR: f64 = (1_u128 << 126) as f64;
    let leave = leave.min(FAR / steepest);
    let segment = ray_segment(ray, leave);
    let proximity = segment.as_ref().map_or(Proximity::Undecided, |segment| query::proximity(segment, shape));
    if proximity == Proximity::Apart {
        return None;
    }
    let end = leave.min(ray.reach());
    let (mut t, mut least) = (enter, 0.0);
    for _ in 0..MAX_STEPS {
        let current = at(t);
        let Ok(point) = Shape::point(current).and_then(|point| point.at(Pose::IDENTITY)) else { break };
        let found = query::distance(&point, shape);
        let [point_a, point_b] = found.points().unwrap_or([current; 2]);
        let size = current.iter().chain(&point_b).fold(0.0_f64, |size, x| size.max(x.abs()));
        least = CONTACT_TOLERANCE * size / steepest;
        if found.proximity == Proximity::Intersects || found.upper <= CONTACT_TOLERANCE * size {
            return Some(t);
        }
        if found.proximity == Proximity::Undecided {
            break;
        }
        let gap = sub(&point_b, &point_a);
        // The normal of the exact plane differs by an angle whose cosine is at least
        // `lower / upper`: seen from the nearest point of a convex set, the current point and any
        // other point of the set do not form an acute angle.
        let tilt = (2.0 * (1.0 - found.lower / found.upper)).max(0.0).sqrt() * length(&direction);
        let closing = dot(&gap, &direction) / length(&gap) + tilt;
        let next = t + found.lower / closing;
        if !(closing > 0.0 && next <= end) {
            // The current point gets past. If the ray is known to hit the shape, the hit is here,
            // to within rounding.
            return (proximity == Proximity::Intersects).then_some(t);
        }
        if next <= t {
            break;
        }
        t = next;
    }
    // A grazing ray hits the shape at its nearest point, because rounded pieces of the ray may all
    // miss it.
    let nearest = segment.and_then(|segment| query::distance(&segment, shape).points());
    let end = nearest.map_or(end, |[point, _]| parameter_of(&point, ray).clamp(t, end.max(t)));
    Some(advance_by_segments(shape, at, [t, end], least))
}

/// Returns the beginning of the ray as a segment, up to the parameter or farther, but not beyond
/// the ray's reach. Unless the reach limits it, the segment is the direction times a power of two,
/// moved to the ray's origin by a pose. Nothing is rounded then, so that a corner which the ray
/// touches is touched. Returns `None` if the origin is out of the range of poses.
fn ray_segment(ray: &Ray, parameter: f64) -> Option<PlacedShape> {
    let exponent = parameter.max(f64::MIN_POSITIVE).to_bits() >> 52;
    let length = f64::from_bits((exponent + 1) << 52).min(ray.reach());
    let segment = Shape::segment([[0.0; 3], ray.direction().map(|x| x * length)]).ok()?;
    segment.at(Pose::from_translation(ray.origin()).ok()?).ok()
}

/// Returns the ray parameter of a point of the ray.
fn parameter_of(point: &[f64; 3], ray: &Ray) -> f64 {
    let steepest = ray.direction().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let [from_origin, unit] = [sub(point, &ray.origin()), ray.direction()].map(|v| v.map(|x| x / steepest));
    dot(&from_origin, &unit) / dot(&unit, &unit)
}

/// Returns the last parameter up to which the ray is proved to miss the shape, to within the step
/// `least`. It is used if the distance is known too imprecisely to advance by it. The segments of
/// the ray grow until one is not proved apart, then shrink.
fn advance_by_segments(shape: &PlacedShape, at: impl Fn(f64) -> [f64; 3], [mut t, end]: [f64; 2], least: f64) -> f64 {
    let (mut step, mut is_shortened) = (least, false);
    for _ in 0..MAX_STEPS {
        let next = (t + step).min(end);
        let segment = Shape::segment([at(t), at(next)]).and_then(|segment| segment.at(Pose::IDENTITY));
        let is_apart = segment.is_ok_and(|segment| query::proximity(&segment, shape) == Proximity::Apart);
        if is_apart && next > t {
            t = next;
        } else if step <= least {
            break;
        } else {
            is_shortened = true;
        }
        step *= if is_shortened { 0.5 } else { 4.0 };
    }
    t
}
