//! What all verbs on two things have in common: which things, at which poses, on which threads.

use impinge::Pose;
use impinge::query::batch::{Answers, Batch, Execution, Status, Stopped};
use pyo3::prelude::*;

use crate::arrays::array;
use crate::errors::Fault;
use crate::poses;
use crate::shapes::{Weighed, weighed};
use crate::workers::{self, Call};

/// The most pairs of faces, over all rows, for which a call about two meshes may keep to the caller's thread, where Ctrl-C waits
/// for it: at some ten nanoseconds a pair, a fraction of a second in the worst case and microseconds in almost any.
const MOST_BRIEF_PAIRS: u128 = 1 << 24;

/// The most pairs of pieces likewise, if one of the two is a shape.
const MOST_BRIEF_PIECES: u128 = 1 << 10;

/// The most rows for which other threads are not worth waking, which takes some ten microseconds.
const MOST_BRIEF_ROWS: usize = 16;

/// The most poses that are judged with the interpreter held.
const MOST_BRIEF_POSES: usize = 64;

/// Two things and the rows of poses at which they are asked about.
pub(crate) struct Question {
    batch: Batch<'static>,
    things: [Weighed; 2],
    tells_status: bool,
    progress: bool,
    is_long: bool,
    /// Whether any of the two is a solid mesh.
    has_solid: bool,
}

/// Answers, and whether the caller asked for the status of each row.
pub(crate) struct Replies<T> {
    answers: Answers<T>,
    tells_status: bool,
}

/// How a verb goes through the faces of two meshes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Search {
    /// On one thread for each row, until it is interrupted.
    OneThread,
    /// On all threads, until it is interrupted.
    AllThreads,
    /// To its end.
    Whole,
}

/// Which of two things is solid, if it is a mesh: `False`, `True`, `"a"` or `"b"`.
pub(crate) struct SolidOption(pub(crate) [bool; 2]);

/// Whether the caller wants to see how far the call is.
pub(crate) struct Progress(pub(crate) bool);

impl<'py> FromPyObject<'_, 'py> for Question {
    type Error = PyErr;

    /// Reads and judges what every verb takes: `(a, b, pose_a, pose_b, solid, on_error, progress)`.
    ///
    /// # Errors
    /// `InputError` naming the argument, and the row and entry in it.
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
        let things = [weighed(&a, "a", is_solid[0])?, weighed(&b, "b", is_solid[1])?];
        let tells_status = tells_status(&on_error)?;
        let (poses_a, poses_b) = (poses::read(&pose_a, "pose_a")?, poses::read(&pose_b, "pose_b")?);
        let is_short = poses_a.len().max(poses_b.len()) <= MOST_BRIEF_POSES;
        let made = || Batch::new(&things[0].shape, &things[1].shape, poses_a, poses_b);
        let batch = if is_short { made() } else { py.detach(made) };
        let batch =
            batch.map_err(|error| Fault::new("shape", "pose_b", format!("{error}, those of pose_a")).raised(py))?;
        if !tells_status {
            for (poses, name) in batch.poses().into_iter().zip(["pose_a", "pose_b"]) {
                poses::raise_first_fault(py, poses, name)?;
            }
        }
        let has_solid = things.iter().any(|thing| thing.shape.as_mesh().is_some_and(|(_, is_solid)| is_solid));
        Ok(Self { batch, things, tells_status, progress, is_long: false, has_solid })
    }
}

/// Reads `on_error`: whether an invalid pose gets a status instead of raising an error.
pub(crate) fn tells_status(option: &Bound<'_, PyAny>) -> PyResult<bool> {
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
    /// Returns the two poses, if a single pose is asked about.
    pub(crate) fn single(&self) -> Option<[Pose; 2]> {
        let [a, b] = self.batch.poses();
        let both = [*a.get(0).ok()?, *b.get(0).ok()?];
        (a.shape().is_empty() && b.shape().is_empty()).then_some(both)
    }

    /// Returns the two things.
    pub(crate) fn things(&self) -> &[Weighed; 2] {
        &self.things
    }

    /// The same question, of which even one row may take long if one of the two has faces or parts.
    pub(crate) fn that_may_take_long(self) -> Self {
        let is_long = self.things.iter().any(|thing| thing.weight > 1);
        Self { is_long, ..self }
    }

    /// Asks a verb about each row, without the interpreter.
    pub(crate) fn ask<T: Send + 'static>(
        self,
        py: Python<'_>,
        search: Search,
        verb: impl Fn(&Batch<'_>) -> Result<Answers<T>, Stopped> + Send + Sync + 'static,
    ) -> PyResult<Replies<T>> {
        let rows = self.batch.rows();
        let are_meshes = self.things.iter().all(|thing| thing.shape.as_mesh().is_some());
        let weight: u128 = self.things.iter().map(|thing| u128::from(thing.weight.max(1))).product();
        let (most, most_rows) =
            if are_meshes { (MOST_BRIEF_PAIRS, MOST_BRIEF_ROWS) } else { (MOST_BRIEF_PIECES, usize::MAX) };
        let is_short = !self.is_long && rows <= most_rows && weight.saturating_mul(rows as u128) <= most;
        // A search that can be interrupted may begin on the caller's thread, whatever its size.
        let is_interruptible = are_meshes && search != Search::Whole && (!self.has_solid || is_short);
        let call = Call { rows, is_brief: is_short || is_interruptible, progress: self.progress };
        let batch = self.batch;
        let work = move |execution: Execution<'_>| verb(&batch.clone().with_execution(execution));
        let answers = if is_interruptible {
            workers::execute_interruptibly(py, call, search == Search::OneThread, work)?
        } else {
            workers::execute(py, call, work)?
        };
        Ok(Replies { answers, tells_status: self.tells_status })
    }
}

impl<T> Replies<T> {
    /// The same with each answer made into another.
    pub(crate) fn map<U>(self, of: impl FnMut(T) -> U) -> Replies<U> {
        Replies { answers: self.answers.map(of), tells_status: self.tells_status }
    }

    /// What a verb returns: what `made` makes of the answers and their leading axes and, if the caller asked for them, the status
    /// of each row beside it.
    pub(crate) fn returned<'py>(
        self,
        py: Python<'py>,
        made: impl FnOnce(Vec<T>, &[usize]) -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Answers { shape, values, status } = self.answers;
        let answer = made(values, &shape)?;
        with_status(py, answer, self.tells_status.then_some(status), &shape)
    }
}

/// An answer or, if there are any, the answer and the status of each row.
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
