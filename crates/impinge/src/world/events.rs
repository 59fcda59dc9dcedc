//! The report of a step: the pairs that began, ended and exist.

use super::body::BodyId;
use crate::query::{Manifold, Proximity};

/// Key of a pair: the tags and handles of two bodies. The first body has the smaller tag or, if the
/// tags are equal, the smaller handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PairKey {
    /// Tag of the first body.
    pub tag_a: u64,
    /// Tag of the second body.
    pub tag_b: u64,
    /// Handle of the first body.
    pub a: BodyId,
    /// Handle of the second body.
    pub b: BodyId,
}

/// A pair of bodies that intersect or may intersect, with its contacts. If a body has a margin,
/// *intersect* means here that the distance of the bodies is at most the sum of their margins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<'w> {
    /// Tags and handles of the two bodies.
    pub key: PairKey,
    /// Whether the intersection is proved ([`Intersects`](Proximity::Intersects)) or undecided
    /// ([`Undecided`](Proximity::Undecided)). It is always proved if neither body is
    /// round or the solid of an open mesh, except with
    /// [`NarrowPhase::Boxes`](super::NarrowPhase::Boxes).
    pub proximity: Proximity,
    /// Contacts in the world frame, as returned by [`contacts`](crate::query::contacts) with the sum
    /// of the margins. The depth of a contact across a gap is negative. Empty if the world does not
    /// compute contacts.
    pub manifolds: &'w [Manifold],
}

/// The changes of a step. Both lists are sorted, and no pair is in both.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Pairs that intersect now and did not before the step. Undecided pairs count as intersecting.
    pub began: Vec<PairKey>,
    /// Pairs that intersected before the step and do not now. A body that was removed appears with
    /// its stale handle.
    pub ended: Vec<PairKey>,
    /// Amount of work that the step did.
    pub work: Work,
}

/// Counters of the work of a step. They depend on nothing but the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Number of bodies that changed.
    pub changed: usize,
    /// Number of pairs of boxes that began to overlap.
    pub gained: usize,
    /// Number of pairs of boxes that ceased to overlap.
    pub lost: usize,
    /// Number of pairs of shapes that the narrow phase processed.
    pub examined: usize,
    /// Number of pairs of boxes that overlap now.
    pub candidates: usize,
}

/// Returns the pairs in the order of reports.
pub(super) fn sorted(mut pairs: Vec<Pair<'_>>) -> Vec<Pair<'_>> {
    pairs.sort_unstable_by_key(|pair| pair.key);
    pairs
}
