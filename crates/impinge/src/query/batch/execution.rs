//! Rows that are given to threads.

use std::fmt;
use std::ops::Range;

use rayon::prelude::*;

use crate::budget::{Budget, Stopped};

/// Number of blocks that rows are divided into, if blocks do not become too long: enough for many
/// threads.
const BLOCKS: usize = 64;

/// Maximum number of rows of a block. In longer blocks more rows start from the state of the row
/// before, but the work is divided less evenly between threads.
const MAX_BLOCK_ROWS: usize = 64;

/// Number of blocks that are answered before their answers are moved into one array. This avoids a
/// second copy of all answers in memory.
const BLOCKS_PER_WAVE: usize = 1 << 12;

/// Options of a batch: the threads that answer its rows, a budget, and a progress callback.
///
/// One thread answers a block of consecutive rows, so that each row can start from the state of the
/// row before. The length of a block depends on the number of rows alone: one row if there are up
/// to 64 rows, and 64 rows at most. On the caller's thread all rows are one block.
///
/// ```
/// use impinge::query::batch::Execution;
///
/// let squares = Execution::default().rows(4, || (), |(), row| row * row)?;
/// assert_eq!(squares, [0, 1, 4, 9]);
/// # Ok::<(), impinge::budget::Stopped>(())
/// ```
#[derive(Clone, Copy)]
pub struct Execution<'e> {
    is_sequential: bool,
    budget: &'e Budget<'e>,
    progress: Option<&'e (dyn Fn(usize) + Sync)>,
}

impl Default for Execution<'_> {
    /// Returns the default: all threads of the current rayon pool, without limits.
    fn default() -> Self {
        Self { is_sequential: false, budget: Budget::unlimited(), progress: None }
    }
}

impl<'e> Execution<'e> {
    /// Returns these options with all rows on the caller's thread.
    #[must_use]
    pub fn sequentially(self) -> Self {
        Self { is_sequential: true, ..self }
    }

    /// Returns these options with limits on the work of the whole batch. The budget is checked
    /// before each row, and within rows of long queries.
    #[must_use]
    pub fn with_budget(self, budget: &'e Budget<'e>) -> Self {
        Self { budget, ..self }
    }

    /// Returns these options with a callback. After each block it receives the number of rows in
    /// the block. Several threads may call it at the same time.
    #[must_use]
    pub fn with_progress(self, progress: &'e (dyn Fn(usize) + Sync)) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// Returns the limits on the work of the batch.
    #[must_use]
    pub fn budget(&self) -> &'e Budget<'e> {
        self.budget
    }

    /// Returns these options without a progress callback.
    pub(crate) fn without_progress(self) -> Self {
        Self { progress: None, ..self }
    }

    /// Returns the result of `ask` for each of `count` rows, in order. `ask` gets the state of its
    /// block and the index of the row. `begin` makes the state of each block of consecutive rows.
    ///
    /// # Errors
    /// [`Stopped`] if a limit of the budget was reached, or if the memory for the answers cannot be
    /// allocated.
    pub fn rows<S, T: Send>(
        self,
        count: usize,
        begin: impl Fn() -> S + Sync,
        ask: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let answers = self.rows_until(|| self.budget.is_spent(), count, begin, ask)?;
        self.budget.stopped().map_or(Ok(answers), Err)
    }

    /// Returns the result of `ask` for each row, as [`rows`](Self::rows) does, but only a canceled
    /// batch stops. Once another limit is reached, `ask` must return an answer without work.
    ///
    /// # Errors
    /// [`Stopped`] if the batch was canceled, or if the memory for the answers cannot be allocated.
    pub(crate) fn all_rows<S, T: Send>(
        self,
        count: usize,
        begin: impl Fn() -> S + Sync,
        ask: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let answers = self.rows_until(|| self.is_canceled(), count, begin, ask)?;
        if self.budget.stopped() == Some(Stopped::Canceled) { Err(Stopped::Canceled) } else { Ok(answers) }
    }

    /// Returns the result of `ask` for each row, as [`all_rows`](Self::all_rows) does. Each row is a
    /// task of its own, for rows that share nothing and may take long.
    pub(crate) fn single_rows<T: Send>(self, count: usize, ask: impl Fn(usize) -> T + Sync) -> Result<Vec<T>, Stopped> {
        if self.is_sequential {
            return self.all_rows(count, || (), |(), row| ask(row));
        }
        let mut answers = self.reserved(count)?;
        let answer = |row: usize| {
            let answer = (!self.is_canceled()).then(|| ask(row));
            self.progress.iter().for_each(|progress| progress(1));
            answer
        };
        (0..count).into_par_iter().with_max_len(1).map(answer).collect_into_vec(&mut answers);
        if self.is_canceled() { Err(Stopped::Canceled) } else { Ok(answers.into_iter().flatten().collect()) }
    }

    fn is_canceled(&self) -> bool {
        self.budget.is_spent() && self.budget.stopped() == Some(Stopped::Canceled)
    }

    /// Returns memory for the answers of `count` rows.
    fn reserved<T>(&self, count: usize) -> Result<Vec<T>, Stopped> {
        let mut answers = Vec::new();
        if answers.try_reserve_exact(count).is_err() {
            self.budget.reach(Stopped::Memory);
            return Err(Stopped::Memory);
        }
        Ok(answers)
    }

    /// Returns the result of `ask` for each row. If `must_stop` returns `true`, only some of the
    /// rows are answered.
    fn rows_until<S, T: Send>(
        self,
        must_stop: impl Fn() -> bool + Sync,
        count: usize,
        begin: impl Fn() -> S + Sync,
        ask: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let mut answers = self.reserved(count)?;
        if self.is_sequential {
            self.answer_rows(0..count, &mut begin(), &ask, &must_stop, &mut answers);
        } else {
            let length = count.div_ceil(BLOCKS).clamp(1, MAX_BLOCK_ROWS);
            let blocks = count.div_ceil(length);
            for first in (0..blocks).step_by(BLOCKS_PER_WAVE) {
                let wave: Vec<Vec<T>> = (first..blocks.min(first + BLOCKS_PER_WAVE))
                    .into_par_iter()
                    .with_max_len(1) // a free thread can take any block that has not begun
                    .map(|number| {
                        let rows = number * length..((number + 1) * length).min(count);
                        let mut answers = Vec::with_capacity(rows.len());
                        self.answer_rows(rows, &mut begin(), &ask, &must_stop, &mut answers);
                        answers
                    })
                    .collect();
                answers.extend(wave.into_iter().flatten());
            }
        }
        Ok(answers)
    }

    /// Appends the answers of consecutive rows, each of which can start from the state of the row
    /// before. Stops before the next row once `must_stop` returns `true`.
    fn answer_rows<S, T>(
        &self,
        rows: Range<usize>,
        state: &mut S,
        ask: &impl Fn(&mut S, usize) -> T,
        must_stop: &impl Fn() -> bool,
        answers: &mut Vec<T>,
    ) {
        let count = rows.len();
        for row in rows {
            if must_stop() {
                return;
            }
            answers.push(ask(state, row));
        }
        if let Some(progress) = self.progress {
            progress(count);
        }
    }
}

impl fmt::Debug for Execution<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { is_sequential, budget, progress } = self;
        f.debug_struct("Execution")
            .field("is_sequential", is_sequential)
            .field("budget", budget)
            .field("has_progress", &progress.is_some())
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    #[test]
    fn single_rows_are_those_of_blocks() {
        let square = |row: usize| row * row;
        for count in [0, 1, 63, 1000] {
            let (rows, calls) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let count_rows = |done: usize| {
                rows.fetch_add(done, Relaxed);
                calls.fetch_add(1, Relaxed);
            };
            let execution = Execution::default().with_progress(&count_rows);
            let single = execution.single_rows(count, square);
            assert_eq!((rows.load(Relaxed), calls.load(Relaxed)), (count, count));
            assert_eq!(single, execution.all_rows(count, || (), |(), row| square(row)));
            assert_eq!(single, execution.sequentially().single_rows(count, square));
        }
    }

    /// A spent budget leaves all rows to `ask`; a canceled one returns none of them.
    #[test]
    fn only_a_canceled_batch_of_single_rows_stops() {
        let (spent, canceled) = (Budget::new().with_steps(0), Budget::new().with_cancel(&|| true));
        for sequential in [false, true] {
            let on = |budget| {
                let execution = Execution::default().with_budget(budget);
                if sequential { execution.sequentially() } else { execution }.single_rows(100, |row| row)
            };
            assert_eq!(on(&spent), Ok((0..100).collect()));
            assert_eq!(on(&canceled), Err(Stopped::Canceled));
        }
    }
}
