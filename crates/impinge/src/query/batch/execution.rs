//! Rows shared out to threads.

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::mesh::Interrupt;

/// Number of blocks that rows are divided into, unless blocks would be too long: enough for many threads.
const BLOCKS: usize = 64;

/// Maximum number of rows of a block. Longer blocks learn more from row to row, but balance threads worse.
const LONGEST_BLOCK: usize = 64;

/// Number of blocks that are answered before their answers are put into one array, so that memory for a second copy of all
/// answers is never needed.
const WAVE: usize = 1 << 12;

/// How rows are answered: on which threads, until when, and who hears how far they are.
///
/// A block of consecutive rows is answered by one thread, so that a row may learn from the row before it. How many rows a block has
/// depends on their number alone: one if there are up to 64 rows, and at most 64. On the caller's thread all rows are one block.
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

/// Why there are no answers.
#[derive(Debug)]
#[non_exhaustive]
pub enum Stopped {
    /// The interrupt asked for it.
    Interrupted,
    /// There is no memory for this many answers.
    OutOfMemory(TryReserveError),
}

impl Default for Execution<'_> {
    /// On all threads of the current rayon pool, to the end.
    fn default() -> Self {
        Self { is_sequential: false, interrupt: Interrupt::NEVER, progress: None }
    }
}

impl<'e> Execution<'e> {
    /// Keeps all rows on the caller's thread.
    #[must_use]
    pub fn sequentially(self) -> Self {
        Self { is_sequential: true, ..self }
    }

    /// Gives up once the interrupt asks for it. It is asked before each row, and within those that it can end early.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt<'e>) -> Self {
        Self { interrupt, ..self }
    }

    /// Calls `progress` with the number of rows of each block that is done. Several threads may call it at once.
    #[must_use]
    pub fn with_progress(self, progress: &'e (dyn Fn(usize) + Sync)) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// Says nothing of how far the rows are.
    pub(crate) fn without_progress(self) -> Self {
        Self { progress: None, ..self }
    }

    /// Asks `ask` about each row, with an interrupt that ends it early too. Each block of consecutive rows starts with what `begin`
    /// returns.
    ///
    /// # Errors
    /// [`Stopped`] if the interrupt asked for it, or if there is no memory for the answers.
    pub fn rows<S, T: Send>(
        self,
        count: usize,
        begin: impl Fn() -> S + Sync,
        ask: impl Fn(&mut S, usize, Interrupt<'_>) -> T + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let mut answers = Vec::new();
        answers.try_reserve_exact(count).map_err(Stopped::OutOfMemory)?;
        // A row that ended early has no answer. One that ended before anybody asked has.
        let is_stopped = AtomicBool::new(false);
        let is_wanted = || {
            let is_wanted = is_stopped.load(Ordering::Relaxed) || self.interrupt.is_wanted();
            is_stopped.fetch_or(is_wanted, Ordering::Relaxed);
            is_wanted
        };
        if self.is_sequential {
            self.answer_rows(0..count, &mut begin(), &ask, &is_wanted, &mut answers);
        } else {
            let length = count.div_ceil(BLOCKS).clamp(1, LONGEST_BLOCK);
            let blocks = count.div_ceil(length);
            for first in (0..blocks).step_by(WAVE) {
                let wave: Vec<Vec<T>> = (first..blocks.min(first + WAVE))
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

    /// Answers consecutive rows, each of which may learn from the row before it. It stops once that is wanted.
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
            Self::Interrupted => f.write_str("the work was interrupted"),
            Self::OutOfMemory(_) => f.write_str("there is no memory for the answers"),
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
