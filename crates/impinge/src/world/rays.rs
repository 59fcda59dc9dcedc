//! Rays against worlds: the first body that a ray meets, or all of them.

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

/// Where a ray meets a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRayHit {
    /// In units of the direction's length; zero where the ray starts in a shape or a solid mesh.
    ///
    /// # Accuracy
    /// For meshes within 2^-40 of itself of where the ray, carried into the mesh's frame and rounded there, meets the first face. For
    /// shapes as near as they can be told apart from it, 2^-36 of the sizes, of a cone 2^-23, over the cosine of the angle at which they
    /// are met.
    pub t: f64,
    /// The body's tag.
    pub tag: u64,
    /// The body.
    pub body: BodyId,
    /// The point, in the world frame, rounded.
    pub point: [f64; 3],
    /// The face of a mesh; none where the ray starts inside a solid one.
    pub face: Option<u32>,
}

/// Distances that a ray is advanced by, at most. Flat sides take one, a ball some five, a needle that is grazed many.
const MOST_STEPS: usize = 64;

/// Nearer than this share of the coordinates is there.
const ARRIVED: f64 = 1.0 / (1_u64 << 42) as f64;

impl World {
    /// The first body that a ray meets of those that are `wanted`; of several in one place the one with the least tag, then
    /// handle.
    ///
    /// ```
    /// use impinge::partition::Ray;
    /// use impinge::{Pose, shape::Shape, world::{Body, World}};
    ///
    /// let mut world = World::new();
    /// let ball = Body::new(Shape::sphere([0.0; 3], 1.0)?);
    /// let near = world.insert(ball.clone().at(Pose::from_translation([5.0, 0.0, 0.0])?))?;
    /// world.insert(ball.at(Pose::from_translation([9.0, 0.0, 0.0])?))?;
    /// let ray = Ray::new([0.0; 3], [2.0, 0.0, 0.0], f64::INFINITY)?;
    /// let hit = world.ray_cast(&ray, |_| true).expect("the near ball");
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

    /// Every body that a ray meets of those that are `wanted`, each where it does first, in this order.
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

    /// Shows the hits that are no farther than what `meet` last returned, in no order.
    fn along(&self, ray: &Ray, wanted: &mut dyn FnMut(&Traits) -> bool, meet: &mut dyn FnMut(BodyRayHit) -> f64) {
        let mut reach = ray.reach();
        let mut look = |index: u32| {
            if let Some((body, resident)) = self.state.residents.at(index)
                && wanted(&resident.traits)
                && let Some((t, face)) = meets(&resident.placed, self.state.bounds_of(index), ray)
                && t <= reach
            {
                let (from, direction) = (ray.origin(), ray.direction());
                let point = std::array::from_fn(|k| from[k] + t * direction[k]);
                reach = reach.min(meet(BodyRayHit { t, tag: resident.traits.tag, body, point, face }));
            }
            reach
        };
        self.state.unbounded.iter().for_each(|&index| _ = look(index));
        self.state.broad.along(ray, &mut look);
    }
}

fn is_before(one: &BodyRayHit, other: &BodyRayHit) -> bool {
    one.t < other.t || one.t == other.t && (one.tag, one.body) < (other.tag, other.body)
}

/// Where a ray first meets a body, and on which face.
fn meets(placed: &Placed, bounds: &Bounds, ray: &Ray) -> Option<(f64, Option<u32>)> {
    let [enter, leave] = match bounds {
        Bounds::Nowhere => return None,
        Bounds::Box(bounds) => ray.through(bounds)?,
        Bounds::Behind(_) | Bounds::Anywhere => [0.0, f64::MAX],
    };
    if enter > ray.reach() {
        return None;
    }
    let meets = |part: &PlacedShape| match part.form() {
        Form::Surface(surface) => meets_mesh(&surface, ray, enter),
        Form::Convex(_) | Form::HalfSpace(_) => Some((meets_shape(part, ray, [enter, leave])?, None)),
    };
    let parts = placed.in_world().parts().iter().filter_map(meets);
    parts.min_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)))
}

/// The ray is carried into the mesh's frame, where parameters are the same. What floats cannot carry counts as met where the ray
/// enters the box.
fn meets_mesh(surface: &Surface<'_>, ray: &Ray, enter: f64) -> Option<(f64, Option<u32>)> {
    let &Surface { mesh, pose: world_from_mesh, is_solid } = surface;
    let inverse = Inverse::of(world_from_mesh);
    let origin = inverse.apply(sub(&ray.origin(), world_from_mesh.translation()));
    let Ok(local) = mesh::Ray::new(origin, inverse.apply(ray.direction())) else { return Some((enter, None)) };
    if is_solid && mesh.contains(&[origin]).is_ok_and(|found| found.iter().any(|found| found.is_contained())) {
        return Some((0.0, None));
    }
    mesh.ray_cast(&local).filter(|hit| hit.t <= ray.reach()).map(|hit| (hit.t, Some(hit.face)))
}

/// The inverse of a linear map, rounded.
struct Inverse([[f64; 3]; 3]);

impl Inverse {
    fn of(pose: &Pose) -> Self {
        let [x, y, z] = pose.linear();
        // The columns of the inverse are cross products of the rows, over the determinant.
        let columns = [cross(y, z), cross(z, x), cross(x, y)];
        let determinant = dot(&columns[0], x);
        Self(std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row] / determinant)))
    }

    fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| dot(&row, &v))
    }
}

/// By conservative advancement: the nearest points of the shape and the ray's front are those of a plane that keeps the shape
/// on its far side, so that the front can go on to the plane. What the ray may meet lies between `enter` and `leave`.
///
/// Source: van den Bergen, *Ray casting against general convex objects with application to continuous collision detection*,
/// 2004; ours asks for the distance anew at each front, and leans the plane by as much as the nearest points may be off.
/// Whether the ray meets the shape at all is decided as for a segment; what that leaves open, by whether a front gets past.
fn meets_shape(shape: &PlacedShape, ray: &Ray, [enter, leave]: [f64; 2]) -> Option<f64> {
    let (origin, direction) = (ray.origin(), ray.direction());
    let at = |t: f64| -> [f64; 3] { std::array::from_fn(|k| origin[k] + t * direction[k]) };
    let steepest = direction.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Beyond this the coordinates of a segment are out of range.
    const FAR: f64 = (1_u128 << 126) as f64;
    let leave = leave.min(FAR / steepest);
    let begun = beginning(ray, leave);
    let proximity = begun.as_ref().map_or(Proximity::Undecided, |begun| query::proximity(begun, shape));
    if proximity == Proximity::Apart {
        return None;
    }
    let end = leave.min(ray.reach());
    let (mut t, mut least) = (enter, 0.0);
    for _ in 0..MOST_STEPS {
        let front = at(t);
        let Ok(point) = Shape::point(front).and_then(|point| point.at(Pose::IDENTITY)) else { break };
        let found = query::distance(&point, shape);
        let [point_a, point_b] = found.points().unwrap_or([front; 2]);
        let size = front.iter().chain(&point_b).fold(0.0_f64, |size, x| size.max(x.abs()));
        least = ARRIVED * size / steepest;
        if found.proximity == Proximity::Meets || found.upper <= ARRIVED * size {
            return Some(t);
        }
        if found.proximity == Proximity::Undecided {
            break;
        }
        let gap = sub(&point_b, &point_a);
        // The normal of the true plane is off by an angle whose cosine is at least `lower / upper`: seen from the nearest point
        // of a convex set, the front and any other of its points are not at an acute angle.
        let askew = (2.0 * (1.0 - found.lower / found.upper)).max(0.0).sqrt() * length(&direction);
        let closing = dot(&gap, &direction) / length(&gap) + askew;
        let next = t + found.lower / closing;
        if !(closing > 0.0 && next <= end) {
            // It gets past; where it is known to meet the shape, it is there, to within rounding.
            return (proximity == Proximity::Meets).then_some(t);
        }
        if next <= t {
            break;
        }
        t = next;
    }
    // What is grazed is grazed where the ray is nearest to it: pieces of the ray, being rounded, may all get past.
    let nearest = begun.and_then(|begun| query::distance(&begun, shape).points());
    let end = nearest.map_or(end, |[point, _]| parameter_of(&point, ray).clamp(t, end.max(t)));
    Some(creep(shape, at, [t, end], least))
}

/// The ray itself, and no rounded one, as far as a parameter or farther, up to its reach: along the direction times a power of two, which
/// is no rounding, from where it is moved to. So a corner that it touches is touched. None where the origin is beyond what poses take.
fn beginning(ray: &Ray, parameter: f64) -> Option<PlacedShape> {
    let exponent = parameter.max(f64::MIN_POSITIVE).to_bits() >> 52;
    let length = f64::from_bits((exponent + 1) << 52).min(ray.reach());
    let segment = Shape::segment([[0.0; 3], ray.direction().map(|x| x * length)]).ok()?;
    segment.at(Pose::from_translation(ray.origin()).ok()?).ok()
}

/// Where on the ray a point of it is.
fn parameter_of(point: &[f64; 3], ray: &Ray) -> f64 {
    let steepest = ray.direction().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let [from_origin, unit] = [sub(point, &ray.origin()), ray.direction()].map(|v| v.map(|x| x / steepest));
    dot(&from_origin, &unit) / dot(&unit, &unit)
}

/// The last front up to which a ray is proved not to meet the shape, to within the `least` step: how it goes on where the distance is
/// known too badly to go by it. Segments of the ray are longer and longer until one is not proved apart, then shorter.
fn creep(shape: &PlacedShape, at: impl Fn(f64) -> [f64; 3], [mut t, end]: [f64; 2], least: f64) -> f64 {
    let (mut step, mut is_shortened) = (least, false);
    for _ in 0..MOST_STEPS {
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
