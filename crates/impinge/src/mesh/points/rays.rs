//! Rays against a mesh: the first face that a ray intersects, any face, or all faces.
//!
//! Source: Ize, *Robust BVH ray traversal*, JCGT 2(2), 2013, for boxes that a ray never misses by
//! rounding. Ours departs in that rays are moved along themselves to near the mesh, and boxes are
//! grown by a bound of all rounding errors. Whether a ray intersects a triangle, and which of two
//! triangles it intersects first, is decided exactly (see `primitive::ray_triangle`). So no ray
//! passes between two faces that share an edge or a corner (docs/notes/proof.md, L15).
//!
//! Guarded by `tests/it/distance/rays.rs` and by the benchmark `rays` of `impinge-bench`.

use std::cmp::Ordering;
use std::ops::ControlFlow::{self, Break, Continue};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use rayon::prelude::*;

use super::ray_packet::Line;
use crate::hierarchy::{Child, HALF_ULP, Node};
use crate::input::{InputError, InputErrorKind};
use crate::math::Sign;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{Vector, dot, sub};
use crate::mesh::Mesh;
use crate::mesh::storage::frame::reciprocal_power_of_two;
use crate::primitive::{RayCrossing, ray_triangle, side_along};
use crate::simd::{self, LANES, bits, by_axis, dispatch, load, prefetch};

/// A ray: the points `origin + t direction` with `t` zero or more, in a mesh's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: [f64; 3],
    direction: [f64; 3],
}

impl Ray {
    /// Creates the ray from `origin` in `direction`, both in a mesh's own frame. The direction need
    /// not have unit length.
    ///
    /// # Errors
    /// Returns an error if a number is not finite or above 2^300 in magnitude, or if the direction
    /// is zero.
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Result<Self, InputError> {
        InputError::validate_row(&origin, "ray origin", 0)?;
        InputError::validate_row(&direction, "ray direction", 0)?;
        if direction == [0.0; 3] {
            return Err(InputError::new(InputErrorKind::ZeroDirection { index: 0 }));
        }
        Ok(Self { origin, direction })
    }

    /// Returns the point at which the ray starts, in the mesh's own frame.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the direction of the ray as given, in the mesh's own frame.
    #[must_use]
    pub fn direction(&self) -> [f64; 3] {
        self.direction
    }

    /// Returns the same ray with a scaled direction, and the factor that turns the returned ray's
    /// parameters into this ray's parameters. All components of the new direction are below 2 in
    /// magnitude. The largest is at least 1, unless this ray's direction is below the least normal
    /// number.
    pub(crate) fn of_unit_size(&self) -> (Self, f64) {
        let largest = self.direction.iter().fold(f64::MIN_POSITIVE, |most, x| x.abs().max(most));
        // The factor is the reciprocal of a power of two from 2^-1022 to 2^300.
        let exponent = (largest.to_bits() >> 52) as i64 - 1023;
        let reciprocal = f64::from_bits(((1023 - exponent) as u64) << 52);
        (Self { origin: self.origin, direction: self.direction.map(|x| x * reciprocal) }, reciprocal)
    }

    /// Returns the point at the parameter `t`, in the mesh's own frame, rounded.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + t * self.direction[k])
    }
}

/// The intersection of a ray with a face of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Parameter of the hit: its distance from the origin, divided by the length of the direction.
    /// Its relative error is at most 2^-40, and it is zero if the true parameter is zero.
    pub t: f64,
    /// Index of the face. If the ray intersects several faces in one point, the first of them.
    pub face: u32,
    /// The point of the hit, in the mesh's own frame, rounded.
    pub point: [f64; 3],
}

impl Mesh {
    /// Returns the first face that a ray intersects, decided exactly, or `None`. The ray's origin
    /// belongs to the ray.
    ///
    /// ```
    /// use impinge::mesh::Ray;
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(Positions::F32(corners), vec![[2, 1, 3], [0, 1, 2]])?;
    /// let hit = mesh.ray_cast(&Ray::new([0.5, 0.5, 3.0], [0.0, 0.0, -1.0])?).expect("through the shared edge");
    /// assert_eq!((hit.t, hit.face), (3.0, 0));
    /// assert!(mesh.ray_cast(&Ray::new([2.0, 2.0, 3.0], [0.0, 0.0, -1.0])?).is_none());
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// Faces are closed, so their edges and corners count. A face counts from both sides, and a
    /// triangle without area counts too. A ray within the plane of a face intersects the face in
    /// the first point that they share.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<RayHit> {
        self.first_hit(ray, false, &mut stack())
    }

    /// Returns the first face that a ray intersects and whose front faces against the ray, decided
    /// exactly. The front of a face is the side from which its corners are in counterclockwise
    /// order. Faces in whose plane the ray lies, and faces without area, do not count.
    pub(crate) fn ray_cast_fronts(&self, ray: &Ray) -> Option<RayHit> {
        self.first_hit(ray, true, &mut stack())
    }

    fn first_hit(&self, ray: &Ray, is_fronts_only: bool, stack: &mut Vec<Task>) -> Option<RayHit> {
        let mut first = First { mesh: self, ray, is_fronts_only, best: None };
        self.cast(ray, stack, &mut first);
        first.best.map(|(face, crossing)| RayHit { t: crossing.t, face, point: ray.at(crossing.t) })
    }

    /// Reports whether a ray, given in the mesh's own frame, intersects the surface of the mesh.
    /// Exact.
    #[must_use]
    pub fn ray_cast_any(&self, ray: &Ray) -> bool {
        let mut any = Any { mesh: self, ray, is_hit: false };
        self.cast(ray, &mut stack(), &mut any);
        any.is_hit
    }

    /// Returns every face that a ray intersects, decided exactly. Hits are sorted by their true
    /// parameter on the ray, then by face index.
    #[must_use]
    pub fn ray_cast_all(&self, ray: &Ray) -> Vec<RayHit> {
        self.all_hits(ray, &mut stack())
    }

    fn all_hits(&self, ray: &Ray, stack: &mut Vec<Task>) -> Vec<RayHit> {
        let mut all = All { mesh: self, ray, hits: Vec::new() };
        self.cast(ray, stack, &mut all);
        let mut hits = all.hits;
        hits.sort_by(|one, other| order(self, ray, *one, *other));
        hits.into_iter().map(|(face, crossing)| RayHit { t: crossing.t, face, point: ray.at(crossing.t) }).collect()
    }

    /// Returns the [`ray_cast`](Self::ray_cast) of each ray, computed on all cores of the current
    /// rayon pool.
    #[must_use]
    pub fn ray_casts(&self, rays: &[Ray]) -> Vec<Option<RayHit>> {
        self.for_each_ray(rays, |ray, stack| self.first_hit(ray, false, stack))
    }

    /// Returns the [`ray_cast_all`](Self::ray_cast_all) of each ray, computed on all cores of the
    /// current rayon pool.
    #[must_use]
    pub fn ray_casts_all(&self, rays: &[Ray]) -> Vec<Vec<RayHit>> {
        self.for_each_ray(rays, |ray, stack| self.all_hits(ray, stack))
    }

    fn for_each_ray<T: Send>(&self, rays: &[Ray], cast: impl Fn(&Ray, &mut Vec<Task>) -> T + Sync) -> Vec<T> {
        rays.par_iter().with_min_len(MIN_RAYS_PER_TASK).map_init(stack, |stack, ray| cast(ray, stack)).collect()
    }

    #[inline(never)]
    fn cast<V: Visitor>(&self, ray: &Ray, stack: &mut Vec<Task>, visitor: &mut V) {
        if !self.0.tree.nodes().is_empty() {
            let moved = MovedRay::new(self, ray);
            let _ = dispatch!(simd::best_level(), simd => descend(simd, self, &moved, stack, visitor));
        }
    }
}

/// Minimum number of rays per parallel task. Fewer rays cost less than handing them to another
/// thread.
const MIN_RAYS_PER_TASK: usize = 256;

/// A face, and its intersection with a ray.
pub(in crate::mesh) type FaceCrossing = (u32, RayCrossing);

/// Compares two intersections of a ray by their true parameters, then by face.
pub(in crate::mesh) fn order(mesh: &Mesh, ray: &Ray, one: FaceCrossing, other: FaceCrossing) -> Ordering {
    let triangles = [mesh.corners(one.0), mesh.corners(other.0)];
    one.1.compare(&other.1, (&ray.origin, &ray.direction), triangles.each_ref()).then(one.0.cmp(&other.0))
}

/// Processes the faces that a ray may intersect.
trait Visitor {
    /// Processes some faces. Returns the parameter above which faces are skipped, or `Break` if the
    /// query is answered.
    fn process(&mut self, faces: impl Iterator<Item = u32>) -> ControlFlow<(), f64>;
}

fn crossing(mesh: &Mesh, ray: &Ray, face: u32) -> Option<FaceCrossing> {
    Some((face, ray_triangle(&ray.origin, &ray.direction, &mesh.corners(face))?))
}

struct First<'m> {
    mesh: &'m Mesh,
    ray: &'m Ray,
    /// Whether only faces count whose front faces against the ray.
    is_fronts_only: bool,
    best: Option<FaceCrossing>,
}

impl Visitor for First<'_> {
    fn process(&mut self, faces: impl Iterator<Item = u32>) -> ControlFlow<(), f64> {
        for hit in faces.filter_map(|face| crossing(self.mesh, self.ray, face)) {
            let is_front = || side_along(&self.ray.direction, &self.mesh.corners(hit.0)) == Sign::Negative;
            if self.best.is_none_or(|best| order(self.mesh, self.ray, hit, best) == Ordering::Less)
                && (!self.is_fronts_only || is_front())
            {
                self.best = Some(hit);
            }
        }
        Continue(self.best.map_or(f64::INFINITY, |(_, crossing)| crossing.t + crossing.error))
    }
}

struct Any<'m> {
    mesh: &'m Mesh,
    ray: &'m Ray,
    is_hit: bool,
}

impl Visitor for Any<'_> {
    fn process(&mut self, mut faces: impl Iterator<Item = u32>) -> ControlFlow<(), f64> {
        self.is_hit = faces.any(|face| crossing(self.mesh, self.ray, face).is_some());
        if self.is_hit { Break(()) } else { Continue(f64::INFINITY) }
    }
}

struct All<'m> {
    mesh: &'m Mesh,
    ray: &'m Ray,
    hits: Vec<FaceCrossing>,
}

impl Visitor for All<'_> {
    fn process(&mut self, faces: impl Iterator<Item = u32>) -> ControlFlow<(), f64> {
        self.hits.extend(faces.filter_map(|face| crossing(self.mesh, self.ray, face)));
        Continue(f64::INFINITY)
    }
}

/// A ray in the packed frame in single precision, from a point near the mesh.
struct MovedRay {
    line: Line,
    /// The origin minus the slack and plus the slack. Maximum planes of boxes are compared with the
    /// first, and minimum planes with the second.
    origin: [[f32; 3]; 2],
    /// Reciprocals of the direction's components, all finite. The largest component is between 1/2
    /// and 1.
    inverse: [f32; 3],
    /// Length by which boxes are grown, in packed units.
    slack: f32,
    /// Packed parameters are `given · per_given - moved`, for a given parameter of the original
    /// ray.
    per_given: f64,
    /// Packed parameter by which the ray was moved.
    moved: f64,
}

impl MovedRay {
    /// Moves a ray to the mesh.
    ///
    /// # Accuracy
    /// A plane at x is passed at `(x ± slack - origin) · inverse`, rounded five times. The slack
    /// pays for that with 16 units of 2^-24 of the multiplied number, of which 5 are needed, and
    /// for the error of the origin. A component of the direction below 2^-60 is replaced by 2^-60.
    /// That moves the ray by less than the slack as long as it is near the mesh.
    fn new(mesh: &Mesh, ray: &Ray) -> Self {
        const LEAST: f64 = 1.0 / (1_u64 << 60) as f64;
        let frame = &mesh.0.frame;
        let largest = ray.direction.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Two factors, because one power of two does not scale up the smallest numbers.
        let units =
            [reciprocal_power_of_two(largest), reciprocal_power_of_two(largest * reciprocal_power_of_two(largest))];
        let direction = ray.direction.map(|x| x * units[0] * units[1]);
        let from = sub(&ray.origin, &frame.origin).map(|x| x * frame.scale);
        let far = from.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // The ray is moved to the point at which it passes the mesh's center, less a few units so
        // that it starts before the mesh.
        let moved =
            if far > 4.0 { (-dot(&from, &direction) / dot(&direction, &direction) - 4.0).max(0.0) } else { 0.0 };
        let origin: Vector = std::array::from_fn(|k| from[k] + moved * direction[k]);
        let reach = origin.iter().fold(4.0_f64, |most, x| most.max(x.abs()));
        let error = 16.0 * UNIT_ROUNDOFF * (far + moved);
        let slack = 16.0 * HALF_ULP * (reach + 4.0) + error;
        Self {
            line: Line::new(origin, direction, error),
            origin: [origin.map(|x| (x - slack) as f32), origin.map(|x| (x + slack) as f32)],
            inverse: direction.map(|x| (1.0 / if x.abs() < LEAST { LEAST.copysign(x) } else { x }) as f32),
            slack: (slack as f32).next_up(),
            per_given: frame.scale / units[0] / units[1],
            moved,
        }
    }

    /// Returns an upper bound of the packed parameter for a given parameter.
    fn parameter(&self, given: f64) -> f32 {
        let exact = given * self.per_given;
        let doubt = (exact + self.moved) * 1e-6;
        ((exact - self.moved + doubt) as f32).next_up()
    }

    /// Returns the children of a node that the ray may intersect before the packed parameter
    /// `last`, as bits, and the parameters at which it enters their boxes.
    #[inline(always)]
    fn enter<S: Simd>(&self, simd: S, node: &Node, last: f32) -> (u32, [f32; LANES]) {
        let planes: [[f32x8<S>; 2]; 3] = by_axis!(axis => {
            let (low, high) = ((&node.min[axis], self.origin[1][axis]), (&node.max[axis], self.origin[0][axis]));
            let (near, far) = if self.inverse[axis] < 0.0 { (high, low) } else { (low, high) };
            let inverse = f32x8::splat(simd, self.inverse[axis]);
            [
                (load(simd, near.0) - f32x8::splat(simd, near.1)) * inverse,
                (load(simd, far.0) - f32x8::splat(simd, far.1)) * inverse,
            ]
        });
        let enter = planes[0][0].max(planes[1][0]).max(planes[2][0]);
        let leave = planes[0][1].min(planes[1][1]).min(planes[2][1]);
        // A ray that starts in the mesh starts at zero. Other rays were moved to a point before the
        // mesh.
        let misses = enter.simd_gt(leave)
            | leave.simd_lt(f32x8::splat(simd, -self.slack))
            | enter.simd_gt(f32x8::splat(simd, last));
        let mut entered = [0.0; LANES];
        enter.store_slice(&mut entered);
        (!(misses.to_bitmask() as u32) & ((1 << node.count()) - 1), entered)
    }
}

/// Passes the faces that the ray may intersect to the visitor, leaf by leaf, the nearest leaf
/// first. `tasks` is working memory.
#[inline(always)]
fn descend<S: Simd>(
    simd: S,
    mesh: &Mesh,
    ray: &MovedRay,
    tasks: &mut Vec<Task>,
    visitor: &mut impl Visitor,
) -> ControlFlow<()> {
    let (nodes, packets) = (mesh.0.tree.nodes(), mesh.packets());
    let mut last = f32::INFINITY;
    tasks.clear();
    tasks.push((f32::NEG_INFINITY, Child::Inner(0)));
    while let Some((entered, child)) = tasks.pop() {
        if entered > last {
            continue;
        }
        match child {
            Child::Leaf(leaf) => {
                let packet = packets.get(simd, leaf);
                let may_intersect = ray.line.may_intersect(simd, &packet);
                if may_intersect != 0 {
                    last = ray.parameter(visitor.process(bits(may_intersect).map(|lane| packet.leaf.faces[lane]))?);
                }
            }
            Child::Inner(node) => {
                let node = &nodes[node as usize];
                let (entered_lanes, entered) = ray.enter(simd, node, last);
                let start = tasks.len();
                for lane in bits(entered_lanes) {
                    let child = node.child(lane);
                    match child {
                        Child::Inner(node) => prefetch(&nodes[node as usize]),
                        Child::Leaf(leaf) => {
                            packets.prefetch_leaf(leaf);
                            packets.prefetch(leaf);
                        }
                    }
                    tasks.push((entered[lane], child));
                    let mut at = tasks.len() - 1;
                    while at > start && tasks[at - 1].0 < tasks[at].0 {
                        tasks.swap(at - 1, at);
                        at -= 1;
                    }
                }
            }
        }
    }
    Continue(())
}

/// A node or leaf still to be visited, and the packed parameter at which the ray enters its box.
type Task = (f32, Child);

/// Returns an empty stack with room for eight levels of eight children, which few trees exceed.
fn stack() -> Vec<Task> {
    Vec::with_capacity(64)
}
