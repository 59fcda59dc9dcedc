//! Whether two bodies may meet at all.

use std::fmt;

use super::body::{BodyId, Kind, Traits};

/// The user's say about pairs: asked inside the broad phase, for pairs whose boxes overlap and that kinds, layers and owners
/// admit.
///
/// It has to give the same answer whenever it is asked about the same two bodies, until [`World::set_filter`](super::World::set_filter) or
/// [`World::set_traits`](super::World::set_traits) is called; it is asked from many threads, when the boxes come to overlap
/// and, about pairs that it refused, perhaps again. Functions of two bodies are filters.
pub trait PairFilter: Send + Sync {
    /// Whether these two may meet; the first has the lesser tag, or handle.
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
    /// Whether kinds, layers and owners of two bodies admit the pair.
    #[must_use]
    pub fn admit(&self, other: &Self) -> bool {
        (self.kind == Kind::Moving || other.kind == Kind::Moving)
            && self.layers.admit(other.layers)
            && (self.owner.is_none() || self.owner != other.owner)
    }
}
