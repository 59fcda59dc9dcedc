//! A step: new poses in, what changed out.

use rayon::prelude::*;

use super::body::{BodyId, Kind};
use super::broad::Told;
use super::error::WorldError;
use super::events::{Events, Work};
use super::narrow::Meeting;
use super::outline::{Bounds, Extremes};
use super::placed::Judged;
use super::{Change, Resident, World, refused};
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
pub enum Phase {
    /// Poses are judged and taken.
    Judge,
    /// Boxes are realigned, and the broad phase is told.
    Realign,
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
        observe: &mut dyn FnMut(Phase),
    ) -> Result<&Events, WorldError> {
        let taken = self.judge(moves)?;
        let moved = self.take(moves, taken);
        observe(Phase::Judge);
        self.state.broad.adapt(moved.len());
        let told = self.realign(&moved);
        let changed = self.changed();
        observe(Phase::Realign);
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
        Ok(&self.state.events)
    }

    /// The bodies in their new poses; none where a body is in this pose already.
    fn judge(&self, moves: &[(BodyId, Pose)]) -> Result<Vec<Option<Judged>>, WorldError> {
        let judged: Vec<Result<Option<Judged>, WorldError>> = moves
            .par_iter()
            .enumerate()
            .with_min_len(LEAST_SHARED)
            .map(|(at, &(body, pose))| {
                if at % TOGETHER == 0 {
                    self.prefetch(&moves[at..moves.len().min(at + TOGETHER)]);
                }
                let resident = self.resident(body)?;
                if resident.traits.kind == Kind::Static {
                    return Err(WorldError::Static { body });
                }
                if *resident.placed.world_from_body() == pose {
                    return Ok(None);
                }
                resident.placed.judge(&pose).map(Some).map_err(|error| refused(body, error))
            })
            .collect();
        judged.into_iter().collect()
    }

    /// Asks for the memory of bodies that move, one level of it after the other.
    fn prefetch(&self, moves: &[(BodyId, Pose)]) {
        moves.iter().for_each(|&(body, _)| self.state.residents.prefetch(body));
        let residents = || moves.iter().filter_map(|&(body, _)| self.state.residents.get(body));
        for resident in residents() {
            prefetch(&*resident.outline);
            resident.placed.in_world().prefetch();
        }
        residents().for_each(|resident| resident.placed.in_world().prefetch_corners());
    }

    /// Puts the bodies into their new poses; returns them, each once.
    fn take(&mut self, moves: &[(BodyId, Pose)], taken: Vec<Option<Judged>>) -> Vec<BodyId> {
        let mut moved = Vec::with_capacity(moves.len());
        for ((body, pose), judged) in moves.iter().zip(taken) {
            let Some(resident) = self.state.residents.get_mut(*body) else { continue };
            // A body that is named twice may go back to where it was.
            let judged = match judged {
                Some(judged) => judged,
                None if resident.placed.world_from_body() == pose => continue,
                None => match resident.placed.judge(pose) {
                    Ok(judged) => judged,
                    Err(_) => continue,
                },
            };
            resident.placed.follow(judged);
            moved.push(*body);
            self.state.mark(*body, Change::Moved);
        }
        moved.sort_unstable();
        moved.dedup();
        moved
    }

    /// Lets the boxes follow the bodies; what the broad phase says about pairs then.
    fn realign(&mut self, moved: &[BodyId]) -> Told {
        let followed: Vec<(Bounds, Extremes)> = moved
            .par_iter()
            .with_min_len(LEAST_SHARED)
            .map(|&body| {
                let Ok(resident) = self.resident(body) else { return (Bounds::Nowhere, Extremes::default()) };
                let mut extremes = resident.extremes;
                (resident.outline.bounds(&resident.placed, &mut extremes), extremes)
            })
            .collect();
        let mut moves = Vec::with_capacity(moved.len());
        for (&body, (now, extremes)) in moved.iter().zip(followed) {
            let Some(resident) = self.state.residents.get_mut(body) else { continue };
            resident.extremes = extremes;
            let before = std::mem::replace(&mut resident.bounds, now.clone());
            match (&before, &now) {
                _ if before == now => {}
                (Bounds::Box(_), Bounds::Box(bounds)) => {
                    moves.push(Move { key: body.index() as u32, to: Some(*bounds) });
                }
                _ => {
                    self.state.shift(body.index() as u32, &before, &now);
                    self.state.mark(body, Change::Place);
                }
            }
        }
        // Where nothing changed there is nothing to tell.
        if self.state.changed.is_empty() { Told::Nothing } else { self.state.broad.step(&moves) }
    }

    /// The places of the bodies that changed since the last step, in order.
    fn changed(&mut self) -> Vec<u32> {
        let mut changed = std::mem::take(&mut self.state.changed);
        changed
            .retain(|&index| self.state.residents.at(index).is_some_and(|(_, resident)| resident.change != Change::No));
        changed.sort_unstable();
        changed.dedup();
        changed
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
        let is_new = |&&[one, other]: &&[u32; 2]| {
            let (Some(one), Some(other)) = (self.state.residents.at(one), self.state.residents.at(other)) else {
                return false;
            };
            one.1.change.max(other.1.change) != Change::No
                && self.state.pairs.find(one.0.index() as u32, other.0.index() as u32).is_none()
                && self.may_meet(one, other)
        };
        found.par_extend(told.par_iter().with_min_len(LEAST_SHARED).filter(is_new));
        (lost, found)
    }

    fn may_meet(&self, one: (BodyId, &Resident), other: (BodyId, &Resident)) -> bool {
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
                let other = state.residents.at(link.other);
                if link.other > index || other.is_some_and(|(_, other)| other.change == Change::No) {
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
        for &index in changed {
            if let Some(resident) = state.residents.at_mut(index) {
                resident.change = Change::No;
            }
        }
        events.began.sort_unstable();
        events.ended.sort_unstable();
        state.events = events;
    }
}

/// Who looks for the pairs of whom.
struct Search<'w> {
    world: &'w World,
    told: &'w Told,
}

impl Search<'_> {
    /// Whether pairs are to be looked for about this body; else the broad phase told of them.
    fn asks(&self, resident: &Resident) -> bool {
        match self.told {
            Told::Nothing => resident.change > Change::No,
            Told::Changes(_) => resident.change > Change::Moved,
            Told::All(_) => false,
        }
    }

    /// Of two bodies that ask, the one in the lesser place sees to their pair; of one that asks and one that does not, the
    /// first; of two that do not, the broad phase, unless no box bounds one of them.
    fn of(&self, index: u32, lost: &mut Vec<u32>, found: &mut Vec<[u32; 2]>) {
        let state = &self.world.state;
        let Some(own) = state.residents.at(index) else { return };
        let asks = self.asks(own.1);
        let is_others = |other_index: u32, other: &Resident| self.asks(other) && (!asks || other_index < index);
        for link in state.pairs.of(index) {
            let Some((id, other)) = state.residents.at(link.other) else { continue };
            let is_filtered = own.1.change.max(other.change) == Change::Traits;
            if !is_others(link.other, other)
                && (!own.1.bounds.overlap(&other.bounds) || is_filtered && !self.world.may_meet(own, (id, other)))
            {
                lost.push(link.pair);
            }
        }
        let mut meet = |other_index: u32| {
            let Some((id, other)) = state.residents.at(other_index) else { return };
            if other_index != index
                && !is_others(other_index, other)
                && own.1.bounds.overlap(&other.bounds)
                && self.world.may_meet(own, (id, other))
                && state.pairs.find(index, other_index).is_none()
            {
                found.push([index, other_index]);
            }
        };
        match &own.1.bounds {
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
