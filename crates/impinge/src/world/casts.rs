//! Shapes that move against the bodies of a world: the first body that one hits, or all of them.
//!
//! A [`Carrier`] bounds the moving shape. The broad phase finds the bodies whose boxes it passes,
//! one stretch of the path after the other, and a sweep decides about each of them. A body that the
//! carrier reaches later than the first impact so far is not swept.
//!
//! Guarded by `tests/it/worlds/casts.rs`.

use std::collections::HashSet;

use rayon::prelude::*;

use super::body::{BodyId, Traits};
use super::outline::Bounds;
use super::{Resident, World};
use crate::input::InputError;
use crate::shape::{PlacedShape, Shape};
use crate::sweep::{Carrier, Impact, Motion, Sweep};

/// The impact of a moving shape on a body of a [`World`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyImpact {
    /// Tag of the body.
    pub tag: u64,
    /// Handle of the body.
    pub body: BodyId,
    /// Interval of the time of the impact, from 0 to 1, and its place. The first thing of
    /// [`Touch`](crate::sweep::Touch) is the moving shape, the second is the body: the normal leads
    /// from the shape to the body.
    pub impact: Impact,
}

impl World {
    /// Returns the first body that a moving shape touches, out of the bodies for which `wanted`
    /// returns `true`, or `None` if it touches none. Bodies stand still. `sweep` has the clearance
    /// and the other options.
    ///
    /// The first body is the one with the smallest [`t_lower`](Impact::t_lower), then tag, then
    /// handle. As with [`time_of_impact`](crate::sweep::time_of_impact()), nothing touches before
    /// `t_lower`, and an impact whose `t_upper` is infinite is undecided. The impact is that of the
    /// same sweep with this body alone. Bodies that the boxes prove to be apart from the shape are
    /// not hit. If a limit of the sweep is reached, an undecided impact may hide a later one.
    ///
    /// ```
    /// use impinge::sweep::{Motion, Sweep};
    /// use impinge::{Pose, Shape, world::{Body, World}};
    ///
    /// let mut world = World::new();
    /// let wall = Body::new(Shape::cuboid([0.5, 4.0, 4.0])?);
    /// let near = world.insert(wall.clone().at(Pose::from_translation([4.5, 0.0, 0.0])?))?;
    /// world.insert(wall.at(Pose::from_translation([9.5, 0.0, 0.0])?))?;
    /// let path = Motion::between(Pose::IDENTITY, Pose::from_translation([12.0, 0.0, 0.0])?)?;
    /// let sphere = Shape::sphere([0.0; 3], 1.0)?;
    /// let hit = world.shape_cast(&sphere, &path, Sweep::new(), |_| true)?.expect("the near wall");
    /// assert!(hit.body == near && (hit.impact.t_lower - 0.25).abs() < 1e-9);
    /// assert_eq!(hit.impact.touch.expect("a place").normal, [1.0, 0.0, 0.0]);
    /// assert_eq!(world.shape_cast_all(&sphere, &path, Sweep::new(), |_| true)?.len(), 2);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// Returns the errors of [`Shape::at`], for a pose of the motion.
    ///
    /// # Complexity
    /// One sweep for each body whose box the shape's box reaches before the first impact. A shape
    /// that turns is bounded by a cube about the pivot of its motion.
    pub fn shape_cast(
        &self,
        shape: &Shape,
        motion: &Motion,
        sweep: Sweep<'_>,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Result<Option<BodyImpact>, InputError> {
        let mut cast = Cast::new(self, shape, motion, sweep)?;
        let mut best: Option<BodyImpact> = None;
        for stretch in 0..cast.stretches() {
            // A body that is reached in the stretch after the impact may be hit as early, to within
            // rounding.
            let is_late = |best: BodyImpact| best.impact.t_lower < cast.start_of(stretch.saturating_sub(1));
            if best.is_some_and(is_late) {
                break;
            }
            for candidate in cast.reached(stretch, &mut wanted) {
                if best.is_some_and(|best| candidate.enters > best.impact.t_lower) {
                    break;
                }
                let found = cast.impact(&candidate)?;
                if let Some(found) = found
                    && best.is_none_or(|best| is_before(&found, &best))
                {
                    best = Some(found);
                }
            }
        }
        Ok(best)
    }

    /// Returns every body that a moving shape touches, out of the bodies for which `wanted` returns
    /// `true`, each with its first impact. They are sorted by `t_lower`, then by tag and handle.
    /// Undecided impacts are included, as with [`shape_cast`](Self::shape_cast).
    ///
    /// # Errors
    /// Returns the errors of [`Shape::at`], for a pose of the motion.
    ///
    /// # Complexity
    /// One sweep for each body whose box the shape's box reaches, on all threads of the current
    /// rayon pool.
    pub fn shape_cast_all(
        &self,
        shape: &Shape,
        motion: &Motion,
        sweep: Sweep<'_>,
        mut wanted: impl FnMut(&Traits) -> bool,
    ) -> Result<Vec<BodyImpact>, InputError> {
        let mut cast = Cast::new(self, shape, motion, sweep)?;
        let mut candidates = Vec::new();
        for stretch in 0..cast.stretches() {
            candidates.extend(cast.reached(stretch, &mut wanted));
        }
        let impacts: Result<Vec<Option<BodyImpact>>, InputError> =
            candidates.par_iter().map(|candidate| cast.impact(candidate)).collect();
        let mut impacts: Vec<BodyImpact> = impacts?.into_iter().flatten().collect();
        impacts.sort_by(|one, other| {
            one.impact.t_lower.total_cmp(&other.impact.t_lower).then((one.tag, one.body).cmp(&(other.tag, other.body)))
        });
        Ok(impacts)
    }
}

fn is_before(one: &BodyImpact, other: &BodyImpact) -> bool {
    let [t, other_t] = [one.impact.t_lower, other.impact.t_lower];
    t < other_t || t == other_t && (one.tag, one.body) < (other.tag, other.body)
}

/// A body that the moving shape may touch.
struct Candidate<'w> {
    /// Time before which the shape does not touch the body.
    enters: f64,
    body: BodyId,
    resident: &'w Resident,
}

/// A moving shape, and the bodies that it passed so far.
struct Cast<'w> {
    world: &'w World,
    shape: &'w Shape,
    motion: &'w Motion,
    sweep: Sweep<'w>,
    path: Path,
    /// Slots of the bodies that were found in earlier stretches.
    seen: HashSet<u32>,
}

/// The region that a moving shape passes.
enum Path {
    /// The shape is empty.
    Nowhere,
    /// No box bounds the shape.
    Anywhere,
    Carried(Carrier),
}

impl Path {
    fn of(start: &PlacedShape, motion: &Motion) -> Self {
        match Carrier::of(start, motion) {
            Some(carrier) => Self::Carried(carrier),
            None if start.is_unbounded() || start.bounds().is_some() => Self::Anywhere,
            None => Self::Nowhere,
        }
    }
}

impl<'w> Cast<'w> {
    fn new(world: &'w World, shape: &'w Shape, motion: &'w Motion, sweep: Sweep<'w>) -> Result<Self, InputError> {
        let start = shape.at(motion.at(0.0))?;
        shape.at(motion.at(1.0))?;
        Ok(Self { world, shape, motion, sweep, path: Path::of(&start, motion), seen: HashSet::new() })
    }

    fn stretches(&self) -> u32 {
        if let Path::Carried(carrier) = &self.path { carrier.stretches() } else { 1 }
    }

    /// Returns the time at which a stretch starts.
    fn start_of(&self, stretch: u32) -> f64 {
        f64::from(stretch) / f64::from(self.stretches())
    }

    /// Returns the wanted bodies that the shape may touch and whose boxes are near its path in a
    /// stretch but not before, in the order in which they are reached, then by tag and handle.
    fn reached(&mut self, stretch: u32, wanted: &mut dyn FnMut(&Traits) -> bool) -> Vec<Candidate<'w>> {
        let (world, clearance) = (self.world, self.sweep.clearance());
        let bounds = match &self.path {
            Path::Nowhere => Bounds::Nowhere,
            Path::Anywhere => Bounds::Anywhere,
            Path::Carried(carrier) => {
                let times = [self.start_of(stretch), self.start_of(stretch + 1)];
                carrier.between(times, clearance).map_or(Bounds::Anywhere, Bounds::Box)
            }
        };
        let mut reached = Vec::new();
        for (body, resident) in world.near(&bounds) {
            let place = body.index() as u32;
            if !self.seen.insert(place) || !wanted(&resident.traits) {
                continue;
            }
            let enters = match (&self.path, world.state.bounds_of(place)) {
                (Path::Carried(carrier), Bounds::Box(bounds)) => {
                    carrier.enters(bounds, resident.placed.world_from_body(), clearance)
                }
                _ => Some(0.0),
            };
            reached.extend(enters.map(|enters| Candidate { enters, body, resident }));
        }
        reached.sort_by(|one, other| {
            let key = |candidate: &Candidate<'_>| (candidate.resident.traits.tag, candidate.body);
            one.enters.total_cmp(&other.enters).then(key(one).cmp(&key(other)))
        });
        reached
    }

    /// Returns the impact on a body, or `None` if it is disproved.
    fn impact(&self, candidate: &Candidate<'_>) -> Result<Option<BodyImpact>, InputError> {
        let &Candidate { body, resident, .. } = candidate;
        let rest = Motion::resting(*resident.placed.world_from_body());
        let impact = self.sweep.time_of_impact(self.shape, resident.placed.shape(), self.motion, &rest)?;
        Ok(impact.hit().then_some(BodyImpact { tag: resident.traits.tag, body, impact }))
    }
}
