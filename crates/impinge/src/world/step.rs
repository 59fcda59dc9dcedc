//! A step: takes new poses, and reports the pairs that changed.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::body::{BodyId, Kind};
use super::broad::KnownPairs;
use super::error::WorldError;
use super::events::{Events, Work};
use super::narrow::{Meeting, NarrowPhase};
use super::other::{Other, Taken};
use super::outline::Bounds;
use super::search::{Candidates, MAX_ALONE, is_alone, min_task};
use super::{Change, State, World, refused};
use crate::budget::{Budget, Stopped};
use crate::math::Pose;
use crate::partition::Move;
use crate::simd::prefetch;

/// Number of bodies whose memory is prefetched together. A processor loads about this number of
/// places at the same time, and they stay in its first caches until they are used.
const PREFETCH_BATCH: usize = 16;

/// Maximum number of bodies of a step that are not prefetched, because they mostly stay in the
/// caches.
const MAX_CACHED: usize = 128;

/// The phases of a step, for measuring them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Phase {
    /// Validates the poses, and realigns boxes to them.
    Realign,
    /// Moves the bodies, and updates the broad phase.
    Take,
    /// Finds pairs of boxes that began to overlap, and pairs that ceased to.
    Broad,
    /// Processes pairs of shapes.
    Narrow,
    /// Sorts the changes.
    Report,
}

impl World {
    /// Moves bodies to poses in the world and returns the pairs that began and ended. Bodies that
    /// are not named keep their poses. If a body is named several times, its last pose counts.
    ///
    /// ```
    /// # use impinge::{Pose, shape::Shape, world::{Body, World}};
    /// # let mut world = World::new();
    /// # let body = world.insert(Body::new(Shape::cuboid([1.0; 3])?))?;
    /// let events = world.step(&[(body, Pose::from_translation([0.0, 0.5, 0.0])?)])?;
    /// for pair in &events.began {
    ///     println!("{} intersects {}", pair.a, pair.b);
    /// }
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// Returns the error of the first invalid move: [`Stale`](WorldError::Stale) if the body is not
    /// in the world, [`Static`](WorldError::Static) if it is static, or
    /// [`Input`](WorldError::Input) if its shape cannot be placed at the pose. Returns
    /// [`Stopped`](WorldError::Stopped) if there is not enough memory for the pairs. The
    /// world is then unchanged.
    ///
    /// # Complexity
    /// Proportional to the number of bodies that changed and the pairs that they are in. Bodies
    /// that rest cost nothing. The work is shared among all threads of the current rayon pool.
    pub fn step(&mut self, moves: &[(BodyId, Pose)]) -> Result<&Events, WorldError> {
        self.step_observed(moves, &mut |_| ())
    }

    /// Does a [`step`](Self::step) with limits on its work. If one is reached, the world is as it
    /// was before the step.
    ///
    /// The budget is checked after every few bodies and pairs, and within queries about meshes. It
    /// is not checked while the pairs that were found are stored.
    ///
    /// ```
    /// # use impinge::budget::{Budget, Stopped};
    /// # use impinge::{Pose, shape::Shape, world::{Body, World, WorldError}};
    /// let mut world = World::new();
    /// let body = world.insert(Body::new(Shape::cuboid([1.0; 3])?))?;
    /// let moves = [(body, Pose::from_translation([0.0, 0.5, 0.0])?)];
    /// let stopped = world.step_with_budget(&moves, &Budget::new().with_cancel(&|| true)).cloned();
    /// assert_eq!(stopped, Err(WorldError::Stopped(Stopped::Canceled)));
    /// assert_eq!(world.pose(body)?, &Pose::IDENTITY);
    /// # Ok::<(), WorldError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`Stopped`](WorldError::Stopped) if a limit was reached, and the errors of
    /// [`step`](Self::step).
    pub fn step_with_budget(&mut self, moves: &[(BodyId, Pose)], budget: &Budget<'_>) -> Result<&Events, WorldError> {
        self.enter(moves, budget, &mut |_| ())
    }

    /// Does a [`step`](Self::step), and calls `observe` at the end of each phase.
    ///
    /// # Errors
    /// Returns the same errors as [`step`](Self::step).
    pub fn step_observed(
        &mut self,
        moves: &[(BodyId, Pose)],
        observe: &mut (dyn FnMut(Phase) + Send),
    ) -> Result<&Events, WorldError> {
        self.enter(moves, Budget::unlimited(), observe)
    }

    /// Enters the pool of threads if the step is large. A caller outside the pool would wait for a
    /// thread to wake at each parallel loop.
    fn enter(
        &mut self,
        moves: &[(BodyId, Pose)],
        budget: &Budget<'_>,
        observe: &mut (dyn FnMut(Phase) + Send),
    ) -> Result<&Events, WorldError> {
        if is_alone(moves.len(), MAX_ALONE) {
            self.advance(moves, budget, observe)?;
        } else {
            rayon::scope(|_| self.advance(moves, budget, observe))?;
        }
        Ok(&self.state.events)
    }

    /// Does a step. The bodies move first, because the broad phase finds pairs as boxes move. Pairs
    /// are changed last, after everything that can fail. A failed step moves the bodies back.
    fn advance(
        &mut self,
        moves: &[(BodyId, Pose)],
        budget: &Budget<'_>,
        observe: &mut dyn FnMut(Phase),
    ) -> Result<(), WorldError> {
        let mut spare = std::mem::take(&mut self.spare);
        let done = self.advance_in(&mut spare.0, moves, budget, observe);
        self.spare = spare;
        done
    }

    /// Does a step in given memory.
    fn advance_in(
        &mut self,
        others: &mut Vec<Other>,
        moves: &[(BodyId, Pose)],
        budget: &Budget<'_>,
        observe: &mut dyn FnMut(Phase),
    ) -> Result<(), WorldError> {
        if others.len() < moves.len() {
            others.try_reserve(moves.len() - others.len())?;
            others.resize_with(moves.len(), Other::default);
        }
        let others = &mut others[..moves.len()];
        self.validate(moves, others, budget)?;
        observe(Phase::Realign);
        let mut taken = Taken::new(moves, others);
        let found = self.take(&mut taken, budget).map_err(WorldError::from).and_then(|known| {
            observe(Phase::Take);
            self.find(&known, budget, observe)
        });
        let done = match found {
            Ok(found) => {
                self.report(found);
                observe(Phase::Report);
                Ok(())
            }
            Err(error) => {
                self.take_back(&mut taken);
                Err(error)
            }
        };
        taken.clear();
        done
    }

    /// Validates all moves, and writes the placements of the bodies in their new poses.
    fn validate(&self, moves: &[(BodyId, Pose)], others: &mut [Other], budget: &Budget<'_>) -> Result<(), WorldError> {
        let refused: Mutex<Option<(usize, WorldError)>> = Mutex::new(None);
        let (is_large, task) = (moves.len() > MAX_CACHED, min_task(moves.len()));
        moves.par_iter().zip(others).enumerate().with_min_len(task).for_each(|(at, ((body, pose), other))| {
            if is_large && at % PREFETCH_BATCH == 0 {
                let [now, after] = [at, at + PREFETCH_BATCH].map(|first| &moves[moves.len().min(first)..]);
                self.prefetch(&now[..now.len().min(PREFETCH_BATCH)], &after[..after.len().min(PREFETCH_BATCH)]);
            }
            let written = budget.check().map_err(WorldError::from).and_then(|()| self.write_move(*body, pose, other));
            if let Err(error) = written {
                let mut refused = refused.lock().unwrap_or_else(PoisonError::into_inner);
                if refused.as_ref().is_none_or(|&(first, _)| at < first) {
                    *refused = Some((at, error));
                }
            }
        });
        refused.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), |(_, error)| Err(error))
    }

    /// Validates a move, and writes the placement of the body in its new pose.
    fn write_move(&self, body: BodyId, pose: &Pose, other: &mut Other) -> Result<(), WorldError> {
        let resident = self.resident(body)?;
        if resident.traits.kind == Kind::Static {
            return Err(WorldError::Static { body });
        }
        other.write(resident, pose).map_err(|error| refused(body, error))
    }

    /// Prefetches the bodies `after`, which move next, and the data that the bodies `now` refer to,
    /// one level after the other.
    fn prefetch(&self, now: &[(BodyId, Pose)], after: &[(BodyId, Pose)]) {
        after.iter().for_each(|&(body, _)| self.state.residents.prefetch(body));
        let residents = || now.iter().filter_map(|&(body, _)| self.state.residents.get(body));
        for resident in residents() {
            prefetch(&*resident.outline);
            resident.placed.in_world().prefetch();
        }
        residents().for_each(|resident| resident.placed.in_world().prefetch_corners());
    }

    /// Moves the bodies and their boxes, and returns the facts about pairs that the broad phase
    /// knows afterwards. `taken` then holds the bodies as they were before.
    ///
    /// # Errors
    /// Returns an error if the broad phase ended early. The bodies have moved all the same.
    fn take(&mut self, taken: &mut Taken<'_>, budget: &Budget<'_>) -> Result<KnownPairs, Stopped> {
        let state = &mut self.state;
        let (mut moving, mut guided) = (Vec::with_capacity(taken.order.len()), Vec::new());
        let is_large = taken.order.len() > MAX_CACHED;
        for (nth, &(body, at)) in taken.order.iter().enumerate() {
            if is_large && let Some(&(ahead, _)) = taken.order.get(nth + PREFETCH_BATCH) {
                state.residents.prefetch(ahead);
            }
            let other = &mut taken.others[at as usize];
            let Some(kind) = state.exchange(body, other) else { continue };
            let place = body.index() as u32;
            other.change = state.changed.mark(place, Change::Moved);
            let (before, now) = (other.bounds, *state.bounds_of(place));
            match (&before, &now) {
                _ if before == now => {}
                (Bounds::Box(_), Bounds::Box(bounds)) => {
                    let boxes = if kind == Kind::Moving { &mut moving } else { &mut guided };
                    boxes.push(Move { key: place, to: Some(*bounds) });
                }
                _ => {
                    state.update_structures(kind, place, &before, &now);
                    state.changed.mark(place, Change::Place);
                }
            }
        }
        state.broad.adapt(moving.len());
        // If nothing changed, the broad phase need not be updated.
        if state.changed.is_empty() { Ok(KnownPairs::Nothing) } else { state.broad.step(&moving, &guided, budget) }
    }

    /// Moves the bodies back to where they were before [`take`](Self::take).
    fn take_back(&mut self, taken: &mut Taken<'_>) {
        let state = &mut self.state;
        for &(body, at) in &taken.order {
            let other = &mut taken.others[at as usize];
            let Some(kind) = state.exchange(body, other) else { continue };
            let place = body.index() as u32;
            let now = *state.bounds_of(place);
            state.update_structures(kind, place, &other.bounds, &now);
            state.changed.set_back(place, other.change);
        }
    }

    /// Finds the pairs that a step changes, and their results, without a change to the world.
    fn find(
        &mut self,
        known: &KnownPairs,
        budget: &Budget<'_>,
        observe: &mut dyn FnMut(Phase),
    ) -> Result<Found, WorldError> {
        let changed = self.state.changed.places();
        let mut candidates = self.changed_candidates(&changed, known, budget)?;
        self.add_surfaces(&changed, &mut candidates);
        candidates.kept.try_reserve(candidates.found.len())?;
        self.state.pairs.try_reserve(&candidates.found)?;
        observe(Phase::Broad);
        let min_task = self.narrow_task(&candidates);
        let kept = candidates.kept.par_iter().map(|&pair| self.state.pairs.get(pair).map(|entry| entry.bodies));
        let found = candidates.found.par_iter().map(|&bodies| Some(bodies));
        let mut meetings = Vec::new();
        meetings.try_reserve_exact(candidates.kept.len() + candidates.found.len())?;
        let examined = kept.chain(found).with_min_len(min_task).map(|bodies| self.examine(bodies?, budget));
        examined.collect_into_vec(&mut meetings);
        self.find_surface_contacts(&candidates, &mut meetings, budget);
        budget.check()?;
        let began = meetings[candidates.kept.len()..].iter().flatten().count();
        self.state.events.began.try_reserve(began)?;
        observe(Phase::Narrow);
        Ok(Found { changed: changed.len(), candidates, meetings })
    }

    /// Returns the minimum number of pairs per parallel task of the narrow phase. A few pairs of
    /// single convex bodies stay on the caller's thread.
    fn narrow_task(&self, candidates: &Candidates) -> usize {
        let kept = candidates.kept.iter().filter_map(|&pair| self.state.pairs.get(pair)).map(|entry| entry.bodies);
        let mut pairs = kept.chain(candidates.found.iter().copied());
        let is_quick = |place: u32| self.state.residents.at(place).is_none_or(|(_, body)| body.placed.is_quick());
        let count = candidates.kept.len() + candidates.found.len();
        let narrow_phase = self.options.narrow_phase;
        let stays = is_alone(count, narrow_phase.max_alone()) && pairs.all(|bodies| bodies.into_iter().all(is_quick));
        if stays { count.max(1) } else { narrow_phase.min_task() }
    }

    /// Runs the narrow phase for two bodies.
    fn examine(&self, bodies: [u32; 2], budget: &Budget<'_>) -> Option<Meeting> {
        if budget.is_spent() {
            return None; // the caller discards all results
        }
        let [a, b] = bodies.map(|place| self.state.residents.at(place).map(|(_, resident)| resident));
        let (a, b) = (a?, b?);
        let is_of_surface = self.is_of_surface(bodies);
        let narrow_phase = if is_of_surface { NarrowPhase::Intersections } else { self.options.narrow_phase };
        narrow_phase.examine(&a.placed, &b.placed, a.margin + b.margin, budget)
    }

    /// Stores the pairs and the results of the narrow phase, and reports the pairs that began and
    /// ended.
    fn report(&mut self, found: Found) {
        let Found { changed, candidates: Candidates { lost, mut kept, found }, meetings } = found;
        let state = &mut self.state;
        let gained = found.len();
        let lost = lost.into_iter().filter(|&pair| state.remove_pair(pair)).count();
        kept.extend(found.into_iter().map(|bodies| state.pairs.add(bodies)));
        let work = Work { changed, gained, lost, examined: kept.len(), candidates: state.pairs.len() };
        let mut events = Events { work, ..std::mem::take(&mut state.events) };
        events.began.clear();
        events.ended.clear();
        events.ended.append(&mut state.departed);
        for (pair, meeting) in kept.into_iter().zip(meetings) {
            let Some(entry) = state.pairs.get_mut(pair) else { continue };
            let (before, now) = (entry.meeting.is_some(), meeting.is_some());
            let bodies = entry.bodies;
            entry.meeting = meeting;
            if before != now
                && let Some(key) = state.key(bodies)
            {
                if now { events.began.push(key) } else { events.ended.push(key) }
            }
        }
        state.changed.clear();
        events.began.sort_unstable();
        events.ended.sort_unstable();
        state.events = events;
    }
}

impl State {
    /// Exchanges the placement of a body that moves with another. Returns the kind of the body, or
    /// `None` if it does not move. Does not update the broad phase.
    #[inline]
    fn exchange(&mut self, body: BodyId, other: &mut Other) -> Option<Kind> {
        if !other.moves {
            return None;
        }
        std::mem::swap(self.bounds_mut(body.index() as u32), &mut other.bounds);
        let resident = self.residents.get_mut(body)?;
        resident.placed.swap(&mut other.placement);
        std::mem::swap(&mut resident.extremes, &mut other.extremes);
        Some(resident.traits.kind)
    }
}

/// Everything that a step found, before it is stored.
struct Found {
    /// Number of bodies that changed.
    changed: usize,
    candidates: Candidates,
    /// Results of the pairs that persist, then of the pairs that are new.
    meetings: Vec<Option<Meeting>>,
}
