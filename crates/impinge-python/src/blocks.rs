//! Rows that are answered in blocks, so that the rows of a block share working memory.

use std::ops::Range;

use impinge::InputError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::workers::{self, Call, MAX_ROWS_ON_CALLER};

/// Number of rows that a thread takes at a time.
const BLOCK: usize = 256;

/// Length of a call.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Length {
    /// The caller's thread does all of it.
    Brief,
    /// A row takes microseconds in almost all cases, as a search down one tree does.
    Quick,
    /// The first row may take long.
    Long,
}

/// Returns the answers of `ask`, which gets the range of a block of rows, for all of them.
///
/// # Errors
/// The exception of a signal that ends the wait, or `MemoryError`.
pub(crate) fn answers<T: Send + 'static>(
    py: Python<'_>,
    rows: usize,
    length: Length,
    ask: impl Fn(Range<usize>) -> Result<Vec<T>, InputError> + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    let mut answers = Vec::with_capacity(rows);
    each(py, rows, length, ask)?.into_iter().for_each(|block| answers.extend(block));
    Ok(answers)
}

/// Returns the answer of `ask` for each block of rows, in their order.
///
/// # Errors
/// As for [`answers`].
pub(crate) fn each<B: Send + 'static>(
    py: Python<'_>,
    rows: usize,
    length: Length,
    ask: impl Fn(Range<usize>) -> Result<B, InputError> + Send + Sync + 'static,
) -> PyResult<Vec<B>> {
    let is_quick = length == Length::Quick && rows <= MAX_ROWS_ON_CALLER;
    let size = if is_quick { 1 } else { BLOCK };
    let count = rows.div_ceil(size);
    let block = move |at: usize| ask(at * size..rows.min((at + 1) * size));
    let blocks = if is_quick {
        workers::quick_rows(py, count, block)?
    } else {
        workers::rows(py, Call { rows: count, is_brief: length == Length::Brief, progress: false }, block)?
    };
    let checked = blocks.into_iter().map(|block| block.map_err(|error| PyRuntimeError::new_err(error.to_string())));
    checked.collect()
}
