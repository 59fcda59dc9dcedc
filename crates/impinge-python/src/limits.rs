//! Limits on calls: the time and the memory that `impinge.limit` allows.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use impinge::budget::{Budget, Stopped};
use pyo3::exceptions::{PyMemoryError, PyTimeoutError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Time after a deadline in which a job may still end by itself, with the rows that are answered.
const GRACE: Duration = Duration::from_millis(100);

/// Number of [`Limits`] objects that Python holds. If it is zero, a call does not ask Python for
/// its limits.
static HELD: AtomicUsize = AtomicUsize::new(0);

/// A deadline and a number of bytes, either of which may be absent. `impinge.limit` makes one for
/// its block and keeps it in a context variable.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct Limits(Allowed);

/// Limits of a call: a deadline and a number of bytes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Allowed {
    deadline: Option<Instant>,
    bytes: Option<u64>,
}

#[pymethods]
impl Limits {
    /// Makes limits that begin now. They are at most as wide as `outer`, the limits of the block
    /// around this one.
    #[new]
    fn new(seconds: Option<f64>, gigabytes: Option<f64>, outer: Option<&Self>) -> Self {
        HELD.fetch_add(1, Ordering::Relaxed);
        let outer = outer.map(|outer| outer.0).unwrap_or_default();
        // A deadline that cannot be represented never comes.
        let own = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        let own = own.and_then(|duration| Instant::now().checked_add(duration));
        let bytes = gigabytes.map(|gigabytes| (gigabytes * 1e9) as u64);
        Self(Allowed {
            deadline: [own, outer.deadline].into_iter().flatten().min(),
            bytes: [bytes, outer.bytes].into_iter().flatten().min(),
        })
    }
}

impl Drop for Limits {
    fn drop(&mut self) {
        HELD.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Allowed {
    /// Returns what the caller allows.
    pub(crate) fn asked(py: Python<'_>) -> PyResult<Self> {
        static ASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        if HELD.load(Ordering::Relaxed) == 0 {
            return Ok(Self::default());
        }
        let limits = ASKED.import(py, "impinge._limits", "asked")?.call_method0("get")?;
        let limits: Option<PyRef<'_, Limits>> = limits.extract()?;
        Ok(limits.map(|limits| limits.0).unwrap_or_default())
    }

    /// Returns a budget with these limits that `cancel` can end.
    pub(crate) fn budget(self, cancel: &(dyn Fn() -> bool + Sync)) -> Budget<'_> {
        let mut budget = Budget::new().with_cancel(cancel);
        if let Some(deadline) = self.deadline {
            budget = budget.with_deadline(deadline);
        }
        if let Some(bytes) = self.bytes {
            budget = budget.with_memory(bytes);
        }
        budget
    }

    /// Reports whether there is no limit.
    pub(crate) fn is_everything(self) -> bool {
        self.deadline.is_none() && self.bytes.is_none()
    }

    /// Returns `wait`, or the time until [`is_late`](Self::is_late) if it is shorter.
    pub(crate) fn at_most(self, wait: Duration) -> Duration {
        self.latest_end().map_or(wait, |end| wait.min(end.saturating_duration_since(Instant::now())))
    }

    /// Reports whether the deadline has passed, and the time in which a job may end by itself.
    pub(crate) fn is_late(self) -> bool {
        self.latest_end().is_some_and(|end| Instant::now() >= end)
    }

    fn latest_end(self) -> Option<Instant> {
        self.deadline?.checked_add(GRACE)
    }
}

/// Returns the exception for work that ended before its answer was complete.
pub(crate) fn raised(stopped: Stopped) -> PyErr {
    match stopped {
        Stopped::Memory => PyMemoryError::new_err(format!(
            "{stopped}: ask for less at a time, or allow more gigabytes if impinge.limit is in effect"
        )),
        _ => PyTimeoutError::new_err(format!("{stopped} before the call ended (impinge.limit)")),
    }
}
