//! The thread that answers a question about two bodies: the caller's thread, without preparations
//! if the bodies are small.

use std::sync::Arc;

use impinge::budget::Budget;
use impinge::query::batch::Execution;
use pyo3::prelude::*;

use crate::fcl_object::Placed;
use crate::limits::Allowed;
use crate::workers::{self, Call};

/// Maximum number of pairs of pieces of a question that is answered at once. It takes microseconds,
/// so that nobody waits for a signal or for the interpreter. More pairs are answered with checks
/// for signals, detached from the interpreter.
const MAX_PAIRS_AT_ONCE: u64 = 1 << 10;

/// Asks about two bodies on the caller's thread. If `is_one_thread` is not set and this takes long,
/// the pool takes over.
pub(crate) fn about_two<T: Send + 'static>(
    py: Python<'_>,
    [a, b]: [Arc<Placed>; 2],
    is_one_thread: bool,
    ask: impl Fn(&Placed, &Placed, &Budget<'_>) -> T + Send + Sync + 'static,
) -> PyResult<T> {
    let pairs = a.body.weight.max(1).saturating_mul(b.body.weight.max(1));
    if pairs <= MAX_PAIRS_AT_ONCE && Allowed::asked(py)?.is_everything() {
        workers::work_alone();
        return Ok(ask(&a, &b, Budget::unlimited()));
    }
    let call = Call { rows: 1, is_brief: true, progress: false };
    let (found, _) = workers::execute_interruptibly(py, call, is_one_thread, move |execution: Execution<'_>| {
        let found = ask(&a, &b, execution.budget());
        // An answer of a spent budget is not complete.
        execution.budget().stopped().map_or(Ok(found), Err)
    })?;
    Ok(found)
}
