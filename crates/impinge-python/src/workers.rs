//! Where the work is done: on the caller's thread if it is short or only one thread can do it, otherwise on a pool of
//! threads. The caller's thread listens for Ctrl-C meanwhile.
//!
//! To wake a pool takes some 30 microseconds, and a first hit takes one. So work that can be interrupted begins on the caller's
//! thread, however large the meshes are.
//!
//! Threads do not survive a fork, so the child forgets the pools of its parent (`impinge._threads` calls `after_fork`).
//! Pools are looked up and made while the interpreter is held, as it is when Python forks: the lock is never inherited
//! in a locked state.

use std::cell::OnceCell;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use impinge::mesh::Interrupt;
use impinge::query::batch::{Execution, Stopped};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// How long a signal may wait: short to a person, long to a processor.
pub(crate) const LISTENING_INTERVAL: Duration = Duration::from_millis(20);

/// Pools that are kept: that of all processors and the last few other sizes.
const MOST_POOLS: usize = 4;

/// How long rows are worked on by the caller's thread before the pool takes them over: several times what waking it takes.
const PATIENCE: Duration = Duration::from_micros(200);

/// The most rows that the caller's thread begins with.
const MOST_ROWS_ALONE: usize = 16;

/// A call, and how it is to be worked on.
#[derive(Clone, Copy)]
pub(crate) struct Call {
    pub(crate) rows: usize,
    /// Whether it is so short that the caller's own thread does it.
    pub(crate) is_brief: bool,
    /// Whether the caller wants to see how far it is.
    pub(crate) progress: bool,
}

/// What the caller's thread and the others know of each other.
#[derive(Clone, Default)]
pub(crate) struct Watch(Arc<Shared>);

#[derive(Default)]
struct Shared {
    /// Set once nobody waits for an answer any more.
    abandoned: AtomicBool,
    /// Rows that are answered.
    done: AtomicUsize,
}

impl Watch {
    fn is_abandoned(&self) -> bool {
        self.0.abandoned.load(Ordering::Relaxed)
    }
}

/// Whether this process is the child of one that imported the module.
static FORKED: AtomicBool = AtomicBool::new(false);

/// Pools by number of threads, the last used last.
static POOLS: Mutex<Vec<(usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// Gives what is asked on a caller's own thread no others: rayon's default pool, which it would look to, is made of one.
pub(crate) fn keep_callers_alone() {
    // Only a pool that exists already is refused, and that has one thread too.
    ThreadPoolBuilder::new().num_threads(1).build_global().ok();
}

/// To be called in the child, after each fork.
#[pyfunction]
pub(crate) fn after_fork() {
    FORKED.store(true, Ordering::Relaxed);
    // To drop the pools would mean to signal to threads that are not here.
    std::mem::forget(std::mem::take(&mut *POOLS.lock().unwrap_or_else(PoisonError::into_inner)));
}

/// Makes the caller's thread do its parallel work alone, in a forked process too, where the default pool has no thread.
fn work_alone() {
    thread_local! {
        static ALONE: OnceCell<()> = const { OnceCell::new() };
    }
    if FORKED.load(Ordering::Relaxed) {
        ALONE.with(|alone| {
            alone.get_or_init(|| {
                let own = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
                std::mem::forget(own); // this thread is its only one, as long as it lives
            });
        });
    }
}

/// Runs a job on the pool. A signal handler that raises, as that of Ctrl-C does, ends the wait at once: the job is
/// abandoned, and whatever of it has not begun is not done.
pub(crate) fn run<T: Send + 'static>(py: Python<'_>, job: impl FnOnce(&Watch) -> T + Send + 'static) -> PyResult<T> {
    run_watched(py, |_| Ok(()), job)
}

/// [`run`], with `listen` called between two waits; where it fails, so does the call.
fn run_watched<T: Send + 'static>(
    py: Python<'_>,
    listen: impl Fn(&Watch) -> PyResult<()>,
    job: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = pool(asked_threads(py)?)?;
    let watch = Watch::default();
    let (sender, mut receiver) = mpsc::sync_channel(1);
    let watched = watch.clone();
    pool.spawn(move || {
        let answer = job(&watched);
        sender.send(answer).ok(); // nobody listens where the job was abandoned
    });
    loop {
        // A receiver may be moved but not shared.
        let heard = py.detach(move || (receiver.recv_timeout(LISTENING_INTERVAL), receiver));
        receiver = heard.1;
        match heard.0 {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(raised) = py.check_signals().and_then(|()| listen(&watch)) {
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

/// Asks `ask` about each row, on all threads; on the caller's own if the call is brief.
pub(crate) fn rows<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    ask: impl Fn(usize) -> T + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    execute(py, call, move |execution| execution.rows(call.rows, || (), |(), row, _| ask(row)))
}

/// Does work on rows, on all threads; on the caller's own if the call is brief.
pub(crate) fn execute<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    work: impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync + 'static,
) -> PyResult<T> {
    if !call.is_brief {
        return on_pool(py, call, work);
    }
    let done = py.detach(|| {
        work_alone();
        work(Execution::default().sequentially())
    });
    done.map_err(|stopped| raised(&stopped, call))
}

/// [`execute`] for work that its interrupt ends within a row. The caller's thread begins with a brief call, however large the meshes
/// are. The pool takes it over if that takes long, unless there is one row and `is_one_thread` says that one thread does all of it.
pub(crate) fn execute_interruptibly<T: Send + 'static>(
    py: Python<'_>,
    call: Call,
    is_one_thread: bool,
    work: impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync + 'static,
) -> PyResult<T> {
    if call.is_brief && call.rows <= MOST_ROWS_ALONE {
        let patience = if call.rows == 1 && is_one_thread { None } else { Some(PATIENCE) };
        match on_own_thread(py, patience, &work)? {
            Err(Stopped::Interrupted) => {}
            done => return done.map_err(|stopped| raised(&stopped, call)),
        }
    }
    on_pool(py, call, work)
}

fn raised(stopped: &Stopped, call: Call) -> PyErr {
    PyMemoryError::new_err(format!("{stopped} of {} rows", call.rows))
}

/// Does work on the caller's thread, which looks at signals between whiles. It is interrupted if it takes longer than `patience`.
fn on_own_thread<T: Send>(
    py: Python<'_>,
    patience: Option<Duration>,
    work: &(impl Fn(Execution<'_>) -> Result<T, Stopped> + Send + Sync),
) -> PyResult<Result<T, Stopped>> {
    let begun = Instant::now();
    let heard = AtomicU64::new(0);
    let raised = Mutex::new(None);
    let is_wanted = || {
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
        work(Execution::default().sequentially().with_interrupt(Interrupt::when(&is_wanted)))
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
) -> PyResult<T> {
    let line = if call.progress { Some(Line::begun(py, call.rows)?) } else { None };
    let listen = |watch: &Watch| line.as_ref().map_or(Ok(()), |line| line.show(watch.0.done.load(Ordering::Relaxed)));
    let done = run_watched(py, listen, move |watch| {
        let is_abandoned = || watch.is_abandoned();
        let count = |rows: usize| _ = watch.0.done.fetch_add(rows, Ordering::Relaxed);
        work(Execution::default().with_interrupt(Interrupt::when(&is_abandoned)).with_progress(&count))
    });
    if let Some(line) = &line {
        line.end()?;
    }
    done?.map_err(|stopped| raised(&stopped, call))
}

/// The line in which the caller sees how far a call is: `impinge._progress.Line`.
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

/// The threads that `impinge.threads` asks for, or all.
fn asked_threads(py: Python<'_>) -> PyResult<usize> {
    static ASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let asked: Option<usize> = ASKED.import(py, "impinge._threads", "asked")?.call_method0("get")?.extract()?;
    Ok(asked.unwrap_or_else(|| thread::available_parallelism().map_or(1, NonZero::get)))
}

/// The pool with so many threads, made where there is none. Called while the interpreter is held, and never letting go
/// of it.
fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let found = match pools.iter().position(|(size, _)| *size == threads) {
        Some(at) => pools.remove(at),
        None => (threads, Arc::new(started(threads)?)),
    };
    if pools.len() == MOST_POOLS {
        pools.remove(0);
    }
    pools.push(found.clone());
    Ok(found.1)
}

fn started(threads: usize) -> PyResult<ThreadPool> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|number| format!("impinge-{number}"))
        .panic_handler(|_| ()) // the caller hears of it, as the sender is gone
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("starting {threads} threads: {error}")))
}
