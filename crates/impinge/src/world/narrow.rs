//! The narrow phase: what two bodies whose boxes overlap have in common.

use super::placed::Placed;
use crate::mesh::Placed as PlacedMesh;
use crate::query::shapes::{self, Manifold, Proximity};
use crate::query::{self, Solid};

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
        let proximity = if self == Self::Boxes { Proximity::Undecided } else { proximity(a, b) };
        if proximity == Proximity::Apart {
            return None;
        }
        let manifolds = if self == Self::Contacts { shapes::contacts(a.in_world(), b.in_world()) } else { Vec::new() };
        Some(Meeting { proximity, manifolds })
    }
}

/// Whether two bodies meet.
pub(super) fn proximity(a: &Placed, b: &Placed) -> Proximity {
    match (a.mesh(), b.mesh()) {
        // Told sooner than by a clearance of zero.
        (Some((mesh_a, is_solid_a)), Some((mesh_b, is_solid_b))) => meshes(mesh_a, mesh_b, [is_solid_a, is_solid_b]),
        _ => shapes::proximity(a.in_world(), b.in_world()),
    }
}

fn meshes(a: PlacedMesh<'_>, b: PlacedMesh<'_>, is_solid: [bool; 2]) -> Proximity {
    let meets = match is_solid {
        [false, false] => query::intersects(a, b),
        [true, false] => query::intersects_solid(a, b, Solid::A),
        [false, true] => query::intersects_solid(a, b, Solid::B),
        [true, true] => query::intersects_solid(a, b, Solid::Both),
    };
    if meets { Proximity::Meets } else { Proximity::Apart }
}
