//! Lists of the pairs that a search finds, within a budget.

use std::ops::ControlFlow;

use crate::budget::{Budget, Stopped};

/// Number of pairs between two checks of the budget: well below 100 microseconds of work. With
/// fewer, the checks become noticeable; with more, a search ends later.
const PAIRS_PER_CHECK: usize = 1 << 12;

/// A list of pairs that grows until the budget is spent or memory runs out.
pub(super) struct PairList<'b> {
    pairs: Vec<[u32; 2]>,
    budget: &'b Budget<'b>,
    stopped: Option<Stopped>,
}

impl<'b> PairList<'b> {
    pub(super) fn new(budget: &'b Budget<'b>) -> Self {
        Self { pairs: Vec::new(), budget, stopped: None }
    }

    /// Appends a pair. Returns `Break` if the search must end.
    #[inline]
    pub(super) fn push(&mut self, pair: [u32; 2]) -> ControlFlow<()> {
        if self.pairs.len().is_multiple_of(PAIRS_PER_CHECK) && self.budget.is_spent() {
            self.stopped = self.budget.stopped();
        }
        if self.stopped.is_none() && self.pairs.len() == self.pairs.capacity() {
            self.stopped = self.budget.try_reserve(&mut self.pairs, 1).err();
        }
        if self.stopped.is_some() {
            return ControlFlow::Break(());
        }
        self.pairs.push(pair);
        ControlFlow::Continue(())
    }

    /// Returns the pairs, sorted.
    pub(super) fn into_sorted(self) -> Result<Vec<[u32; 2]>, Stopped> {
        let Self { mut pairs, stopped, .. } = self;
        pairs.sort_unstable();
        stopped.map_or(Ok(pairs), Err)
    }
}
