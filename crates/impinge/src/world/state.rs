//! Bodies that come, change and go, and the boxes and pairs that follow them.

use std::sync::Arc;

use super::outline::{Bounds, Outline};
use super::placed::Placed;
use super::{BodyId, Change, State};

impl State {
    /// Notes that a body changed.
    pub(super) fn mark(&mut self, body: BodyId, change: Change) {
        if let Some(resident) = self.residents.get_mut(body) {
            if resident.change == Change::No {
                self.changed.push(body.index() as u32);
            }
            resident.change = resident.change.max(change);
        }
    }

    /// Puts something else in the place of a body.
    pub(super) fn replace(&mut self, body: BodyId, placed: Placed, outline: Option<Arc<Outline>>) {
        let Some(resident) = self.residents.get_mut(body) else { return };
        resident.placed = placed;
        if let Some(outline) = outline {
            resident.outline = outline;
        }
        let now = resident.outline.bounds(&resident.placed, &mut resident.extremes);
        let before = std::mem::replace(&mut resident.bounds, now.clone());
        self.shift(body.index() as u32, &before, &now);
        self.mark(body, Change::Place);
    }

    /// A body comes to be somewhere.
    pub(super) fn enter(&mut self, index: u32, bounds: &Bounds) {
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => self.broad.insert(index, bounds),
            Bounds::Behind(_) | Bounds::Anywhere => self.unbounded.push(index),
        }
    }

    /// A body ceases to be somewhere.
    pub(super) fn leave(&mut self, index: u32, bounds: &Bounds) {
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(_) => self.broad.remove(index),
            Bounds::Behind(_) | Bounds::Anywhere => self.unbounded.retain(|&other| other != index),
        }
    }

    pub(super) fn shift(&mut self, index: u32, before: &Bounds, now: &Bounds) {
        match (before, now) {
            (Bounds::Box(_), Bounds::Box(bounds)) => self.broad.insert(index, bounds),
            (Bounds::Behind(_), Bounds::Behind(_)) => {}
            _ => {
                self.leave(index, before);
                self.enter(index, now);
            }
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
