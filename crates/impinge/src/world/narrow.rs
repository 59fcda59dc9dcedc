//! The narrow phase: decides whether two bodies whose boxes overlap intersect, and finds their
//! contacts.

use super::placed::Placed;
use crate::budget::Budget;
use crate::query::{ContactOptions, Manifold, Proximity, Query};

/// Results that a step computes for each pair of bodies whose boxes overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NarrowPhase {
    /// Nothing: all pairs whose boxes, grown by their margins, overlap are reported, as undecided.
    /// For coarse triggers, and for measuring the broad phase.
    Boxes,
    /// Whether the bodies intersect, or are as near as their margins.
    Intersections,
    /// Whether the bodies intersect, or are as near as their margins, and their contacts.
    #[default]
    Contacts,
}

/// Result for a pair that is not proved apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meeting {
    pub(super) proximity: Proximity,
    pub(super) manifolds: Vec<Manifold>,
}

impl NarrowPhase {
    /// Returns the minimum number of pairs per parallel task.
    pub(super) fn min_task(self) -> usize {
        match self {
            Self::Boxes => 4096,
            // A pair takes at least some microseconds, and up to a millisecond for meshes.
            Self::Intersections | Self::Contacts => 4,
        }
    }

    /// Returns the maximum number of pairs of convex bodies that stay on the caller's thread.
    pub(super) fn max_alone(self) -> usize {
        match self {
            Self::Boxes => 4096,
            // Fractions of a microsecond for each pair.
            Self::Intersections => 256,
            // One to some ten microseconds.
            Self::Contacts => 128,
        }
    }

    /// Computes the result for two bodies. Returns `None` if they are farther apart than `margin`.
    /// The caller must discard the result if the budget ended the query.
    pub(super) fn examine(self, a: &Placed, b: &Placed, margin: f64, budget: &Budget<'_>) -> Option<Meeting> {
        let contacts = ContactOptions { margin, ..ContactOptions::default() };
        let query = || Query::new().with_budget(budget).with_contacts(contacts);
        let proximity = match self {
            Self::Boxes => Proximity::Undecided,
            _ if margin == 0.0 => query().proximity(a.in_world(), b.in_world()),
            _ => query().nearness(a.in_world(), b.in_world(), margin),
        };
        if proximity == Proximity::Apart {
            return None;
        }
        let manifolds = match self {
            Self::Contacts if !budget.is_spent() => query().contacts_of_near(a.in_world(), b.in_world()),
            Self::Boxes | Self::Intersections | Self::Contacts => Vec::new(),
        };
        Some(Meeting { proximity, manifolds })
    }
}
