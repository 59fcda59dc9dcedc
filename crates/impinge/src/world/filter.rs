//! Decides which pairs of bodies are considered at all.

use std::fmt;

use super::body::{BodyId, Kind, Traits};

/// A user's filter for pairs of bodies. The broad phase calls it for pairs whose boxes overlap and
/// that kinds, layers and owners admit. Functions of two bodies implement it.
///
/// It must return the same result for the same two bodies until
/// [`World::set_filter`](super::World::set_filter) or
/// [`World::set_traits`](super::World::set_traits) is called. It is called from many threads, when
/// boxes begin to overlap, and possibly again for pairs that it refused.
pub trait PairFilter: Send + Sync {
    /// Returns `true` if the two bodies may form a pair. The first has the smaller tag or, if the
    /// tags are equal, the smaller handle.
    fn admits(&self, a: (BodyId, &Traits), b: (BodyId, &Traits)) -> bool;
}

impl<F: Fn((BodyId, &Traits), (BodyId, &Traits)) -> bool + Send + Sync> PairFilter for F {
    fn admits(&self, a: (BodyId, &Traits), b: (BodyId, &Traits)) -> bool {
        self(a, b)
    }
}

impl fmt::Debug for dyn PairFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("PairFilter")
    }
}

impl Traits {
    /// Reports whether kinds, layers and owners of two bodies admit them as a pair.
    #[must_use]
    pub fn admit(&self, other: &Self) -> bool {
        (self.kind == Kind::Moving || other.kind == Kind::Moving)
            && self.layers.admit(other.layers)
            && (self.owner.is_none() || self.owner != other.owner)
    }
}
