//! Rays against worlds: the first body that a ray hits, or all of them.

use super::World;
use super::body::{BodyId, Traits};
use super::ray_hits::{FirstHit, RayOptions};
use crate::partition::Ray;

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
    /// Outward unit normal of the body's surface at the point, in the world frame. A mesh that is
    /// not solid and a flat shape have two sides: their normal is on the side that the ray comes
    /// from. `None` if the ray starts inside a shape or on it, and if the face has no area.
    ///
    /// # Accuracy
    /// The normal of a face, a half-space, a polytope, a sphere or a capsule is within 2^-36 of the
    /// exact one if the pose is rigid. That of another round shape is within 2^-12. At an edge or a
    /// corner of a convex shape the normal is that of one of the sides, or of a plane between
    /// them.
    pub normal: Option<[f64; 3]>,
    /// Index of the part that was hit; 0 if the body is not a compound. If the ray hits several
    /// parts at the same `t`, the first of them.
    pub part: u32,
    /// Index of the face that was hit, for meshes. `None` for other shapes, and if the ray starts
    /// inside a solid mesh.
    pub face: Option<u32>,
}

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
    pub fn ray_cast(&self, ray: &Ray, wanted: impl FnMut(&Traits) -> bool) -> Option<BodyRayHit> {
        self.ray_cast_with(ray, RayOptions::default(), wanted)
    }

    /// Returns the first body that a ray hits, as [`ray_cast`](Self::ray_cast) does, with options.
    ///
    /// ```
    /// use impinge::partition::Ray;
    /// use impinge::{Mesh, Positions, Shape, world::{Body, RayOptions, World}};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    /// let mut world = World::new();
    /// world.insert(Body::new(Shape::mesh(&Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?)))?;
    /// let from_above = Ray::new([1.0, 1.0, 3.0], [0.0, 0.0, -1.0], f64::INFINITY)?;
    /// let from_below = Ray::new([1.0, 1.0, -3.0], [0.0, 0.0, 1.0], f64::INFINITY)?;
    /// let normal = |ray, options| world.ray_cast_with(ray, options, |_| true).map(|hit| hit.normal);
    /// let culling = RayOptions { culls_back_faces: true };
    /// assert_eq!(normal(&from_above, culling), Some(Some([0.0, 0.0, 1.0])));
    /// assert_eq!(normal(&from_below, RayOptions::default()), Some(Some([0.0, 0.0, -1.0])));
    /// assert_eq!(normal(&from_below, culling), None);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    #[must_use]
    pub fn ray_cast_with(
        &self,
        ray: &Ray,
        options: RayOptions,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Option<BodyRayHit> {
        let mut best: Option<Found> = None;
        self.along(ray, options, &mut wanted, &mut |found| {
            if best.is_none_or(|best| found.is_before(&best)) {
                best = Some(found);
            }
            best.map_or(f64::INFINITY, |best| best.hit.t)
        });
        best.map(|best| self.hit_of(ray, &best))
    }

    /// Returns every body that a ray in the world frame hits within its reach, out of the bodies
    /// for which `wanted` returns `true`, each with its first hit. The hits are sorted by `t`, then
    /// by tag and handle. Undecided hits are treated as in [`ray_cast`](Self::ray_cast).
    #[must_use]
    pub fn ray_cast_all(&self, ray: &Ray, wanted: impl FnMut(&Traits) -> bool) -> Vec<BodyRayHit> {
        self.ray_cast_all_with(ray, RayOptions::default(), wanted)
    }

    /// Returns every body that a ray hits, as [`ray_cast_all`](Self::ray_cast_all) does, with
    /// options.
    #[must_use]
    pub fn ray_cast_all_with(
        &self,
        ray: &Ray,
        options: RayOptions,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Vec<BodyRayHit> {
        let mut hits = Vec::new();
        self.along(ray, options, &mut wanted, &mut |found| {
            hits.push(self.hit_of(ray, &found));
            f64::INFINITY
        });
        hits.sort_by(|one, other| one.t.total_cmp(&other.t).then((one.tag, one.body).cmp(&(other.tag, other.body))));
        hits
    }

    /// Calls `report` for hits, in no particular order, that are no farther than the parameter that
    /// `report` last returned.
    fn along(
        &self,
        ray: &Ray,
        options: RayOptions,
        wanted: &mut dyn FnMut(&Traits) -> bool,
        report: &mut dyn FnMut(Found) -> f64,
    ) {
        let mut reach = ray.reach();
        let mut look = |place: u32| {
            if let Some((body, resident)) = self.state.residents.at(place)
                && wanted(&resident.traits)
                && let Some(hit) = FirstHit::of(&resident.placed, self.state.bounds_of(place), ray, options)
                && hit.t <= reach
            {
                reach = reach.min(report(Found { hit, tag: resident.traits.tag, body }));
            }
            reach
        };
        self.state.broad.along(ray, &mut look);
    }

    /// Returns a hit with its point and its normal.
    fn hit_of(&self, ray: &Ray, found: &Found) -> BodyRayHit {
        let &Found { hit, tag, body } = found;
        let normal = self.state.residents.get(body).and_then(|resident| hit.normal(&resident.placed, ray));
        BodyRayHit { t: hit.t, tag, body, point: ray.at(hit.t), normal, part: hit.part, face: hit.face }
    }
}

/// A body that a ray hits.
#[derive(Clone, Copy, Debug)]
struct Found {
    hit: FirstHit,
    tag: u64,
    body: BodyId,
}

impl Found {
    fn is_before(&self, other: &Self) -> bool {
        self.hit.t < other.hit.t || self.hit.t == other.hit.t && (self.tag, self.body) < (other.tag, other.body)
    }
}
