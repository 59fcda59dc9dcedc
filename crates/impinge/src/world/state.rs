//! Bodies that come, change and go, and the boxes and pairs that follow them.

use std::sync::Arc;

use super::body::{Body, BodyId, Traits};
use super::broad::Broad;
use super::changed::{Change, Changed};
use super::events::{Events, Pair, PairKey};
use super::outline::{Bounds, Extremes, Outline};
use super::pairs::{Entry, Pairs};
use super::placed::Placed;
use super::slots::Slots;

/// The part of a world that steps change.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) residents: Slots<Resident>,
    /// Where the body in each place may be, by place: apart from the bodies, as a step asks it of every pair.
    pub(super) bounds: Vec<Bounds>,
    /// Bodies that no box bounds.
    pub(super) unbounded: Vec<u32>,
    pub(super) broad: Broad,
    pub(super) pairs: Pairs,
    /// Since the last step.
    pub(super) changed: Changed,
    /// Pairs that ended as a body was removed, for the next report.
    pub(super) departed: Vec<PairKey>,
    pub(super) events: Events,
}

/// A body in the world.
#[derive(Clone, Debug)]
pub(super) struct Resident {
    pub(super) placed: Placed,
    pub(super) outline: Arc<Outline>,
    pub(super) extremes: Extremes,
    pub(super) traits: Traits,
}

impl State {
    /// Puts something else in the place of a body.
    pub(super) fn replace(&mut self, body: BodyId, placed: Placed, outline: Option<Arc<Outline>>) {
        let Some(resident) = self.residents.get_mut(body) else { return };
        resident.placed = placed;
        if let Some(outline) = outline {
            resident.outline = outline;
        }
        let bounds = resident.outline.bounds(resident.placed.stands(), &mut resident.extremes);
        self.shift(body.index() as u32, bounds);
        self.changed.mark(body.index() as u32, Change::Place);
    }

    /// Where the body in a place may be.
    #[inline]
    pub(super) fn bounds_of(&self, place: u32) -> &Bounds {
        self.bounds.get(place as usize).unwrap_or(&Bounds::Nowhere)
    }

    /// Notes where the body in a place is from now on, and returns where it was; the broad phase is not told.
    pub(super) fn rebound(&mut self, place: u32, bounds: Bounds) -> Bounds {
        let at = place as usize;
        if at >= self.bounds.len() {
            self.bounds.resize(at + 1, Bounds::Nowhere);
        }
        std::mem::replace(&mut self.bounds[at], bounds)
    }

    /// The body in a place comes to be somewhere else, or nowhere any more.
    pub(super) fn shift(&mut self, place: u32, bounds: Bounds) {
        let before = self.rebound(place, bounds);
        self.tell(place, &before, &bounds);
    }

    /// Tells the broad phase, or whoever has the bodies that no box bounds, where the body in a place was and is.
    pub(super) fn tell(&mut self, place: u32, before: &Bounds, now: &Bounds) {
        match (before, now) {
            (Bounds::Box(_), Bounds::Box(_)) | (Bounds::Nowhere, _) => {}
            (Bounds::Box(_), _) => self.broad.remove(place),
            (Bounds::Behind(_) | Bounds::Anywhere, _) => self.unbounded.retain(|&other| other != place),
        }
        match now {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => self.broad.insert(place, bounds),
            Bounds::Behind(_) | Bounds::Anywhere => self.unbounded.push(place),
        }
    }

    /// Takes a pair out, and notes for the next report that it ended where its bodies met; whether it was there.
    pub(super) fn part(&mut self, pair: u32) -> bool {
        let Some(entry) = self.pairs.remove(pair) else { return false };
        if entry.meeting.is_some()
            && let Some(key) = self.key(entry.bodies)
        {
            self.departed.push(key);
        }
        true
    }

    /// The name of a pair of places.
    pub(super) fn key(&self, [a, b]: [u32; 2]) -> Option<PairKey> {
        let ((a, resident_a), (b, resident_b)) = (self.residents.at(a)?, self.residents.at(b)?);
        Some(PairKey { tag_a: resident_a.traits.tag, tag_b: resident_b.traits.tag, a, b })
    }

    /// A pair, where it meets.
    pub(super) fn pair<'w>(&self, entry: &'w Entry) -> Option<Pair<'w>> {
        let meeting = entry.meeting.as_ref()?;
        Some(Pair { key: self.key(entry.bodies)?, proximity: meeting.proximity, manifolds: &meeting.manifolds })
    }
}

impl Resident {
    pub(super) fn into_body(self) -> Body {
        Body {
            shape: self.placed.shape().clone(),
            outline: self.outline,
            world_from_body: *self.placed.world_from_body(),
            traits: self.traits,
        }
    }
}
