//! A step: new poses in, what changed out.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::body::{BodyId, Kind};
use super::broad::Told;
use super::error::WorldError;
use super::events::{Events, Work};
use super::narrow::Meeting;
use super::outline::{Bounds, Extremes};
use super::placed::Judged;
use super::{Change, State, World, refused};
use crate::math::Pose;
use crate::partition::Move;
use crate::simd::prefetch;

/// Bodies, or pairs, that are one task at least: less work than this is done sooner than handed over.
const LEAST_SHARED: usize = 64;

/// Bodies whose memory is asked for at once: a processor waits for so many places in memory at the same time, and they stay in
/// its first caches meanwhile.
const TOGETHER: usize = 16;

/// The phases of a step, for whoever measures them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Phase {
    /// Poses are judged, and boxes realigned to them.
    Realign,
    /// The bodies take their new places, and the broad phase is told.
    Take,
    /// Pairs of boxes that came to overlap are found, and those that ceased to.
    Broad,
    /// Pairs of shapes are looked at.
    Narrow,
    /// What changed is put in order.
    Report,
}

impl World {
    /// Moves bodies and says what changed. Bodies that are not named stay where they are; of two poses for one body the last
    /// counts.
    ///
    /// ```
    /// # use impinge::{Pose, shape::Shape, world::{Body, World}};
    /// # let mut world = World::new();
    /// # let body = world.insert(Body::new(Shape::cuboid([1.0; 3])?))?;
    /// let events = world.step(&[(body, Pose::from_translation([0.0, 0.5, 0.0])?)])?;
    /// for pair in &events.began {
    ///     println!("{} meets {}", pair.a, pair.b);
    /// }
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale), [`Static`](WorldError::Static), and [`Input`](WorldError::Input) where a shape does not
    /// stand a pose, for the first move that is wrong. Then nothing has changed.
    ///
    /// # Complexity
    /// Grows with the bodies that changed and the pairs that they are in; what stands still costs nothing. Shared out to all
    /// cores of the current rayon pool.
    pub fn step(&mut self, moves: &[(BodyId, Pose)]) -> Result<&Events, WorldError> {
        self.step_observed(moves, &mut |_| ())
    }

    /// [`step`](Self::step), telling whenever a phase is done.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_observed(
        &mut self,
        moves: &[(BodyId, Pose)],
        observe: &mut (dyn FnMut(Phase) + Send),
    ) -> Result<&Events, WorldError> {
        // Whoever calls from outside the pool would wait for a thread to wake at each thing that is shared out: so once for all of them.
        if moves.len() >= 2 * LEAST_SHARED {
            rayon::scope(|_| self.advance(moves, observe))?;
        } else {
            self.advance(moves, observe)?;
        }
        Ok(&self.state.events)
    }

    fn advance(&mut self, moves: &[(BodyId, Pose)], observe: &mut dyn FnMut(Phase)) -> Result<(), WorldError> {
        let next = self.judge(moves)?;
        observe(Phase::Realign);
        let told = self.take(moves, next);
        let changed = self.state.changed.take();
        observe(Phase::Take);
        let mut work = Work { changed: changed.len(), ..Work::default() };
        let (lost, found) = self.recandidates(&changed, &told);
        for pair in lost {
            work.lost += usize::from(self.state.part(pair));
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

    /// The bodies as they will be in their new poses; none where a body is in this pose already.
    fn judge(&self, moves: &[(BodyId, Pose)]) -> Result<Vec<Option<Next>>, WorldError> {
        let refused: Mutex<Option<(usize, WorldError)>> = Mutex::new(None);
        let next = moves.par_iter().enumerate().with_min_len(LEAST_SHARED).map(|(at, (body, pose))| {
            if at % TOGETHER == 0 {
                let [now, after] = [at, at + TOGETHER].map(|first| &moves[moves.len().min(first)..]);
                self.prefetch(&now[..now.len().min(TOGETHER)], &after[..after.len().min(TOGETHER)]);
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

    /// A body as it will be in another pose; none where it is in this pose already.
    fn next(&self, body: BodyId, pose: &Pose) -> Result<Option<Next>, WorldError> {
        let resident = self.resident(body)?;
        if resident.traits.kind == Kind::Static {
            return Err(WorldError::Static { body });
        }
        if resident.placed.world_from_body() == pose {
            return Ok(None);
        }
        let judged = resident.placed.judge(pose).map_err(|error| refused(body, error))?;
        let mut extremes = resident.extremes;
        let bounds = resident.outline.bounds(resident.placed.standing(&judged), &mut extremes);
        Ok(Some(Next { judged, bounds, extremes }))
    }

    /// Asks for the memory of bodies that are to move after these, and for what these refer to, one level of it after the other.
    fn prefetch(&self, now: &[(BodyId, Pose)], after: &[(BodyId, Pose)]) {
        after.iter().for_each(|&(body, _)| self.state.residents.prefetch(body));
        let residents = || now.iter().filter_map(|&(body, _)| self.state.residents.get(body));
        for resident in residents() {
            prefetch(&*resident.outline);
            resident.placed.in_world().prefetch();
        }
        residents().for_each(|resident| resident.placed.in_world().prefetch_corners());
    }

    /// Puts the bodies and their boxes where they were judged to be; what the broad phase says about pairs then.
    fn take(&mut self, moves: &[(BodyId, Pose)], mut next: Vec<Option<Next>>) -> Told {
        let state = &mut self.state;
        let mut boxes = Vec::with_capacity(moves.len());
        let order = last_of_each(moves);
        for (nth, &(body, at)) in order.iter().enumerate() {
            if let Some(&(ahead, _)) = order.get(nth + TOGETHER) {
                state.residents.prefetch(ahead);
            }
            let (Some(resident), Some(next)) = (state.residents.get_mut(body), next[at as usize].take()) else {
                continue;
            };
            let Next { judged, bounds, extremes } = next;
            resident.placed.follow(judged);
            resident.extremes = extremes;
            let place = body.index() as u32;
            let before = state.rebound(place, bounds);
            state.changed.mark(place, Change::Moved);
            match (&before, &bounds) {
                _ if before == bounds => {}
                (Bounds::Box(_), Bounds::Box(bounds)) => boxes.push(Move { key: place, to: Some(*bounds) }),
                _ => {
                    state.tell(place, &before, &bounds);
                    state.changed.mark(place, Change::Place);
                }
            }
        }
        state.broad.adapt(boxes.len());
        // Where nothing changed there is nothing to tell.
        if state.changed.is_empty() { Told::Nothing } else { state.broad.step(&boxes) }
    }

    /// Pairs of boxes that ceased to overlap, and that came to; perhaps more than once.
    fn recandidates(&self, changed: &[u32], told: &Told) -> (Vec<u32>, Vec<[u32; 2]>) {
        let search = Search { world: self, told };
        let (lost, found): (Vec<Vec<u32>>, Vec<Vec<[u32; 2]>>) = changed
            .par_chunks(LEAST_SHARED)
            .map(|changed| {
                let (mut lost, mut found) = (Vec::new(), Vec::new());
                for &index in changed {
                    search.of(index, &mut lost, &mut found);
                }
                (lost, found)
            })
            .unzip();
        let (lost, mut found) = (lost.concat(), found.concat());
        let told = match told {
            Told::Nothing => &[],
            Told::Changes(changes) => changes.began(),
            Told::All(pairs) => &pairs[..],
        };
        let State { pairs, changed, .. } = &self.state;
        let is_new = |&&[one, other]: &&[u32; 2]| {
            changed.of(one).max(changed.of(other)) != Change::No
                && pairs.find(one, other).is_none()
                && self.may_meet(one, other)
        };
        found.par_extend(told.par_iter().with_min_len(LEAST_SHARED).filter(is_new));
        (lost, found)
    }

    /// Whether the bodies in two places may meet.
    fn may_meet(&self, one: u32, other: u32) -> bool {
        let residents = &self.state.residents;
        let (Some(one), Some(other)) = (residents.at(one), residents.at(other)) else { return false };
        let is_before = (one.1.traits.tag, one.0) < (other.1.traits.tag, other.0);
        if is_before { self.admits(one, other) } else { self.admits(other, one) }
    }

    /// Whether the body in one place is reported before that in another.
    fn is_before(&self, one: u32, other: u32) -> bool {
        let key = |index| self.state.residents.at(index).map(|(id, resident)| (resident.traits.tag, id));
        key(one) < key(other)
    }

    /// The pairs of which a body changed, each once.
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

    /// What the narrow phase makes of these pairs.
    fn examine(&self, pairs: &[u32]) -> Vec<Option<Meeting>> {
        let narrow = self.options.narrow_phase;
        let placed = |index| self.state.residents.at(index).map(|(_, resident)| &resident.placed);
        let examine = |&pair: &u32| {
            let [a, b] = self.state.pairs.get(pair)?.bodies;
            narrow.examine(placed(a)?, placed(b)?)
        };
        pairs.par_iter().with_min_len(narrow.least_shared()).map(examine).collect()
    }

    /// Keeps what was found, and notes what is new.
    fn report(&mut self, changed: &[u32], pairs: &[u32], meetings: Vec<Option<Meeting>>, work: Work) {
        let state = &mut self.state;
        let mut events = Events { work, ..std::mem::take(&mut state.events) };
        events.began.clear();
        events.ended.clear();
        events.ended.append(&mut state.departed);
        for (&pair, meeting) in pairs.iter().zip(meetings) {
            let Some(entry) = state.pairs.get_mut(pair) else { continue };
            let (met, meets) = (entry.meeting.is_some(), meeting.is_some());
            let bodies = entry.bodies;
            entry.meeting = meeting;
            if met != meets
                && let Some(key) = state.key(bodies)
            {
                if meets { events.began.push(key) } else { events.ended.push(key) }
            }
        }
        changed.iter().for_each(|&index| state.changed.forget(index));
        events.began.sort_unstable();
        events.ended.sort_unstable();
        state.events = events;
    }
}

/// A body as it will be after a step, but for what does not change.
struct Next {
    judged: Judged,
    bounds: Bounds,
    extremes: Extremes,
}

/// The bodies that move, in order, and where in a list the move is that counts: of several of one body the last.
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

/// Who looks for the pairs of whom.
struct Search<'w> {
    world: &'w World,
    told: &'w Told,
}

impl Search<'_> {
    /// Whether pairs are to be looked for about the body in this place; else the broad phase told of them.
    fn asks(&self, index: u32) -> bool {
        let change = self.world.state.changed.of(index);
        match self.told {
            Told::Nothing => change > Change::No,
            Told::Changes(_) => change > Change::Moved,
            Told::All(_) => false,
        }
    }

    /// Of two bodies that ask, or that changed and do not, the one in the lesser place sees to their pair; of one that asks and one
    /// that does not, the first. Of two that do not the broad phase told, unless no box bounds one of them.
    fn of(&self, index: u32, lost: &mut Vec<u32>, found: &mut Vec<[u32; 2]>) {
        let state = &self.world.state;
        let (asks, links) = (self.asks(index), state.pairs.of(index));
        if !asks && links.is_empty() && state.unbounded.is_empty() {
            return; // as most do of many that move
        }
        let bounds = state.bounds_of(index);
        let is_others = |other: u32| match (asks, self.asks(other)) {
            (false, false) => other < index && state.changed.of(other) != Change::No,
            (true, true) => other < index,
            (_, asks) => asks,
        };
        for link in links.iter().filter(|link| !is_others(link.other)) {
            let is_filtered = || state.changed.of(index).max(state.changed.of(link.other)) == Change::Traits;
            if !bounds.overlap(state.bounds_of(link.other)) || is_filtered() && !self.world.may_meet(index, link.other)
            {
                lost.push(link.pair);
            }
        }
        let mut meet = |other: u32| {
            if other != index
                && !is_others(other)
                && bounds.overlap(state.bounds_of(other))
                && self.world.may_meet(index, other)
                && state.pairs.find(index, other).is_none()
            {
                found.push([index, other]);
            }
        };
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => {
                if asks {
                    state.broad.for_each_overlapping(bounds, &mut meet);
                }
                state.unbounded.iter().for_each(|&other| meet(other));
            }
            Bounds::Behind(_) | Bounds::Anywhere => state.residents.iter().for_each(|(id, _)| meet(id.index() as u32)),
        }
    }
}
