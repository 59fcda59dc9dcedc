//! The structures that find overlapping boxes, one of them at work.

mod every;

use crate::volume::MinMax;
use every::Every;

/// No place.
const NONE: u32 = u32::MAX;

/// How pairs of boxes are found. No answer depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BroadPhase {
    /// What suits the number of bodies, how many of them move and how their sizes spread.
    #[default]
    Auto,
    /// Every box is compared with every box that moved.
    Every,
}

/// The boxes of the bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Broad {
    choice: BroadPhase,
    every: Every,
}

impl Broad {
    pub(super) fn new(choice: BroadPhase) -> Self {
        Self { choice, ..Self::default() }
    }

    pub(super) fn insert(&mut self, body: u32, bounds: &MinMax) {
        self.every.insert(body, bounds);
    }

    pub(super) fn update(&mut self, body: u32, bounds: &MinMax) {
        self.every.update(body, bounds);
    }

    pub(super) fn remove(&mut self, body: u32) {
        self.every.remove(body);
    }

    pub(super) fn for_each_overlapping(&self, bounds: &MinMax, visit: impl FnMut(u32)) {
        self.every.for_each_overlapping(bounds, visit);
    }
}
