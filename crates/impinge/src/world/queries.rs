//! Queries to a world between steps: the bodies in a box, at a point, or intersecting a shape or
//! near it.

use rayon::prelude::*;

use super::body::{BodyId, Traits};
use super::broad::Among;
use super::outline::{Bounds, Extremes, Outline};
use super::placed::Placed;
use super::{Resident, World};
use crate::input::InputError;
use crate::math::Pose;
use crate::query;
use crate::shape::Shape;
use crate::volume::MinMax;

/// A body that a query of a [`World`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyHit {
    /// Tag of the body. Hits are sorted by tags, then by handles.
    pub tag: u64,
    /// Handle of the body.
    pub body: BodyId,
}

impl World {
    /// Returns the bodies whose boxes overlap a box in the world frame, and the half-spaces that
    /// may reach into it. They are sorted by tag, then by handle. Touching boxes overlap. Only
    /// bodies for which `wanted` returns `true` are considered.
    ///
    /// Queries see bodies at their current poses: as inserted, as moved by the last step, or as set
    /// since then.
    #[must_use]
    pub fn overlapping_boxes(&self, bounds: &MinMax, mut wanted: impl FnMut(&Traits) -> bool) -> Vec<BodyHit> {
        let mut found = self.near(&Bounds::Box(*bounds));
        found.retain(|&(_, resident)| wanted(&resident.traits));
        hits(found.into_iter())
    }

    /// Returns the bodies that intersect a shape at a pose, sorted by tag, then by handle. The pose
    /// maps the shape's frame to the world frame. Undecided bodies are included, as with
    /// [`intersects`](crate::query::intersects()). Only bodies for which `wanted` returns `true`
    /// are considered.
    ///
    /// ```
    /// use impinge::{Pose, shape::Shape, world::{Body, Layers, World}};
    ///
    /// let mut world = World::new();
    /// let sphere = world.insert(Body::new(Shape::sphere([0.0; 3], 1.0)?))?;
    /// let probe = Shape::capsule([0.0; 3], [0.0, 0.0, 3.0], 0.25)?;
    /// let found = world.overlapping(&probe, Pose::from_translation([0.0, 0.0, 1.0])?, |traits| traits.layers.on & 1 != 0)?;
    /// assert_eq!(found[0].body, sphere);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the shape cannot be placed at the pose.
    pub fn overlapping(
        &self,
        shape: &Shape,
        world_from_shape: Pose,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Result<Vec<BodyHit>, InputError> {
        let placed = Placed::new(shape, world_from_shape)?;
        let bounds = Outline::new().bounds(placed.stands(), &mut Extremes::default());
        let mut near = self.near(&bounds);
        near.retain(|&(_, resident)| wanted(&resident.traits));
        let found: Vec<(BodyId, &Resident)> = near
            .into_par_iter()
            .filter(|(_, resident)| query::intersects(placed.in_world(), resident.placed.in_world()))
            .collect();
        Ok(hits(found.into_iter()))
    }

    /// Returns the bodies whose distance from a shape at a pose is at most `clearance`, in world
    /// units, sorted by tag, then by handle. The pose maps the shape's frame to the world frame.
    /// The decision is that of [`within`](crate::query::within()): exact for meshes, polytopes
    /// and half-spaces, and undecided bodies are included. Only bodies for which `wanted`
    /// returns `true` are considered. The list is empty if `clearance` is negative or NaN.
    ///
    /// ```
    /// use impinge::{Pose, shape::Shape, world::{Body, World}};
    ///
    /// let mut world = World::new();
    /// let crate_ = world.insert(Body::new(Shape::cuboid([1.0; 3])?))?;
    /// let speck = Shape::point([3.0, 0.0, 0.0])?;
    /// assert_eq!(world.within(&speck, Pose::IDENTITY, 2.0, |_| true)?[0].body, crate_);
    /// assert!(world.within(&speck, Pose::IDENTITY, 2.0_f64.next_down(), |_| true)?.is_empty());
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the shape cannot be placed at the pose.
    pub fn within(
        &self,
        shape: &Shape,
        world_from_shape: Pose,
        clearance: f64,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Result<Vec<BodyHit>, InputError> {
        let placed = Placed::new(shape, world_from_shape)?;
        if clearance.is_nan() || clearance < 0.0 {
            return Ok(Vec::new());
        }
        let mut near = self.near(&Outline::new().bounds(placed.stands(), &mut Extremes::default()).grown(clearance));
        near.retain(|&(_, resident)| wanted(&resident.traits));
        let found: Vec<(BodyId, &Resident)> = near
            .into_par_iter()
            .filter(|(_, resident)| query::within(placed.in_world(), resident.placed.in_world(), clearance))
            .collect();
        Ok(hits(found.into_iter()))
    }

    /// Returns the bodies that contain a point of the world frame, sorted by tag, then by handle.
    /// Undecided bodies are included, as with [`overlapping`](Self::overlapping). Only bodies for
    /// which `wanted` returns `true` are considered. A mesh that is not solid contains only the
    /// points of its surface.
    ///
    /// # Errors
    /// Returns an error if a coordinate is not finite, or is 2^128 or more in magnitude.
    pub fn at_point(&self, point: [f64; 3], wanted: impl FnMut(&Traits) -> bool) -> Result<Vec<BodyHit>, InputError> {
        self.overlapping(&Shape::point(point)?, Pose::IDENTITY, wanted)
    }

    /// Returns the bodies whose bounds overlap `bounds`.
    pub(super) fn near(&self, bounds: &Bounds) -> Vec<(BodyId, &Resident)> {
        let state = &self.state;
        let mut found = Vec::new();
        let mut look = |index: u32| {
            if state.bounds_of(index).overlap(bounds) {
                found.extend(state.residents.at(index));
            }
        };
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => {
                state.broad.for_each_overlapping(Among::All, bounds, &mut look);
                state.broad.for_each_unbounded(Among::All, &mut look);
            }
            Bounds::Behind(_) | Bounds::Anywhere => state.residents.iter().for_each(|(id, _)| look(id.index() as u32)),
        }
        found
    }
}

fn hits<'w>(found: impl Iterator<Item = (BodyId, &'w Resident)>) -> Vec<BodyHit> {
    let mut hits: Vec<BodyHit> = found.map(|(body, resident)| BodyHit { tag: resident.traits.tag, body }).collect();
    hits.sort_unstable();
    hits
}
