//! Searches for all pairs that can end without an answer.

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow;

use crate::storage::TryPush;

/// Reason why a search for pairs returns no pairs.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unfinished {
    /// The caller wanted the search to end.
    Interrupted,
    /// The memory for the pairs cannot be allocated.
    OutOfMemory(TryReserveError),
}

/// Function that returns `true` if a search must end. Several threads may call it at once.
pub type MustEnd<'m> = dyn Fn() -> bool + Sync + 'm;

/// Number of pairs between two checks whether the search must end: well below 100 microseconds of
/// work. With fewer, the checks become noticeable; with more, a search ends later.
const PAIRS_PER_CHECK: usize = 1 << 12;

/// A list of pairs that grows until memory runs out or the search must end.
pub(super) struct PairList<'m> {
    pairs: Vec<[u32; 2]>,
    must_end: &'m MustEnd<'m>,
    ended: Option<Unfinished>,
}

impl<'m> PairList<'m> {
    pub(super) fn new(must_end: &'m MustEnd<'m>) -> Self {
        Self { pairs: Vec::new(), must_end, ended: None }
    }

    /// Appends a pair. Returns `Break` if the search must end.
    #[inline]
    pub(super) fn push(&mut self, pair: [u32; 2]) -> ControlFlow<()> {
        if self.pairs.len().is_multiple_of(PAIRS_PER_CHECK) && (self.must_end)() {
            self.ended = Some(Unfinished::Interrupted);
        }
        if self.ended.is_none() {
            self.ended = self.pairs.try_push(pair).err().map(Unfinished::OutOfMemory);
        }
        if self.ended.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Returns the pairs, sorted.
    pub(super) fn into_sorted(self) -> Result<Vec<[u32; 2]>, Unfinished> {
        let Self { mut pairs, ended, .. } = self;
        pairs.sort_unstable();
        ended.map_or(Ok(pairs), Err)
    }
}

impl From<TryReserveError> for Unfinished {
    fn from(error: TryReserveError) -> Self {
        Self::OutOfMemory(error)
    }
}

impl fmt::Display for Unfinished {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => f.write_str("the search for pairs was interrupted"),
            Self::OutOfMemory(_) => f.write_str("not enough memory for the pairs"),
        }
    }
}

impl Error for Unfinished {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Interrupted => None,
            Self::OutOfMemory(error) => Some(error),
        }
    }
}
