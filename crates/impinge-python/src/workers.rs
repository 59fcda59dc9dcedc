//! The threads that do the work: the caller's thread if the work is short or needs only one thread,
//! and otherwise a pool of threads. Meanwhile the caller's thread checks for Ctrl-C.
//!
//! Waking a pool takes about 30 microseconds, and finding a first hit takes one. So work that can
//! be interrupted starts on the caller's thread, however large the meshes are.
//!
//! Threads do not survive a fork, so the child forgets the pools of its parent (`impinge._threads`
//! calls `after_fork`). Pools are looked up and made while the thread is attached to the
//! interpreter, as it is when Python forks. So the child never inherits the lock in a locked state.

use std::cell::OnceCell;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use impinge::budget::{Budget, Stopped};
use impinge::query::batch::Execution;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::limits::{self, Allowed};

/// Maximum time until a signal is noticed: short for a person, long for a processor.
pub(crate) const LISTENING_INTERVAL: Duration = Duration::from_millis(20);

/// Maximum number of pools that are kept: the pool of all processors and the last few other sizes.
const MAX_POOLS: usize = 4;

/// Time that the caller's thread works on rows before the pool takes over. It is several times the
/// time that waking the pool takes.
const PATIENCE: Duration = Duration::from_micros(200);

/// Maximum number of rows of a call that the caller's thread starts.
pub(crate) const MAX_ROWS_ON_CALLER: usize = 16;

/// Size of a call, and how to run it.
#[derive(Clone, Copy)]
pub(crate) struct Call {
    pub(crate) rows: usize,
    /// Whether the call is so short that the caller's thread does it.
    pub(crate) is_brief: bool,
    /// Whether the caller wants to see the progress.
    pub(crate) progress: bool,
}

/// State that the caller's thread shares with the threads that work for it.
#[derive(Clone, Default)]
struct Watch(Arc<Shared>);

#[derive(Default)]
struct Shared {
    /// Whether the caller stopped waiting for the answer.
    abandoned: AtomicBool,
    /// Number of rows that are answered.
    done: AtomicUsize,
}

impl Watch {
    fn is_abandoned(&self) -> bool {
        self.0.abandoned.load(Ordering::Relaxed)
    }
}

/// Number of forks between the process that imported the module and this process.
static FORKS: AtomicUsize = AtomicUsize::new(0);

/// Pools with their numbers of threads; the last used pool is last.
static POOLS: Mutex<Vec<(usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// Limits rayon's default pool to one thread, so that work on a caller's thread does not use
/// others.
pub(crate) fn limit_default_pool() {
    // This fails only if the pool already exists, and that pool has one thread too.
    ThreadPoolBuilder::new().num_threads(1).build_global().ok();
}

/// Forgets all pools. Python must call it in the child after each fork.
#[pyfunction]
pub(crate) fn after_fork() {
    FORKS.fetch_add(1, Ordering::Relaxed);
    // Dropping the pools would send signals to threads that do not exist in this process.
    std::mem::forget(std::mem::take(&mut *POOLS.lock().unwrap_or_else(PoisonError::into_inner)));
}

/// Returns the number of forks between the process that imported the module and this process. State
/// that was made with another number belongs to a parent, whose threads may have left it locked.
pub(crate) fn forks() -> usize {
    FORKS.load(Ordering::Relaxed)
}

/// Makes the caller's thread do its parallel work alone: it becomes the only thread of a pool.
/// Otherwise every parallel loop would be handed to the default pool, which takes 10 microseconds,
/// and the default pool of a forked process has no thread.
pub(crate) fn work_alone() {
    thread_local! {
        static ALONE: OnceCell<()> = const { OnceCell::new() };
    }
    ALONE.with(|alone| {
        alone.get_or_init(|| {
            let own = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
            std::mem::forget(own); // this thread is its only one, as long as it lives
        });
    });
}

/// Runs a short job on the caller's thread, detached from the interpreter.
pub(crate) fn at_once<T: Send>(py: Python<'_>, job: impl FnOnce() -> T + Send) -> T {
    py.detach(|| {
        work_alone();
        job()
    })
}

/// Runs a job on the pool and waits for its answer. If a signal handler raises, as the one of
/// Ctrl-C does, or if a limit of the caller is reached, the wait ends at once. The job is then
/// abandoned: its budget is spent, and it ends at its next check.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    job: impl FnOnce(&Budget<'_>) -> T + Send + 'static,
) -> PyResult<T> {
    match run_watched(py, |_| Ok(()), |_, budget| job(budget))? {
        (answer, None) => Ok(answer),
        (_, Some(stopped)) => Err(limits::raised(stopped)),
    }
}

/// Runs a job as [`run`] does, and calls `listen` between two waits. An error of `listen` ends the
/// call. Returns the answer, and the limit that was reached if the answer is not complete.
fn run_watched<T: Send + 'static>(
    py: Python<'_>,
    listen: impl Fn(&Watch) -> PyResult<()>,
    job: impl FnOnce(&Watch, &Budget<'_>) -> T + Send + 'static,
) -> PyResult<(T, Option<Stopped>)> {
    let allowed = Allowed::asked(py)?;
    let pool = pool(requested_threads(py)?)?;
    let watch = Watch::default();
    let (sender, mut receiver) = mpsc::sync_channel(1);
    let watched = watch.clone();
    pool.spawn(move || {
        let is_abandoned = || watched.is_abandoned();
        let budget = allowed.budget(&is_abandoned);
        let answer = job(&watched, &budget);
        sender.send((answer, budget.stopped())).ok(); // it fails if the job was abandoned
    });
    loop {
        let wait = allowed.at_most(LISTENING_INTERVAL);
        // A receiver can be moved between threads but not shared.
        let heard = py.detach(move || (receiver.recv_timeout(wait), receiver));
        receiver = heard.1;
        match heard.0 {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => {
                let must_end = || if allowed.is_late() { Err(limits::raised(Stopped::Time)) } else { Ok(()) };
                if let Err(raised) = py.check_signals().and_then(|()| listen(&watch)).and_then(|()| must_end()) {
                    watch.0.abandoned.store(true, Ordering::Relaxed);
                    return Err(raised);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a worker thread of impinge ended without an answer"));
            }
        }
    }
}

/// Returns the answers of `ask` for all rows, on all threads. A brief call runs on the caller's
/// thread.
pub(crate) fn rows<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    ask: impl Fn(usize) -> T + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    // If a limit is reached, `Execution::rows` returns the error that is raised.
    Ok(execute(py, call, move |execution| execution.rows(call.rows, || (), |(), row| ask(row)))?.0)
}

/// Returns the answers of `ask` for rows that take microseconds each in almost all cases, as a
/// search down one tree does. The caller's thread starts a call of few rows, and the pool takes
/// over if that takes long.
pub(crate) fn quick_rows<T: Send + 'static>(
    py: Python<'_>,
    rows: usize,
    ask: impl Fn(usize) -> T + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    let call = Call { rows, is_brief: true, progress: false };
    let work = move |execution: Execution<'_>| execution.rows(rows, || (), |(), row| ask(row));
    Ok(execute_interruptibly(py, call, true, work)?.0)
}

/// Does work on rows, on all threads. A brief call runs on the caller's thread. Returns the result,
/// and the limit that was reached if it is not complete.
pub(crate) fn execute<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    work: impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync + 'static,
) -> PyResult<(T, Option<Stopped>)> {
    if !call.is_brief {
        return on_pool(py, call, work);
    }
    let allowed = Allowed::asked(py)?;
    if !allowed.is_everything() {
        return on_callers_thread(py, allowed, None, &work)?.map_err(limits::raised);
    }
    let done = py.detach(|| {
        work_alone();
        work(Execution::default().sequentially())
    });
    done.map(|done| (done, None)).map_err(limits::raised)
}

/// Runs a job that checks its budget on the caller's thread, which checks for signals meanwhile.
/// For jobs that are known to be short.
pub(crate) fn run_on_caller<T: Send>(py: Python<'_>, job: impl Fn(&Budget<'_>) -> T + Send + Sync) -> PyResult<T> {
    let work = |execution: Execution<'_>| Ok(job(execution.budget()));
    match on_callers_thread(py, Allowed::asked(py)?, None, &work)? {
        Ok((answer, None)) => Ok(answer),
        Ok((_, Some(stopped))) | Err(stopped) => Err(limits::raised(stopped)),
    }
}

/// Does work as [`execute`] does, for work that checks its budget within a row. The caller's thread
/// starts a call of few rows, however large the meshes are. If that takes long, the pool takes
/// over, unless there is one row and `is_one_thread` says that one thread does all of it.
pub(crate) fn execute_interruptibly<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    is_one_thread: bool,
    work: impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync + 'static,
) -> PyResult<(T, Option<Stopped>)> {
    if call.is_brief && call.rows <= MAX_ROWS_ON_CALLER {
        let patience = if call.rows == 1 && is_one_thread { None } else { Some(PATIENCE) };
        match on_callers_thread(py, Allowed::asked(py)?, patience, &work)? {
            Err(Stopped::Canceled) => {}
            done => return done.map_err(limits::raised),
        }
    }
    on_pool(py, call, work)
}

/// Returns all pairs that `find` finds, on the pool.
///
/// # Errors
/// `MemoryError` if there is not enough memory for the pairs.
pub(crate) fn pairs(
    py: Python<'_>,
    find: impl FnOnce(&Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> + Send + 'static,
) -> PyResult<Vec<[u32; 2]>> {
    run(py, find)?.map_err(limits::raised)
}

/// Does work on the caller's thread, which checks for signals from time to time. The work is
/// canceled if it takes longer than `patience`.
fn on_callers_thread<T: Send>(
    py: Python<'_>,
    allowed: Allowed,
    patience: Option<Duration>,
    work: &(impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync),
) -> PyResult<Result<(T, Option<Stopped>), Stopped>> {
    let begun = Instant::now();
    let heard = AtomicU64::new(0);
    let raised = Mutex::new(None);
    let must_cancel = || {
        let elapsed = begun.elapsed();
        if patience.is_some_and(|patience| elapsed > patience) {
            return true;
        }
        let interval = LISTENING_INTERVAL.as_millis() as u64;
        let now = elapsed.as_millis() as u64;
        if now < heard.load(Ordering::Relaxed) + interval {
            return false;
        }
        heard.store(now, Ordering::Relaxed);
        match Python::attach(|py| py.check_signals()) {
            Ok(()) => false,
            Err(error) => {
                *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                true
            }
        }
    };
    let done = py.detach(|| {
        work_alone();
        let budget = allowed.budget(&must_cancel);
        let done = work(Execution::default().sequentially().with_budget(&budget));
        done.map(|done| (done, budget.stopped()))
    });
    match raised.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(done),
    }
}

/// Does work on the pool.
fn on_pool<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    work: impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync + 'static,
) -> PyResult<(T, Option<Stopped>)> {
    let line = if call.progress { Some(Line::begun(py, call.rows)?) } else { None };
    let listen = |watch: &Watch| line.as_ref().map_or(Ok(()), |line| line.show(watch.0.done.load(Ordering::Relaxed)));
    let done = run_watched(py, listen, move |watch, budget| {
        let count = |rows: usize| _ = watch.0.done.fetch_add(rows, Ordering::Relaxed);
        work(Execution::default().with_budget(budget).with_progress(&count))
    });
    if let Some(line) = &line {
        line.end()?;
    }
    let (done, stopped) = done?;
    done.map(|done| (done, stopped)).map_err(limits::raised)
}

/// Line that shows the progress of a call: `impinge._progress.Line`.
struct Line<'py>(Bound<'py, PyAny>);

impl<'py> Line<'py> {
    fn begun(py: Python<'py>, rows: usize) -> PyResult<Self> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        Ok(Self(CLASS.import(py, "impinge._progress", "Line")?.call1((rows,))?))
    }

    fn show(&self, done: usize) -> PyResult<()> {
        self.0.call_method1("show", (done,)).map(drop)
    }

    fn end(&self) -> PyResult<()> {
        self.0.call_method0("end").map(drop)
    }
}

/// Returns the number of threads that `impinge.threads` sets, or that of all processors.
pub(crate) fn requested_threads(py: Python<'_>) -> PyResult<usize> {
    static REQUESTED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let asked: Option<usize> = REQUESTED.import(py, "impinge._threads", "asked")?.call_method0("get")?.extract()?;
    Ok(asked.unwrap_or_else(|| thread::available_parallelism().map_or(1, NonZero::get)))
}

/// Returns the pool with a number of threads, and makes it if needed. The thread stays attached to
/// the interpreter during the call.
fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let found = match pools.iter().position(|(size, _)| *size == threads) {
        Some(at) => pools.remove(at),
        None => (threads, Arc::new(start_pool(threads)?)),
    };
    if pools.len() == MAX_POOLS {
        pools.remove(0);
    }
    pools.push(found.clone());
    Ok(found.1)
}

fn start_pool(threads: usize) -> PyResult<ThreadPool> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|number| format!("impinge-{number}"))
        .panic_handler(|_| ()) // the caller notices, because the sender is dropped
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start {threads} threads: {error}")))
}
