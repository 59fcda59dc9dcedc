//! What the narrow phase finds about a pair.

use crate::query::shapes::Proximity;

/// Where two bodies meet, and how they come apart there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// A point of the first body, in the world frame, rounded.
    pub point_a: [f64; 3],
    /// A point of the second body, in the world frame, rounded.
    pub point_b: [f64; 3],
    /// A direction of length 1 from the first body to the second, in the world frame.
    pub normal: [f64; 3],
    /// How far the second body has to move along the normal to come apart here, in world units; zero where they touch, and
    /// infinite where nothing takes them apart.
    pub depth: f64,
    /// What of each body meets there: the same number in step after step, for as long as it does.
    pub features: [u32; 2],
}

/// A pair that is not proved apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meeting {
    pub(super) proximity: Proximity,
    pub(super) contacts: Vec<Contact>,
}
