//! Jobs that are done again and again, as the steps of a world: how long the last one took tells
//! where the next one runs.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use impinge::budget::Budget;
use pyo3::prelude::*;

use crate::workers;

/// Maximum time of a job after which the next one runs on the caller's thread. Waking the pool
/// takes a part of it.
const MAX_ON_CALLER: Duration = Duration::from_micros(200);

/// Nanoseconds that the last job took.
pub(crate) struct Pace(AtomicU64);

impl Pace {
    /// Returns a pace whose first job runs on the pool.
    pub(crate) fn new() -> Self {
        Self(AtomicU64::new(u64::MAX))
    }

    /// Runs a job, which may be canceled and must check its budget: on the caller's thread if the
    /// last one was short, or else on the pool.
    pub(crate) fn run<T: Send + 'static>(
        &self,
        py: Python<'_>,
        job: impl Fn(&Budget<'_>) -> T + Send + Sync + 'static,
    ) -> PyResult<T> {
        let timed = move |budget: &Budget<'_>| {
            let begun = Instant::now();
            (job(budget), begun.elapsed())
        };
        let is_short = self.0.load(Ordering::Relaxed) <= MAX_ON_CALLER.as_nanos() as u64;
        let (done, took) = if is_short { workers::run_on_caller(py, timed)? } else { workers::run(py, timed)? };
        self.0.store(took.as_nanos() as u64, Ordering::Relaxed);
        Ok(done)
    }
}
