//! Identifies a mesh and its state, so that a value cached for a mesh is used only until its
//! vertices move.

use std::sync::atomic::{AtomicU64, Ordering};

/// A number that is unique in this process: no other mesh has had it, nor this mesh before its last
/// refit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::mesh) struct Stamp(u64);

impl Stamp {
    /// Returns a new stamp.
    pub(in crate::mesh) fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}
