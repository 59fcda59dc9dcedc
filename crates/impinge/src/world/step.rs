//! A step: takes new poses, and reports the pairs that changed.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::body::{BodyId, Kind};
use super::broad::KnownPairs;
use super::error::WorldError;
use super::events::{Events, Work};
use super::narrow::Meeting;
use super::outline::{Bounds, Extremes};
use super::placed::ValidPlacement;
use super::{Change, State, World, refused};
use crate::math::Pose;
use crate::partition::Move;
use crate::simd::prefetch;

/// Minimum number of bodies or pairs per parallel task. With fewer, starting a task costs more than
/// it saves.
const MIN_TASK: usize = 64;

/// Number of bodies whose memory is prefetched together. A processor loads about this number of
/// places at the same time, and they stay in its first caches until they are used.
const PREFETCH_BATCH: usize = 16;

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
    /// [`Input`](WorldError::Input) if its shape cannot be placed at the pose. The world is then
    /// unchanged.
    ///
    /// # Complexity
    /// Proportional to the number of bodies that changed and the pairs that they are in. Bodies
    /// that rest cost nothing. The work is shared among all threads of the current rayon pool.
    pub fn step(&mut self, moves: &[(BodyId, Pose)]) -> Result<&Events, WorldError> {
        self.step_observed(moves, &mut |_| ())
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
        // A caller outside the pool would wait for a thread to wake at each parallel loop. Entering
        // the pool once avoids that.
        if moves.len() >= 2 * MIN_TASK {
            rayon::scope(|_| self.advance(moves, observe))?;
        } else {
            self.advance(moves, observe)?;
        }
        Ok(&self.state.events)
    }

    fn advance(&mut self, moves: &[(BodyId, Pose)], observe: &mut dyn FnMut(Phase)) -> Result<(), WorldError> {
        let next = self.validate(moves)?;
        observe(Phase::Realign);
        let known = self.take(moves, next);
        let changed = self.state.changed.take();
        observe(Phase::Take);
        let mut work = Work { changed: changed.len(), ..Work::default() };
        let (lost, found) = self.changed_candidates(&changed, &known);
        for pair in lost {
            work.lost += usize::from(self.state.remove_pair(pair));
        }
        for [one, other] in found {
            if self.state.pairs.find(one, other).is_none() {
                let bodies = if self.is_before(one, other) { [one, other] } else { [other, one] };
                self.state.pairs.add(bodies);
                work.gained += 1;
            }
        }
        work.candidates = self.state.pairs.len();
        observe(Phase::Broad);
        let pairs = self.pairs_to_examine(&changed);
        work.examined = pairs.len();
        let meetings = self.examine(&pairs);
        observe(Phase::Narrow);
        self.report(&changed, &pairs, meetings, work);
        observe(Phase::Report);
        Ok(())
    }

    /// Validates all moves, and returns the bodies in their new poses. An entry is `None` if the
    /// body is already in this pose.
    fn validate(&self, moves: &[(BodyId, Pose)]) -> Result<Vec<Option<Next>>, WorldError> {
        let refused: Mutex<Option<(usize, WorldError)>> = Mutex::new(None);
        let next = moves.par_iter().enumerate().with_min_len(MIN_TASK).map(|(at, (body, pose))| {
            if at % PREFETCH_BATCH == 0 {
                let [now, after] = [at, at + PREFETCH_BATCH].map(|first| &moves[moves.len().min(first)..]);
                self.prefetch(&now[..now.len().min(PREFETCH_BATCH)], &after[..after.len().min(PREFETCH_BATCH)]);
            }
            self.next(*body, pose).unwrap_or_else(|error| {
                let mut refused = refused.lock().unwrap_or_else(PoisonError::into_inner);
                if refused.as_ref().is_none_or(|&(first, _)| at < first) {
                    *refused = Some((at, error));
                }
                None
            })
        });
        let next = next.collect();
        match refused.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some((_, error)) => Err(error),
            None => Ok(next),
        }
    }

    /// Validates a move, and returns the body in its new pose, or `None` if it is already in this
    /// pose.
    fn next(&self, body: BodyId, pose: &Pose) -> Result<Option<Next>, WorldError> {
        let resident = self.resident(body)?;
        if resident.traits.kind == Kind::Static {
            return Err(WorldError::Static { body });
        }
        if resident.placed.world_from_body() == pose {
            return Ok(None);
        }
        let placement = resident.placed.validate_at(pose).map_err(|error| refused(body, error))?;
        let mut extremes = resident.extremes;
        let bounds = resident.outline.bounds(resident.placed.standing(&placement), &mut extremes);
        Ok(Some(Next { placement, bounds, extremes }))
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
    /// knows afterwards.
    fn take(&mut self, moves: &[(BodyId, Pose)], mut next: Vec<Option<Next>>) -> KnownPairs {
        let state = &mut self.state;
        let mut boxes = Vec::with_capacity(moves.len());
        let order = last_of_each(moves);
        for (nth, &(body, at)) in order.iter().enumerate() {
            if let Some(&(ahead, _)) = order.get(nth + PREFETCH_BATCH) {
                state.residents.prefetch(ahead);
            }
            let (Some(resident), Some(next)) = (state.residents.get_mut(body), next[at as usize].take()) else {
                continue;
            };
            let Next { placement, bounds, extremes } = next;
            resident.placed.follow(placement);
            resident.extremes = extremes;
            let place = body.index() as u32;
            let before = state.replace_bounds(place, bounds);
            state.changed.mark(place, Change::Moved);
            match (&before, &bounds) {
                _ if before == bounds => {}
                (Bounds::Box(_), Bounds::Box(bounds)) => boxes.push(Move { key: place, to: Some(*bounds) }),
                _ => {
                    state.update_structures(place, &before, &bounds);
                    state.changed.mark(place, Change::Place);
                }
            }
        }
        state.broad.adapt(boxes.len());
        // If nothing changed, the broad phase need not be updated.
        if state.changed.is_empty() { KnownPairs::Nothing } else { state.broad.step(&boxes) }
    }

    /// Returns the pairs whose boxes ceased to overlap, and the pairs whose boxes began to. A pair
    /// may be listed more than once.
    fn changed_candidates(&self, changed: &[u32], known: &KnownPairs) -> (Vec<u32>, Vec<[u32; 2]>) {
        let search = Search { world: self, known };
        let (lost, found): (Vec<Vec<u32>>, Vec<Vec<[u32; 2]>>) = changed
            .par_chunks(MIN_TASK)
            .map(|changed| {
                let (mut lost, mut found) = (Vec::new(), Vec::new());
                for &index in changed {
                    search.of(index, &mut lost, &mut found);
                }
                (lost, found)
            })
            .unzip();
        let (lost, mut found) = (lost.concat(), found.concat());
        let known = match known {
            KnownPairs::Nothing => &[],
            KnownPairs::Changes(changes) => changes.began(),
            KnownPairs::All(pairs) => &pairs[..],
        };
        let State { pairs, changed, .. } = &self.state;
        let is_new = |&&[one, other]: &&[u32; 2]| {
            changed.of(one).max(changed.of(other)) != Change::No
                && pairs.find(one, other).is_none()
                && self.may_collide(one, other)
        };
        found.par_extend(known.par_iter().with_min_len(MIN_TASK).filter(is_new));
        (lost, found)
    }

    /// Reports whether the bodies in two slots are admitted as a pair.
    fn may_collide(&self, one: u32, other: u32) -> bool {
        let residents = &self.state.residents;
        let (Some(one), Some(other)) = (residents.at(one), residents.at(other)) else { return false };
        let is_before = (one.1.traits.tag, one.0) < (other.1.traits.tag, other.0);
        if is_before { self.admits(one, other) } else { self.admits(other, one) }
    }

    /// Reports whether the body in one slot is reported before the body in another slot.
    fn is_before(&self, one: u32, other: u32) -> bool {
        let key = |index| self.state.residents.at(index).map(|(id, resident)| (resident.traits.tag, id));
        key(one) < key(other)
    }

    /// Returns the pairs of which at least one body changed, each once.
    fn pairs_to_examine(&self, changed: &[u32]) -> Vec<u32> {
        let state = &self.state;
        let mut pairs = Vec::new();
        for &index in changed {
            for link in state.pairs.of(index) {
                if link.other > index || state.changed.of(link.other) == Change::No {
                    pairs.push(link.pair);
                }
            }
        }
        pairs
    }

    /// Runs the narrow phase for these pairs.
    fn examine(&self, pairs: &[u32]) -> Vec<Option<Meeting>> {
        let narrow = self.options.narrow_phase;
        let placed = |index| self.state.residents.at(index).map(|(_, resident)| &resident.placed);
        let examine = |&pair: &u32| {
            let [a, b] = self.state.pairs.get(pair)?.bodies;
            narrow.examine(placed(a)?, placed(b)?)
        };
        pairs.par_iter().with_min_len(narrow.min_task()).map(examine).collect()
    }

    /// Stores the results of the narrow phase, and reports the pairs that began and ended.
    fn report(&mut self, changed: &[u32], pairs: &[u32], meetings: Vec<Option<Meeting>>, work: Work) {
        let state = &mut self.state;
        let mut events = Events { work, ..std::mem::take(&mut state.events) };
        events.began.clear();
        events.ended.clear();
        events.ended.append(&mut state.departed);
        for (&pair, meeting) in pairs.iter().zip(meetings) {
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
        changed.iter().for_each(|&index| state.changed.forget(index));
        events.began.sort_unstable();
        events.ended.sort_unstable();
        state.events = events;
    }
}

/// The parts of a body that a step changes, after the step.
struct Next {
    placement: ValidPlacement,
    bounds: Bounds,
    extremes: Extremes,
}

/// Returns the bodies that move, in order, each with the index of its last move in the list.
fn last_of_each(moves: &[(BodyId, Pose)]) -> Vec<(BodyId, u32)> {
    let mut order: Vec<(BodyId, u32)> = (0..).zip(moves).map(|(at, &(body, _))| (body, at)).collect();
    order.sort_unstable();
    order.dedup_by(|later, kept| {
        let is_same = later.0 == kept.0;
        if is_same {
            *kept = *later;
        }
        is_same
    });
    order
}

/// Search for the pairs of changed bodies.
struct Search<'w> {
    world: &'w World,
    known: &'w KnownPairs,
}

impl Search<'_> {
    /// Reports whether pairs of the body in this slot must be searched for. If not, the broad phase
    /// has reported them.
    fn asks(&self, index: u32) -> bool {
        let change = self.world.state.changed.of(index);
        match self.known {
            KnownPairs::Nothing => change > Change::No,
            KnownPairs::Changes(_) => change > Change::Moved,
            KnownPairs::All(_) => false,
        }
    }

    /// Adds the pairs of a changed body that ended to `lost` and those that began to `found`.
    ///
    /// Each pair is handled by one of its bodies. If both bodies search, or if both changed and do
    /// not search, the body in the smaller slot handles it. If one body searches, that body handles
    /// it. The broad phase has reported new pairs of two bodies that do not search, unless one of
    /// them has no bounding box.
    fn of(&self, index: u32, lost: &mut Vec<u32>, found: &mut Vec<[u32; 2]>) {
        let state = &self.world.state;
        let (asks, links) = (self.asks(index), state.pairs.of(index));
        if !asks && links.is_empty() && state.unbounded.is_empty() {
            return; // the common case if many bodies move
        }
        let bounds = state.bounds_of(index);
        let is_others = |other: u32| match (asks, self.asks(other)) {
            (false, false) => other < index && state.changed.of(other) != Change::No,
            (true, true) => other < index,
            (_, asks) => asks,
        };
        for link in links.iter().filter(|link| !is_others(link.other)) {
            let is_filtered = || state.changed.of(index).max(state.changed.of(link.other)) == Change::Traits;
            if !bounds.overlap(state.bounds_of(link.other))
                || is_filtered() && !self.world.may_collide(index, link.other)
            {
                lost.push(link.pair);
            }
        }
        let mut offer = |other: u32| {
            if other != index
                && !is_others(other)
                && bounds.overlap(state.bounds_of(other))
                && self.world.may_collide(index, other)
                && state.pairs.find(index, other).is_none()
            {
                found.push([index, other]);
            }
        };
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => {
                if asks {
                    state.broad.for_each_overlapping(bounds, &mut offer);
                }
                state.unbounded.iter().for_each(|&other| offer(other));
            }
            Bounds::Behind(_) | Bounds::Anywhere => state.residents.iter().for_each(|(id, _)| offer(id.index() as u32)),
        }
    }
}
