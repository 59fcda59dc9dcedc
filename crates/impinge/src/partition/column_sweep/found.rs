//! Pairs that a sweep found, in memory that may run out.

use crate::budget::{Budget, Stopped};

/// Pairs that a thread found, unsorted.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    pub(super) pairs: Vec<[u32; 2]>,
    /// Reason why the search ended early.
    pub(super) ended: Option<Stopped>,
}

impl Found {
    /// Reserves memory for more pairs. Returns `false` if the search ended.
    #[inline]
    pub(super) fn reserve(&mut self, count: usize, budget: &Budget<'_>) -> bool {
        if self.ended.is_none() && self.pairs.capacity() - self.pairs.len() < count {
            self.ended = budget.try_reserve(&mut self.pairs, count).err();
        }
        self.ended.is_none()
    }

    #[inline]
    pub(super) fn push(&mut self, pair: [u32; 2], budget: &Budget<'_>) {
        if self.reserve(1, budget) {
            self.pairs.push(pair);
        }
    }
}
