//! Bodies that come, change and go, and the boxes and pairs that follow them.

use std::sync::Arc;

use super::outline::{Bounds, Outline};
use super::placed::Placed;
use super::{BodyId, Change, State};

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
}
