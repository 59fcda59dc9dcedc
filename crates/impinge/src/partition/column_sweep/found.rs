//! Pairs that a sweep found, in memory that may run out.

use super::super::Unfinished;

/// Pairs that a thread found, unsorted.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    pub(super) pairs: Vec<[u32; 2]>,
    /// Reason why the search ended early.
    pub(super) ended: Option<Unfinished>,
}

impl Found {
    /// Reserves memory for more pairs. Returns `false` if the search ended.
    #[inline]
    pub(super) fn reserve(&mut self, count: usize) -> bool {
        if self.ended.is_none() && self.pairs.capacity() - self.pairs.len() < count {
            self.ended = self.pairs.try_reserve(count).err().map(Unfinished::OutOfMemory);
        }
        self.ended.is_none()
    }

    #[inline]
    pub(super) fn push(&mut self, pair: [u32; 2]) {
        if self.reserve(1) {
            self.pairs.push(pair);
        }
    }
}
