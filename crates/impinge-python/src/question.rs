//! Arguments and execution of all queries about two things: which things, at which poses, on which
//! threads.

use impinge::budget::Stopped;
use impinge::query::batch::{Answers, Batch, Execution, Status};
use pyo3::prelude::*;

use crate::arrays::array;
use crate::errors::Fault;
use crate::limits;
use crate::poses;
use crate::shapes::{WeighedShape, read_shape};
use crate::workers::{self, Call};

/// Maximum number of pairs of faces, over all rows, of a query about two meshes that runs on the
/// caller's thread. Ctrl-C waits for such a query. At about ten nanoseconds for each pair it takes
/// a fraction of a second in the worst case, and microseconds in almost all cases.
const MAX_PAIRS_ON_CALLER: u128 = 1 << 24;

/// Maximum number of pairs of pieces, over all rows, of a query that runs on the caller's thread if
/// one of the two things is a shape.
const MAX_PIECE_PAIRS_ON_CALLER: u128 = 1 << 10;

/// Maximum number of faces, over all rows, of a query about a mesh and a shape that starts on the
/// caller's thread. If all faces were near the shape, Ctrl-C would wait a fraction of a second.
const MAX_FACES_ON_CALLER: u128 = 1 << 21;

/// Maximum number of rows of a query about two meshes that runs on the caller's thread. Waking
/// other threads takes about ten microseconds, which pays only for more rows.
const MAX_ROWS_ON_CALLER: usize = 16;

/// Maximum number of poses that are validated while the thread is attached to the interpreter.
const MAX_POSES_WHILE_ATTACHED: usize = 64;

/// Two things, and the rows of poses of a query about them.
pub(crate) struct Question {
    batch: Batch<'static>,
    things: [WeighedShape; 2],
    wants_status: bool,
    progress: bool,
    may_take_long: bool,
    /// Whether one of the things is a solid mesh.
    has_solid: bool,
}

/// Answers, and whether the caller wants the status of each row.
pub(crate) struct Replies<T> {
    answers: Answers<T>,
    wants_status: bool,
}

/// Search of the faces of two meshes: its threads, and whether an interrupt can end it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Search {
    /// On one thread for each row, with an interrupt.
    OneThread,
    /// On all threads, with an interrupt.
    AllThreads,
    /// On all threads, and not on the caller's thread unless the query is short. First the query
    /// may prepare a mesh for questions about its inside, and an interrupt does not stop that.
    Derived,
    /// To its end: an interrupt does not stop it within a row.
    Whole,
}

/// Option that says which of two things is solid, if it is a mesh: `False`, `True`, `"a"` or `"b"`.
pub(crate) struct SolidOption(pub(crate) [bool; 2]);

/// Option that says whether to show the progress of the call.
pub(crate) struct Progress(pub(crate) bool);

impl<'py> FromPyObject<'_, 'py> for Question {
    type Error = PyErr;

    /// Reads and validates the arguments of every query:
    /// `(a, b, pose_a, pose_b, solid, on_error, progress)`.
    ///
    /// # Errors
    /// `InputError` with the name of the argument, the row and the entry.
    fn extract(asked: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        type Asked<'py> = (
            Bound<'py, PyAny>,
            Bound<'py, PyAny>,
            Bound<'py, PyAny>,
            Bound<'py, PyAny>,
            SolidOption,
            Bound<'py, PyAny>,
            Progress,
        );
        let py = asked.py();
        let (a, b, pose_a, pose_b, SolidOption(is_solid), on_error, Progress(progress)): Asked<'py> =
            asked.extract()?;
        let things = [read_shape(&a, "a", is_solid[0])?, read_shape(&b, "b", is_solid[1])?];
        let wants_status = wants_status(&on_error)?;
        let (poses_a, poses_b) = (poses::read(&pose_a, "pose_a")?, poses::read(&pose_b, "pose_b")?);
        let is_short = poses_a.len().max(poses_b.len()) <= MAX_POSES_WHILE_ATTACHED;
        let made = || Batch::new(&things[0].shape, &things[1].shape, poses_a, poses_b);
        let batch = if is_short { made() } else { py.detach(made) };
        let batch =
            batch.map_err(|error| Fault::new("shape", "pose_b", format!("{error}, those of pose_a")).raised(py))?;
        if !wants_status {
            for (poses, name) in batch.poses().into_iter().zip(["pose_a", "pose_b"]) {
                poses::raise_first_fault(py, poses, name)?;
            }
        }
        let has_solid = things.iter().any(|thing| thing.shape.as_mesh().is_some_and(|(_, is_solid)| is_solid));
        Ok(Self { batch, things, wants_status, progress, may_take_long: false, has_solid })
    }
}

/// Reads `on_error`. Returns whether an invalid pose gets a status instead of raising an error.
pub(crate) fn wants_status(option: &Bound<'_, PyAny>) -> PyResult<bool> {
    match option.extract::<&str>() {
        Ok("raise") => Ok(false),
        Ok("status") => Ok(true),
        _ => {
            let message = format!("must be \"raise\" or \"status\", not {}", option.repr()?);
            Err(Fault::new("option", "on_error", message).raised(option.py()))
        }
    }
}

impl<'py> FromPyObject<'_, 'py> for SolidOption {
    type Error = PyErr;

    fn extract(option: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(both) = option.extract::<bool>() {
            return Ok(Self([both; 2]));
        }
        match option.extract::<&str>() {
            Ok("a") => Ok(Self([true, false])),
            Ok("b") => Ok(Self([false, true])),
            _ => {
                let message = format!("must be False, True, \"a\" or \"b\", not {}", option.repr()?);
                Err(Fault::new("option", "solid", message).raised(option.py()))
            }
        }
    }
}

impl<'py> FromPyObject<'_, 'py> for Progress {
    type Error = PyErr;

    fn extract(option: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        option.extract::<bool>().map(Self).map_err(|_| {
            let kind = option.get_type().name().map_or_else(|_| "something else".into(), |name| name.to_string());
            Fault::new("type", "progress", format!("must be True or False, not {kind}")).raised(option.py())
        })
    }
}

impl Question {
    /// Returns the leading axes of the answers.
    pub(crate) fn leading_axes(&self) -> &[usize] {
        self.batch.shape()
    }

    /// Returns the two things.
    pub(crate) fn things(&self) -> &[WeighedShape; 2] {
        &self.things
    }

    /// Returns the same question, marked as one whose rows may each take long. A row takes long
    /// only if one of the things has faces or parts.
    pub(crate) fn that_may_take_long(self) -> Self {
        let may_take_long = self.things.iter().any(|thing| thing.weight > 1);
        Self { may_take_long, ..self }
    }

    /// Runs a query for each row while the thread is detached from the interpreter.
    pub(crate) fn ask<T: Send + 'static>(
        self,
        py: Python<'_>,
        search: Search,
        verb: impl Fn(&Batch<'_>) -> Result<Answers<T>, Stopped> + Send + Sync + 'static,
    ) -> PyResult<Replies<T>> {
        let rows = self.batch.rows();
        let are_meshes = self.things.iter().all(|thing| thing.shape.as_mesh().is_some());
        let weight: u128 = self.things.iter().map(|thing| u128::from(thing.weight.max(1))).product();
        let (max_work, max_rows) = if are_meshes {
            (MAX_PAIRS_ON_CALLER, MAX_ROWS_ON_CALLER)
        } else {
            (MAX_PIECE_PAIRS_ON_CALLER, usize::MAX)
        };
        let is_short = !self.may_take_long && rows <= max_rows && weight.saturating_mul(rows as u128) <= max_work;
        // A search that can be interrupted may start on the caller's thread, whatever its size is.
        let is_interruptible = are_meshes
            && match search {
                Search::OneThread | Search::AllThreads => !self.has_solid || is_short,
                Search::Derived => is_short,
                Search::Whole => false,
            };
        // A search of one mesh for a shape may, too: few faces are near it, in almost all cases.
        let is_quick = search == Search::OneThread
            && !self.has_solid
            && self.things.iter().any(|thing| thing.weight <= 1)
            && weight.saturating_mul(rows as u128) <= MAX_FACES_ON_CALLER;
        let is_interruptible = is_interruptible || is_quick && !is_short;
        let call = Call { rows, is_brief: is_short || is_interruptible, progress: self.progress };
        let batch = self.batch;
        let work = move |execution: Execution<'_>| verb(&batch.clone().with_execution(execution));
        let (answers, stopped) = if is_interruptible {
            workers::execute_interruptibly(py, call, search == Search::OneThread, work)?
        } else {
            workers::execute(py, call, work)?
        };
        match stopped {
            Some(stopped) if !self.wants_status => Err(limits::raised(stopped)),
            _ => Ok(Replies { answers, wants_status: self.wants_status }),
        }
    }
}

impl<T> Replies<T> {
    /// Returns the same replies with each answer mapped by `of`.
    pub(crate) fn map<U>(self, of: impl FnMut(T) -> U) -> Replies<U> {
        Replies { answers: self.answers.map(of), wants_status: self.wants_status }
    }

    /// Returns the result of a query for Python: `made` converts the answers and their leading
    /// axes. If the caller wants it, the status of each row is added.
    pub(crate) fn returned<'py>(
        self,
        py: Python<'py>,
        made: impl FnOnce(Vec<T>, &[usize]) -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Answers { shape, values, status } = self.answers;
        let answer = made(values, &shape)?;
        with_status(py, answer, self.wants_status.then_some(status), &shape)
    }
}

/// Returns the answer, or the answer and the status of each row.
pub(crate) fn with_status<'py>(
    py: Python<'py>,
    answer: Bound<'py, PyAny>,
    status: Option<Vec<Status>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    match status {
        None => Ok(answer),
        Some(status) => {
            let status: Vec<u8> = status.into_iter().map(|status| status as u8).collect();
            Ok((answer, array(py, status, shape)?).into_pyobject(py)?.into_any())
        }
    }
}
