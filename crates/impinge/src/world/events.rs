//! What a step reports: pairs that began and ended, and those that there are.

use super::body::BodyId;
use crate::query::{Manifold, Proximity};

/// Two bodies: the first has the lesser tag or, where tags are equal, the lesser handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PairKey {
    /// The first body's tag.
    pub tag_a: u64,
    /// The second body's tag.
    pub tag_b: u64,
    /// The first body.
    pub a: BodyId,
    /// The second body.
    pub b: BodyId,
}

/// A pair that meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<'w> {
    /// Its bodies.
    pub key: PairKey,
    /// How sure it is that they meet; always [`Meets`](Proximity::Meets) among meshes, boxes and hulls.
    pub proximity: Proximity,
    /// Where they meet, as [`contacts`](crate::query::contacts) says; none where the world was not asked for contacts.
    pub manifolds: &'w [Manifold],
}

/// What changed at a step; each list is sorted, and no pair is in both.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Pairs that meet now and did not before.
    pub began: Vec<PairKey>,
    /// Pairs that met before and do not now; a body that was removed is named by its stale handle.
    pub ended: Vec<PairKey>,
    /// What the step had to do.
    pub work: Work,
}

/// How much work a step was: counters that depend on nothing but the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Bodies that changed.
    pub changed: usize,
    /// Pairs of boxes that came to overlap.
    pub gained: usize,
    /// Pairs of boxes that ceased to.
    pub lost: usize,
    /// Pairs of shapes that were looked at.
    pub examined: usize,
    /// Pairs of boxes that overlap now.
    pub candidates: usize,
}

/// Pairs in the order of reports.
pub(super) fn sorted(mut pairs: Vec<Pair<'_>>) -> Vec<Pair<'_>> {
    pairs.sort_unstable_by_key(|pair| pair.key);
    pairs
}
