//! Rows that are given to threads.

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::mesh::Interrupt;
use crate::partition::Unfinished;

/// Number of blocks that rows are divided into, if blocks do not become too long: enough for many
/// threads.
const BLOCKS: usize = 64;

/// Maximum number of rows of a block. In longer blocks more rows start from the state of the row
/// before, but the work is divided less evenly between threads.
const MAX_BLOCK_ROWS: usize = 64;

/// Number of blocks that are answered before their answers are moved into one array. This avoids a
/// second copy of all answers in memory.
const BLOCKS_PER_WAVE: usize = 1 << 12;

/// Options of a batch: the threads that answer its rows, an interrupt, and a progress callback.
///
/// One thread answers a block of consecutive rows, so that each row can start from the state of the
/// row before. The length of a block depends on the number of rows alone: one row if there are up
/// to 64 rows, and 64 rows at most. On the caller's thread all rows are one block.
///
/// ```
/// use impinge::query::batch::Execution;
///
/// let squares = Execution::default().rows(4, || (), |(), row, _| row * row)?;
/// assert_eq!(squares, [0, 1, 4, 9]);
/// # Ok::<(), impinge::query::batch::Stopped>(())
/// ```
#[derive(Clone, Copy)]
pub struct Execution<'e> {
    is_sequential: bool,
    interrupt: Interrupt<'e>,
    progress: Option<&'e (dyn Fn(usize) + Sync)>,
}

/// Reason why a batch returns no answers.
#[derive(Debug)]
#[non_exhaustive]
pub enum Stopped {
    /// The interrupt ended the batch.
    Interrupted,
    /// The memory for the answers cannot be allocated.
    OutOfMemory(TryReserveError),
}

impl Default for Execution<'_> {
    /// Returns the default: all threads of the current rayon pool, without an interrupt.
    fn default() -> Self {
        Self { is_sequential: false, interrupt: Interrupt::NEVER, progress: None }
    }
}

impl<'e> Execution<'e> {
    /// Returns these options with all rows on the caller's thread.
    #[must_use]
    pub fn sequentially(self) -> Self {
        Self { is_sequential: true, ..self }
    }

    /// Returns these options with an interrupt that ends the batch without answers. It is checked
    /// before each row, and within rows of queries that can end early.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt<'e>) -> Self {
        Self { interrupt, ..self }
    }

    /// Returns these options with a callback. After each block it receives the number of rows in
    /// the block. Several threads may call it at the same time.
    #[must_use]
    pub fn with_progress(self, progress: &'e (dyn Fn(usize) + Sync)) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// Returns the interrupt.
    pub(crate) fn interrupt(self) -> Interrupt<'e> {
        self.interrupt
    }

    /// Returns these options without a progress callback.
    pub(crate) fn without_progress(self) -> Self {
        Self { progress: None, ..self }
    }

    /// Returns the result of `ask` for each of `count` rows, in order. `ask` gets the state of its
    /// block, the index of the row, and an interrupt that can end the row early. `begin` makes the
    /// state of each block of consecutive rows.
    ///
    /// # Errors
    /// [`Stopped`] if the interrupt ended the batch, or if the memory for the answers cannot be
    /// allocated.
    pub fn rows<S, T: Send>(
        self,
        count: usize,
        begin: impl Fn() -> S + Sync,
        ask: impl Fn(&mut S, usize, Interrupt<'_>) -> T + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let mut answers = Vec::new();
        answers.try_reserve_exact(count).map_err(Stopped::OutOfMemory)?;
        // A row that was interrupted has no valid answer. A row that ended before the interrupt has
        // one.
        let is_stopped = AtomicBool::new(false);
        let is_wanted = || {
            let is_wanted = is_stopped.load(Ordering::Relaxed) || self.interrupt.is_wanted();
            // Threads that go on only read the flag, so they do not wait for each other.
            if is_wanted {
                is_stopped.store(true, Ordering::Relaxed);
            }
            is_wanted
        };
        if self.is_sequential {
            self.answer_rows(0..count, &mut begin(), &ask, &is_wanted, &mut answers);
        } else {
            let length = count.div_ceil(BLOCKS).clamp(1, MAX_BLOCK_ROWS);
            let blocks = count.div_ceil(length);
            for first in (0..blocks).step_by(BLOCKS_PER_WAVE) {
                let wave: Vec<Vec<T>> = (first..blocks.min(first + BLOCKS_PER_WAVE))
                    .into_par_iter()
                    .map(|number| {
                        let rows = number * length..((number + 1) * length).min(count);
                        let mut answers = Vec::with_capacity(rows.len());
                        self.answer_rows(rows, &mut begin(), &ask, &is_wanted, &mut answers);
                        answers
                    })
                    .collect();
                answers.extend(wave.into_iter().flatten());
            }
        }
        if is_stopped.into_inner() { Err(Stopped::Interrupted) } else { Ok(answers) }
    }

    /// Appends the answers of consecutive rows, each of which can start from the state of the row
    /// before. Stops before the next row once `is_wanted` returns `true`.
    fn answer_rows<S, T>(
        &self,
        rows: Range<usize>,
        state: &mut S,
        ask: &impl Fn(&mut S, usize, Interrupt<'_>) -> T,
        is_wanted: &(impl Fn() -> bool + Sync),
        answers: &mut Vec<T>,
    ) {
        let count = rows.len();
        for row in rows {
            if is_wanted() {
                return;
            }
            answers.push(ask(state, row, Interrupt::when(is_wanted)));
        }
        if let Some(progress) = self.progress {
            progress(count);
        }
    }
}

impl fmt::Debug for Execution<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { is_sequential, interrupt, progress } = self;
        f.debug_struct("Execution")
            .field("is_sequential", is_sequential)
            .field("interrupt", interrupt)
            .field("has_progress", &progress.is_some())
            .finish()
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => f.write_str("the batch was interrupted"),
            Self::OutOfMemory(_) => f.write_str("not enough memory for the answers"),
        }
    }
}

impl From<Unfinished> for Stopped {
    fn from(unfinished: Unfinished) -> Self {
        match unfinished {
            Unfinished::Interrupted => Self::Interrupted,
            Unfinished::OutOfMemory(error) => Self::OutOfMemory(error),
        }
    }
}

impl Error for Stopped {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Interrupted => None,
            Self::OutOfMemory(error) => Some(error),
        }
    }
}
