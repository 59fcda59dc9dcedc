//! Distances between a shape and the bodies of a world, and of two bodies.
//!
//! Boxes bound distances from below. The search asks the broad phase for the bodies in a box around
//! the shape, which grows until no body outside can be nearer than the nearest one inside.
//!
//! Guarded by `tests/it/worlds/nearest.rs`.

use std::collections::HashSet;

use super::body::{BodyId, Traits};
use super::error::WorldError;
use super::outline::{Bounds, Extremes, Outline};
use super::placed::Placed;
use super::{Resident, World};
use crate::input::InputError;
use crate::math::Pose;
use crate::math::vec3::scaled_length;
use crate::query::{self, Distance};
use crate::shape::Shape;
use crate::volume::MinMax;

/// The distance of a body of a [`World`] from a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyDistance {
    /// Tag of the body.
    pub tag: u64,
    /// Handle of the body.
    pub body: BodyId,
    /// Distance of the shape, which is the first thing, and the body, which is the second.
    pub distance: Distance,
}

/// First size of the searched region, relative to a region that is known to hold a body: 2^-20. A
/// larger one finds more bodies than necessary in large worlds; a smaller one takes more searches.
const FIRST_REACH: f64 = 1.0 / (1 << 20) as f64;

/// Growth of the searched region from one search to the next. Smaller numbers find fewer bodies
/// that are not the nearest, and take more searches.
const GROWTH: f64 = 4.0;

impl World {
    /// Returns the body that is nearest to a shape at a pose, out of the bodies for which `wanted`
    /// returns `true`, with its distance in world units. The pose maps the shape's frame to the
    /// world frame. Returns `None` if no such body is within `limit`, which may be infinite.
    ///
    /// The nearest body is the one with the smallest [`upper`](Distance::upper) bound, then tag,
    /// then handle, out of the bodies whose [`lower`](Distance::lower) bound is at most `limit`. Its
    /// distance is that of [`query::distance`](crate::query::distance()): zero for all bodies that
    /// intersect the shape.
    ///
    /// ```
    /// use impinge::{Pose, shape::Shape, world::{Body, World}};
    ///
    /// let mut world = World::new();
    /// let sphere = Body::new(Shape::sphere([0.0; 3], 1.0)?);
    /// let near = world.insert(sphere.clone().at(Pose::from_translation([4.0, 0.0, 0.0])?))?;
    /// world.insert(sphere.at(Pose::from_translation([-5.0, 0.0, 0.0])?))?;
    /// let probe = Shape::point([0.0; 3])?;
    /// let found = world.nearest(&probe, Pose::IDENTITY, f64::INFINITY, |_| true)?.expect("a body");
    /// assert!(found.body == near && (found.distance.upper - 3.0).abs() < 1e-12);
    /// assert!(world.nearest(&probe, Pose::IDENTITY, 2.0, |_| true)?.is_none());
    /// assert!((world.distance(near, near)?.upper).abs() < 1e-12);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the shape cannot be placed at the pose.
    ///
    /// # Complexity
    /// One distance for each body whose box is nearer than the nearest body, and a few searches of
    /// the broad phase. Finding one wanted body takes linear time if few bodies are wanted.
    pub fn nearest(
        &self,
        shape: &Shape,
        world_from_shape: Pose,
        limit: f64,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Result<Option<BodyDistance>, InputError> {
        let placed = Placed::new(shape, world_from_shape)?;
        let bounds = Outline::new().bounds(placed.stands(), &mut Extremes::default());
        let mut search = Search { world: self, placed: &placed, limit, best: None, seen: HashSet::new() };
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Behind(_) | Bounds::Anywhere => search.compare(&Bounds::Anywhere, None, &mut wanted),
            Bounds::Box(own) => {
                let farthest = self.reach_of_some_body(&own, &mut wanted);
                let mut reach = 0.0;
                loop {
                    search.compare(&bounds.grown(reach), Some(&own), &mut wanted);
                    let needed = search.reach().min(farthest);
                    if reach >= needed {
                        break;
                    }
                    reach = (GROWTH * reach).max(FIRST_REACH * needed).max(f64::MIN_POSITIVE).min(needed);
                }
            }
        }
        Ok(search.best)
    }

    /// Returns the distance of two bodies at their current poses, in world units, as
    /// [`query::distance`](crate::query::distance()) does. It does not depend on their traits.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if a body is not in the world.
    pub fn distance(&self, a: BodyId, b: BodyId) -> Result<Distance, WorldError> {
        let (a, b) = (self.resident(a)?, self.resident(b)?);
        Ok(query::distance(a.placed.in_world(), b.placed.in_world()))
    }

    /// Returns a distance from a box within which there is a wanted body, or zero if a box bounds
    /// no wanted body.
    fn reach_of_some_body(&self, own: &MinMax, wanted: &mut dyn FnMut(&Traits) -> bool) -> f64 {
        let found = self.state.residents.iter().find_map(|(body, resident)| {
            let bounds = self.state.bounds_of(body.index() as u32);
            if let Bounds::Box(bounds) = bounds
                && wanted(&resident.traits)
            {
                Some(*bounds)
            } else {
                None
            }
        });
        let Some(found) = found else { return 0.0 };
        let across = |k: usize| found.max()[k].max(own.max()[k]) - found.min()[k].min(own.min()[k]);
        scaled_length(&std::array::from_fn(across)).next_up() * (1.0 + f64::EPSILON)
    }
}

/// A search for the nearest body.
struct Search<'w> {
    world: &'w World,
    placed: &'w Placed,
    limit: f64,
    best: Option<BodyDistance>,
    /// Slots of the bodies that were found by earlier searches.
    seen: HashSet<u32>,
}

impl Search<'_> {
    /// Returns the distance beyond which bodies are not nearer.
    fn reach(&self) -> f64 {
        self.best.map_or(self.limit, |best| best.distance.upper)
    }

    /// Compares the wanted bodies within some bounds that were not found before, the nearest boxes
    /// first. `own` is the box of the shape, if there is one.
    fn compare(&mut self, bounds: &Bounds, own: Option<&MinMax>, wanted: &mut dyn FnMut(&Traits) -> bool) {
        let mut found: Vec<(f64, u64, BodyId, &Resident)> = Vec::new();
        for (body, resident) in self.world.near(bounds) {
            let place = body.index() as u32;
            if !self.seen.insert(place) || !wanted(&resident.traits) {
                continue;
            }
            let gap = match (own, self.world.state.bounds_of(place)) {
                (Some(own), Bounds::Box(bounds)) => gap(own, bounds),
                _ => 0.0,
            };
            found.push((gap, resident.traits.tag, body, resident));
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0).then((one.1, one.2).cmp(&(other.1, other.2))));
        for (gap, tag, body, resident) in found {
            if gap > self.reach() {
                break;
            }
            let distance = query::distance(self.placed.in_world(), resident.placed.in_world());
            let is_nearer = |best: BodyDistance| {
                let upper = [distance.upper, best.distance.upper];
                upper[0] < upper[1] || upper[0] == upper[1] && (tag, body) < (best.tag, best.body)
            };
            if distance.lower <= self.limit && distance.upper < f64::INFINITY && self.best.is_none_or(is_nearer) {
                self.best = Some(BodyDistance { tag, body, distance });
            }
        }
    }
}

/// Returns a lower bound on the distance of two boxes.
fn gap(one: &MinMax, other: &MinMax) -> f64 {
    let apart = |k: usize| (one.min()[k] - other.max()[k]).max(other.min()[k] - one.max()[k]).max(0.0);
    // Each difference is wrong by half a unit in the last place, the length by a few.
    scaled_length(&std::array::from_fn(apart)) * (1.0 - 8.0 * f64::EPSILON)
}
