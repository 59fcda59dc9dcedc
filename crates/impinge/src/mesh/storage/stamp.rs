//! Which mesh it is, and in which state: what is remembered of a mesh holds until its vertices move.

use std::sync::atomic::{AtomicU64, Ordering};

/// A number that no other mesh of this process has had, and this one not before its last refit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::mesh) struct Stamp(u64);

impl Stamp {
    pub(in crate::mesh) fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}
