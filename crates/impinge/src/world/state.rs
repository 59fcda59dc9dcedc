//! The state of a world: bodies, and the boxes and pairs that follow them.

use std::sync::Arc;

use super::body::{Body, BodyId, Kind, Traits, validate_margin};
use super::broad::Broad;
use super::changed::{Change, Changed};
use super::events::{Events, Pair, PairKey};
use super::outline::{Bounds, Extremes, Outline};
use super::pairs::{Entry, Pairs};
use super::placed::Placed;
use super::slots::Slots;
use crate::input::InputError;

/// The part of a world that steps change.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) residents: Slots<Resident>,
    /// Bounds of the body in each slot. They are apart from the bodies, because a step reads them
    /// for every pair.
    pub(super) bounds: Vec<Bounds>,
    pub(super) broad: Broad,
    /// Number of bodies that have a surface.
    pub(super) surface_bodies: usize,
    pub(super) pairs: Pairs,
    /// Changes since the last step.
    pub(super) changed: Changed,
    /// Pairs that ended because a body was removed, for the next report.
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
    /// Distance in world units by which the bounds are grown.
    pub(super) margin: f64,
}

impl State {
    /// Replaces the placed shape of a body, and its outline if there is a new one.
    pub(super) fn replace(&mut self, body: BodyId, placed: Placed, outline: Option<Arc<Outline>>) {
        self.mark_neighbors(body.index() as u32);
        let Some(resident) = self.residents.get_mut(body) else { return };
        resident.placed = placed;
        if let Some(outline) = outline {
            resident.outline = outline;
        }
        let (kind, bounds) = (resident.traits.kind, resident.bounds());
        self.update_bounds(kind, body.index() as u32, bounds);
        self.changed.mark(body.index() as u32, Change::Place);
    }

    /// Returns the bounds of the body in a slot.
    #[inline]
    pub(super) fn bounds_of(&self, place: u32) -> &Bounds {
        self.bounds.get(place as usize).unwrap_or(&Bounds::Nowhere)
    }

    /// Returns the bounds of the body in a slot, to change them. The broad phase does not follow.
    #[inline]
    pub(super) fn bounds_mut(&mut self, place: u32) -> &mut Bounds {
        let at = place as usize;
        if at >= self.bounds.len() {
            self.bounds.resize(at + 1, Bounds::Nowhere);
        }
        &mut self.bounds[at]
    }

    /// Stores new bounds of the body of a kind in a slot, and updates the broad phase.
    pub(super) fn update_bounds(&mut self, kind: Kind, place: u32, bounds: Bounds) {
        let before = std::mem::replace(self.bounds_mut(place), bounds);
        self.update_structures(kind, place, &before, &bounds);
    }

    /// Updates the broad phase after the bounds of a body of a kind changed.
    pub(super) fn update_structures(&mut self, kind: Kind, place: u32, before: &Bounds, now: &Bounds) {
        match (before, now) {
            (Bounds::Box(_), Bounds::Box(_)) | (Bounds::Nowhere, _) => {}
            (Bounds::Box(_), _) => self.broad.remove(kind, place),
            (Bounds::Behind(_) | Bounds::Anywhere, _) => self.broad.remove_unbounded(kind, place),
        }
        match now {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => self.broad.insert(kind, place, bounds),
            Bounds::Behind(_) | Bounds::Anywhere => self.broad.insert_unbounded(kind, place),
        }
    }

    /// Removes a pair, and records it as ended for the next report if its bodies intersected.
    /// Returns `false` if there was no such pair.
    pub(super) fn remove_pair(&mut self, pair: u32) -> bool {
        let Some(entry) = self.pairs.remove(pair) else { return false };
        if entry.meeting.is_some()
            && let Some(key) = self.key(entry.bodies)
        {
            self.departed.push(key);
        }
        true
    }

    /// Returns the key of a pair, given the slots of its bodies.
    pub(super) fn key(&self, [a, b]: [u32; 2]) -> Option<PairKey> {
        let ((a, resident_a), (b, resident_b)) = (self.residents.at(a)?, self.residents.at(b)?);
        Some(PairKey { tag_a: resident_a.traits.tag, tag_b: resident_b.traits.tag, a, b })
    }

    /// Returns a pair as it is reported, or `None` if its bodies do not intersect.
    pub(super) fn pair<'w>(&self, entry: &'w Entry) -> Option<Pair<'w>> {
        let meeting = entry.meeting.as_ref()?;
        Some(Pair { key: self.key(entry.bodies)?, proximity: meeting.proximity, manifolds: &meeting.manifolds })
    }
}

impl Resident {
    /// Places a body.
    ///
    /// # Errors
    /// Returns an error if the shape cannot be placed at the pose, or if the margin is invalid.
    pub(super) fn new(body: Body) -> Result<Self, InputError> {
        validate_margin(body.margin)?;
        let placed = Placed::new(&body.shape, body.world_from_body)?;
        let Body { outline, traits, margin, .. } = body;
        Ok(Self { placed, outline, extremes: Extremes::default(), traits, margin })
    }

    /// Returns the bounds of the body, grown by its margin.
    pub(super) fn bounds(&mut self) -> Bounds {
        self.outline.bounds(self.placed.stands(), &mut self.extremes).grown(self.margin)
    }

    pub(super) fn into_body(self) -> Body {
        Body {
            shape: self.placed.shape().clone(),
            outline: self.outline,
            world_from_body: *self.placed.world_from_body(),
            traits: self.traits,
            margin: self.margin,
        }
    }
}
