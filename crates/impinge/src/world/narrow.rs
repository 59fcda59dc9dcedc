//! The narrow phase: what two bodies whose boxes overlap have in common.

use super::placed::Placed;
use crate::query::{self, Manifold, Proximity};

/// What is found out about pairs whose boxes overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NarrowPhase {
    /// Nothing: the pairs are those of the boxes, and all undecided. For triggers that may be coarse, and for measuring the
    /// broad phase.
    Boxes,
    /// Whether the bodies meet.
    Intersections,
    /// Whether they do, and their contacts.
    #[default]
    Contacts,
}

/// A pair that is not proved apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meeting {
    pub(super) proximity: Proximity,
    pub(super) manifolds: Vec<Manifold>,
}

impl NarrowPhase {
    /// How many pairs are one task at least.
    pub(super) fn least_shared(self) -> usize {
        match self {
            Self::Boxes => 4096,
            // Some microseconds at least, and a millisecond for meshes.
            Self::Intersections | Self::Contacts => 4,
        }
    }

    /// What is to be known about two bodies; none where they are apart.
    pub(super) fn examine(self, a: &Placed, b: &Placed) -> Option<Meeting> {
        let proximity =
            if self == Self::Boxes { Proximity::Undecided } else { query::proximity(a.in_world(), b.in_world()) };
        if proximity == Proximity::Apart {
            return None;
        }
        let manifolds = match self {
            Self::Contacts => query::contacts(a.in_world(), b.in_world()),
            Self::Boxes | Self::Intersections => Vec::new(),
        };
        Some(Meeting { proximity, manifolds })
    }
}
