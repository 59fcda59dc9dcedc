//! [`Budget`]: limits on the work of a query.
//!
//! Long loops check their budget about every 100 microseconds, and lists that grow with the answer
//! take their memory from it. Tests: `tests/it/engine/budgets.rs`, `tests/it/engine/canceled.rs`.

use std::collections::{HashMap, TryReserveError};
use std::error::Error;
use std::fmt;
use std::hash::Hash;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Limits on the work of one query or of several: a deadline, a number of steps, memory for the
/// answers, and a function that cancels.
///
/// A query with a budget ends soon after one of the limits is reached. It then returns the safe
/// answer: the things intersect, they are within any clearance, the lower bound of their distance
/// is zero, and the bounds of a depth are wider. A list holds what was found so far, or nothing if
/// the budget canceled the query. [`stopped`](Self::stopped) says whether a limit was reached. Until
/// then the budget changes no answer. All later queries with the same budget end at once.
///
/// Several threads may share a budget. To check it costs a few nanoseconds for every 100
/// microseconds of work.
///
/// ```
/// use std::time::Duration;
///
/// use impinge::query::Query;
/// use impinge::{Budget, Mesh, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let pile = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]; 1000])?;
/// let budget = Budget::new().with_timeout(Duration::from_secs(60)).with_memory(1 << 20);
/// let pairs = Query::new().with_budget(&budget).intersecting_pairs(&pile, &pile);
/// // A million pairs need 8 MB.
/// assert_eq!(budget.stopped(), Some(impinge::budget::Stopped::Memory));
/// assert!(pairs.len() < 1_000_000);
/// # Ok::<(), impinge::InputError>(())
/// ```
pub struct Budget<'b> {
    deadline: Option<Instant>,
    cancel: Option<&'b (dyn Fn() -> bool + Sync)>,
    /// Number of steps that are left.
    steps: Option<AtomicU64>,
    /// Number of bytes that are left.
    bytes: Option<AtomicU64>,
    /// Whether there may be limits.
    is_limited: bool,
    /// The first limit that was reached, as a number, or [`NOT_REACHED`].
    reached: AtomicU8,
}

/// Reason why work ended before its answer was complete: the limit of a [`Budget`] that was reached
/// first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stopped {
    /// The function that cancels returned `true`.
    Canceled,
    /// The deadline has passed.
    Time,
    /// The number of steps was used up.
    Steps,
    /// The answers need more memory than the budget or the system has.
    Memory,
}

/// Value of [`Budget::stopped`] before any limit is reached.
const NOT_REACHED: u8 = u8::MAX;

/// The limits in the order of their numbers.
const LIMITS: [Stopped; 4] = [Stopped::Canceled, Stopped::Time, Stopped::Steps, Stopped::Memory];

impl Budget<'static> {
    /// Returns the budget of queries that have none. It has no limit.
    #[must_use]
    pub fn unlimited() -> &'static Self {
        static UNLIMITED: Budget<'static> = Budget { is_limited: false, ..Budget::new() };
        &UNLIMITED
    }
}

impl<'b> Budget<'b> {
    /// Returns a budget that is limited only by the memory of the system.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            deadline: None,
            cancel: None,
            steps: None,
            bytes: None,
            is_limited: true,
            reached: AtomicU8::new(NOT_REACHED),
        }
    }

    /// Returns this budget with a deadline. A query ends some 100 microseconds after it.
    #[must_use]
    pub fn with_deadline(self, deadline: Instant) -> Self {
        Self { deadline: Some(deadline), ..self }
    }

    /// Returns this budget with a deadline that lies `timeout` after now.
    #[must_use]
    pub fn with_timeout(self, timeout: Duration) -> Self {
        // A deadline that cannot be represented never comes.
        Self { deadline: Instant::now().checked_add(timeout), ..self }
    }

    /// Returns this budget with a number of steps. A step is the work between two checks of the
    /// budget, about 100 microseconds. On one thread the same query always takes the same number of
    /// steps, on any machine.
    #[must_use]
    pub fn with_steps(self, steps: u64) -> Self {
        Self { steps: Some(AtomicU64::new(steps)), ..self }
    }

    /// Returns this budget with a number of bytes for lists whose length depends on the answer,
    /// such as pairs of faces. All queries with this budget share them. Memory that grows with the
    /// size of the input alone does not count.
    #[must_use]
    pub fn with_memory(self, bytes: u64) -> Self {
        Self { bytes: Some(AtomicU64::new(bytes)), ..self }
    }

    /// Returns this budget with a function that cancels: once it returns `true`, queries end. It is
    /// called about every 100 microseconds, also by several threads at once.
    #[must_use]
    pub fn with_cancel(self, cancel: &'b (dyn Fn() -> bool + Sync)) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// Returns the limit that was reached first, or `None` if all answers so far are complete.
    #[must_use]
    pub fn stopped(&self) -> Option<Stopped> {
        LIMITS.get(usize::from(self.reached.load(Ordering::Relaxed))).copied()
    }

    /// Counts a step, and reports whether the work must end. Loops call it about every 100
    /// microseconds.
    #[inline]
    pub(crate) fn is_spent(&self) -> bool {
        self.is_limited && self.is_limit_reached()
    }

    /// Counts a step, and returns an error if the work must end. A loop over many queries calls it
    /// about every 100 microseconds.
    ///
    /// # Errors
    /// Returns the limit that was reached first.
    ///
    /// ```
    /// use impinge::budget::{Budget, Stopped};
    ///
    /// let budget = Budget::new().with_steps(1);
    /// assert_eq!(budget.check(), Ok(()));
    /// assert_eq!(budget.check(), Err(Stopped::Steps));
    /// ```
    pub fn check(&self) -> Result<(), Stopped> {
        if self.is_spent() { Err(self.stopped().unwrap_or(Stopped::Canceled)) } else { Ok(()) }
    }

    fn is_limit_reached(&self) -> bool {
        if self.stopped().is_some() {
            return true;
        }
        let has_no_steps = |steps: &AtomicU64| take(steps, 1).is_err();
        if self.cancel.is_some_and(|cancel| cancel()) {
            self.reach(Stopped::Canceled);
        } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.reach(Stopped::Time);
        } else if self.steps.as_ref().is_some_and(has_no_steps) {
            self.reach(Stopped::Steps);
        }
        self.stopped().is_some()
    }

    /// Makes room for `additional` more items in a list, and takes the memory from this budget.
    /// Returns `false` if there is not enough memory; the list then stays as it is, and the budget
    /// is spent.
    ///
    /// Without a budget it ends the process if the system has not enough memory, as
    /// [`Vec::reserve`] does.
    #[must_use]
    pub(crate) fn reserve<T>(&self, list: &mut Vec<T>, additional: usize) -> bool {
        if !self.is_limited {
            list.reserve(additional);
            return true;
        }
        self.try_reserve(list, additional).is_ok()
    }

    /// Makes room in a list, as [`reserve`](Self::reserve) does. Without a budget it returns an
    /// error too, and not the end of the process.
    pub(crate) fn try_reserve<T>(&self, list: &mut Vec<T>, additional: usize) -> Result<(), Stopped> {
        if additional <= list.capacity() - list.len() {
            return Ok(());
        }
        let grown = list.len().saturating_add(additional).max(list.capacity().saturating_mul(2));
        let (added, wanted) = (grown - list.capacity(), grown - list.len());
        self.allocate(added.saturating_mul(size_of::<T>()), || list.try_reserve_exact(wanted))
    }

    /// Makes room for `additional` more entries in a map, as [`reserve`](Self::reserve) does in a
    /// list.
    #[must_use]
    pub(crate) fn reserve_entries<K: Eq + Hash, V>(&self, map: &mut HashMap<K, V>, additional: usize) -> bool {
        if !self.is_limited || additional <= map.capacity() - map.len() {
            return true;
        }
        let added = additional.max(map.len());
        self.allocate(added.saturating_mul(size_of::<(K, V)>()), || map.try_reserve(added)).is_ok()
    }

    /// Takes bytes from this budget and allocates them. Returns an error, and records that memory
    /// ran out, if either fails.
    fn allocate(&self, bytes: usize, allocate: impl FnOnce() -> Result<(), TryReserveError>) -> Result<(), Stopped> {
        let is_allowed = self.bytes.as_ref().is_none_or(|left| take(left, bytes as u64).is_ok());
        if is_allowed && allocate().is_ok() {
            return Ok(());
        }
        self.reach(Stopped::Memory);
        Err(Stopped::Memory)
    }

    /// Records that a limit is reached, unless another one was reached before.
    pub(crate) fn reach(&self, limit: Stopped) {
        if self.is_limited {
            self.reached.compare_exchange(NOT_REACHED, limit as u8, Ordering::Relaxed, Ordering::Relaxed).ok();
        }
    }
}

/// Takes an amount from what is left, or takes nothing if less is left.
fn take(left: &AtomicU64, amount: u64) -> Result<u64, u64> {
    left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(amount))
}

impl Default for Budget<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { deadline, cancel, steps, bytes, is_limited: _, reached: _ } = self;
        f.debug_struct("Budget")
            .field("deadline", deadline)
            .field("has_cancel", &cancel.is_some())
            .field("steps", steps)
            .field("bytes", bytes)
            .field("stopped", &self.stopped())
            .finish()
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Canceled => "the work was canceled",
            Self::Time => "the time limit was reached",
            Self::Steps => "the limit of steps was reached",
            Self::Memory => "not enough memory for the answers",
        })
    }
}

impl Error for Stopped {}

impl From<TryReserveError> for Stopped {
    fn from(_: TryReserveError) -> Self {
        Self::Memory
    }
}
