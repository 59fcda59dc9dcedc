//! The first hit of a ray with one body, and the normal there.

use super::outline::Bounds;
use super::placed::Placed;
use crate::convex::Surface;
use crate::math::Pose;
use crate::math::vec3::{cross, dot, length, normalized, sub};
use crate::mesh::{self, HeightField};
use crate::partition::Ray;
use crate::query::{self, ContactOptions, Proximity, Query};
use crate::shape::{Form, PlacedShape, Shape};

/// Options of a ray query of a [`World`](super::World).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayOptions {
    /// Whether rays pass through the backs of faces of meshes that are not solid. The front of a
    /// face is the side from which its corners are in counterclockwise order in the mesh frame.
    /// Faces in whose plane the ray lies, and faces without area, are passed too. The decision is
    /// exact for the ray in the mesh's frame, rounded there. Other shapes are not affected.
    pub culls_back_faces: bool,
}

/// Maximum number of advances along a ray. Flat sides take one, a sphere about five, a grazed
/// needle many.
const MAX_STEPS: usize = 64;

/// Distance below which a point counts as on the surface, relative to the coordinates.
const CONTACT_TOLERANCE: f64 = 1.0 / (1_u64 << 42) as f64;

/// The first hit of a ray with a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstHit {
    /// Ray parameter.
    pub(super) t: f64,
    /// Index of the part that was hit.
    pub(super) part: u32,
    /// Index of the face that was hit, if the part is a mesh and the ray does not start inside it.
    pub(super) face: Option<u32>,
}

impl FirstHit {
    /// Returns the first hit of a ray with a body. If several parts are hit at the same parameter,
    /// returns the first of them.
    pub(super) fn of(placed: &Placed, bounds: &Bounds, ray: &Ray, options: RayOptions) -> Option<Self> {
        let [enter, leave] = match bounds {
            Bounds::Nowhere => return None,
            Bounds::Box(bounds) => ray.through(bounds)?,
            Bounds::Behind(_) | Bounds::Anywhere => [0.0, f64::MAX],
        };
        if enter > ray.reach() {
            return None;
        }
        let part_hit = |(number, part): (u32, &PlacedShape)| {
            let (t, face) = match part.form() {
                Form::Surface(surface) => hit_mesh(&surface, ray, enter, options)?,
                Form::Field(field) => hit_field(&field, ray, enter, options)?,
                Form::Convex(_) | Form::HalfSpace(_) => (hit_shape(part, ray, [enter, leave])?, None),
            };
            Some(Self { t, part: number, face })
        };
        let hits = (0..).zip(placed.in_world().parts()).filter_map(part_hit);
        hits.min_by(|one, other| one.t.total_cmp(&other.t))
    }

    /// Returns the unit normal of the body's surface at the hit, in the world frame, or `None` if
    /// the ray starts in the body or if the face has no area.
    pub(super) fn normal(&self, placed: &Placed, ray: &Ray) -> Option<[f64; 3]> {
        let part = placed.in_world().parts().get(self.part as usize)?;
        match (part.form(), self.face) {
            (Form::Surface(surface), Some(face)) => {
                face_normal(surface.mesh.face_normal(face)?, surface.pose, &ray.direction())
            }
            (Form::Field(field), Some(face)) => {
                let crop = field.mesh.crop(vec![face])?;
                face_normal(crop.mesh.face_normal(0)?, field.pose, &ray.direction())
            }
            _ if self.t == 0.0 => None,
            (Form::Surface(_) | Form::Field(_), None) => None,
            (Form::HalfSpace(half_space), _) => Some(half_space.unit_normal()),
            (Form::Convex(_), _) => {
                let outward = normal_toward(part, ray.at(self.t))?;
                // A shape without thickness has two sides. On others only rounding tilts the normal
                // of a grazed side along the ray.
                let along = dot(&outward, &normalized(&ray.direction())?);
                Some(if along > MAX_TILT { outward.map(|x| 0.0 - x) } else { outward.map(|x| x + 0.0) })
            }
        }
    }
}

/// Maximum cosine of an outward normal with the direction of the ray for a side that faces against
/// the ray: 2^-11, because normals of round shapes are within 2^-12.
const MAX_TILT: f64 = 1.0 / (1 << 11) as f64;

/// Returns the unit normal of a face in the world frame, given that in its own frame. It faces
/// against the direction; if the direction is in the plane of the face, it is on the front of the
/// face.
fn face_normal(local: [f64; 3], pose: &Pose, direction: &[f64; 3]) -> Option<[f64; 3]> {
    let [x, y, z] = pose.linear();
    // The rows of the cofactor matrix, which is the transposed inverse times the determinant.
    let rows = [cross(y, z), cross(z, x), cross(x, y)];
    let sign = if pose.mirrors() { -1.0 } else { 1.0 };
    let front = normalized(&rows.map(|row| sign * dot(&row, &local)))?;
    Some(if dot(&front, direction) > 0.0 { front.map(|x| 0.0 - x) } else { front.map(|x| x + 0.0) })
}

/// Returns the unit vector from a convex shape to a point on its surface.
fn normal_toward(shape: &PlacedShape, point: [f64; 3]) -> Option<[f64; 3]> {
    let point = Shape::point(point).and_then(|point| point.at(Pose::IDENTITY)).ok()?;
    let margin = query::distance(shape, &point).upper;
    let contacts = Query::new().with_contacts(ContactOptions { margin, most_points: 1 }).contacts(shape, &point);
    Some(contacts.first()?.normal)
}

/// Returns the first hit with a mesh. The ray is transformed to the mesh's frame, in which
/// parameters are the same. If the transformed ray is out of range, the hit is at the parameter at
/// which the ray enters the box.
fn hit_mesh(surface: &Surface<'_>, ray: &Ray, enter: f64, options: RayOptions) -> Option<(f64, Option<u32>)> {
    let &Surface { mesh, pose: world_from_mesh, is_solid } = surface;
    let inverse = Inverse::of(world_from_mesh);
    let origin = inverse.apply(sub(&ray.origin(), world_from_mesh.translation()));
    let Ok(local) = mesh::Ray::new(origin, inverse.apply(ray.direction())) else { return Some((enter, None)) };
    if is_solid && mesh.contains(&[origin]).is_ok_and(|found| found.iter().any(|found| found.is_contained())) {
        return Some((0.0, None));
    }
    let is_fronts_only = options.culls_back_faces && !is_solid;
    let hit = if is_fronts_only { mesh.ray_cast_fronts(&local) } else { mesh.ray_cast(&local) };
    hit.filter(|hit| hit.t <= ray.reach()).map(|hit| (hit.t, Some(hit.face)))
}

/// Returns the first hit with a height field, as [`hit_mesh`] does.
fn hit_field(
    field: &Surface<'_, HeightField>,
    ray: &Ray,
    enter: f64,
    options: RayOptions,
) -> Option<(f64, Option<u32>)> {
    let inverse = Inverse::of(field.pose);
    let origin = inverse.apply(sub(&ray.origin(), field.pose.translation()));
    let Ok(local) = mesh::Ray::new(origin, inverse.apply(ray.direction())) else { return Some((enter, None)) };
    let field = field.mesh;
    let hit = if options.culls_back_faces { field.ray_cast_fronts(&local) } else { field.ray_cast(&local) };
    hit.filter(|hit| hit.t <= ray.reach()).map(|hit| (hit.t, Some(hit.face)))
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
    let direction = ray.direction();
    let at = |t: f64| ray.at(t);
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
