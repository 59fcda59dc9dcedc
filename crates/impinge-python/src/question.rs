//! What all verbs on two meshes have in common: which meshes, at which poses, on which threads, with which safe answer
//! where a pose is none.

use impinge::mesh::{Options, Placed};
use impinge::query::Solid;
use impinge::{Mesh, Pose};
use pyo3::prelude::*;

use crate::arrays::array;
use crate::broadcast::Broadcast;
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::poses::{OnError, Poses};
use crate::workers::{self, Rows};

/// The most pairs of triangles for which a call may keep to the caller's thread, where Ctrl-C waits for it: at some ten
/// nanoseconds a pair, a fraction of a second in the worst case and microseconds in almost any.
const MOST_BRIEF_PAIRS: u128 = 1 << 24;

/// The most rows for which other threads are not worth waking, which takes some ten microseconds.
const MOST_BRIEF_ROWS: usize = 16;

/// The value of `impinge.Status` for an answer that is the safe one because nothing was proved.
const UNDECIDED: u8 = 5;

/// Two meshes and the rows of poses at which they are asked about.
pub(crate) struct Question {
    a: Mesh,
    b: Mesh,
    poses_a: Poses,
    poses_b: Poses,
    rows: Broadcast,
    on_error: OnError,
    progress: bool,
    is_long: bool,
}

/// The answers to a question, in row-major order of its leading axes.
pub(crate) struct Answers<T> {
    /// The leading axes; none where a single pose was asked about.
    pub(crate) shape: Vec<usize>,
    /// One answer a row.
    pub(crate) values: Vec<T>,
    /// A status a row, where the caller asked for one.
    status: Option<Vec<u8>>,
}

/// Which mesh is solid: `False`, `True`, `"a"` or `"b"`.
pub(crate) struct SolidOption(pub(crate) Solid);

/// Whether the caller wants to see how far the call is.
pub(crate) struct Progress(pub(crate) bool);

impl<'py> FromPyObject<'_, 'py> for Question {
    type Error = PyErr;

    /// Reads and judges what every verb takes: `(a, b, pose_a, pose_b, on_error, progress)`.
    ///
    /// # Errors
    /// `InputError` naming the argument, and the row and entry in it.
    fn extract(asked: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        type Asked<'py> =
            (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Progress);
        let py = asked.py();
        let (a, b, pose_a, pose_b, on_error, Progress(progress)): Asked<'py> = asked.extract()?;
        let (mesh_a, mesh_b) = (mesh_of(&a, "a")?, mesh_of(&b, "b")?);
        let on_error = OnError::read(&on_error)?;
        let poses_a = Poses::read(&pose_a, "pose_a", on_error)?;
        let poses_b = Poses::read(&pose_b, "pose_b", on_error)?;
        let rows = Broadcast::of(py, (&poses_a.shape, "pose_a"), (&poses_b.shape, "pose_b"))?;
        Ok(Self { a: mesh_a, b: mesh_b, poses_a, poses_b, rows, on_error, progress, is_long: false })
    }
}

impl<'py> FromPyObject<'_, 'py> for SolidOption {
    type Error = PyErr;

    fn extract(option: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(both) = option.extract::<bool>() {
            return Ok(Self(if both { Solid::Both } else { Solid::Neither }));
        }
        match option.extract::<&str>() {
            Ok("a") => Ok(Self(Solid::A)),
            Ok("b") => Ok(Self(Solid::B)),
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
    /// The two meshes and their poses, where a single pose is asked about.
    pub(crate) fn single(&self) -> Option<([&Mesh; 2], [Pose; 2])> {
        let poses = [self.poses_a.poses.first()?, self.poses_b.poses.first()?];
        self.rows.shape.is_empty().then(|| ([&self.a, &self.b], poses.map(|pose| *pose)))
    }

    /// The same question, of which even one row may take long.
    pub(crate) fn that_takes_long(self) -> Self {
        Self { is_long: true, ..self }
    }

    /// [`answer_learning`](Self::answer_learning), where rows have nothing to learn from each other.
    pub(crate) fn answer<T: Clone + Send + Sync + 'static>(
        self,
        py: Python<'_>,
        safe: T,
        ask: impl Fn(Placed<'_>, Placed<'_>) -> T + Send + Sync + 'static,
    ) -> PyResult<Answers<T>> {
        self.answer_learning(py, safe, move |(), a, b| ask(a, b))
    }

    /// Asks `ask` about each row, on all threads and without the interpreter; a row with a bad pose gets `safe`. What is
    /// learned from a row, which changes no answer, is there for the next one of the same block.
    pub(crate) fn answer_learning<S: Default + 'static, T: Clone + Send + Sync + 'static>(
        self,
        py: Python<'_>,
        safe: T,
        ask: impl Fn(&mut S, Placed<'_>, Placed<'_>) -> T + Send + Sync + 'static,
    ) -> PyResult<Answers<T>> {
        let rows = Rows { count: self.rows.rows, brief: self.is_brief(), progress: self.progress };
        let (shape, status) = (self.rows.shape.clone(), self.statuses());
        let placing = Placing { bad: status.clone(), question: self };
        let safely = safe.clone();
        let values = workers::rows(py, rows, safe, S::default, move |learned, row| {
            placing.at(row).map_or_else(|| safely.clone(), |[a, b]| ask(learned, a, b))
        })?;
        Ok(Answers { shape, values, status })
    }

    /// [`answer_learning`](Self::answer_learning) of verbs that the options can interrupt, but for what they ask of solids.
    /// `is_sequential` says that one thread does all of a row.
    pub(crate) fn answer_interruptibly<S: Default + 'static, T: Clone + Send + Sync + 'static>(
        self,
        py: Python<'_>,
        solid: Solid,
        is_sequential: bool,
        safe: T,
        ask: impl Fn(&mut S, &Options<'_>, Placed<'_>, Placed<'_>) -> T + Send + Sync + 'static,
    ) -> PyResult<Answers<T>> {
        let brief = solid == Solid::Neither || self.is_brief();
        let rows = Rows { count: self.rows.rows, brief, progress: self.progress };
        let (shape, status) = (self.rows.shape.clone(), self.statuses());
        let placing = Placing { bad: status.clone(), question: self };
        let safely = safe.clone();
        let of_row = move |learned: &mut S, row: usize, options: &Options<'_>| {
            placing.at(row).map_or_else(|| safely.clone(), |[a, b]| ask(learned, options, a, b))
        };
        let values = workers::interruptible_rows(py, rows, is_sequential, safe, S::default, of_row)?;
        Ok(Answers { shape, values, status })
    }

    /// Whether the question takes a fraction of a second at the very worst.
    fn is_brief(&self) -> bool {
        let count = self.rows.rows;
        let worst = self.a.faces().len() as u128 * self.b.faces().len() as u128 * count as u128;
        !self.is_long && count <= MOST_BRIEF_ROWS && worst <= MOST_BRIEF_PAIRS
    }

    /// The status of each row by its poses, if the caller asked for one.
    fn statuses(&self) -> Option<Vec<u8>> {
        let of = |poses: &Poses, row: usize| poses.status.as_ref().map_or(0, |status| status[row]);
        let both = |row| {
            let [at_a, at_b] = self.rows.sources(row);
            let own = of(&self.poses_a, at_a);
            if own == 0 { of(&self.poses_b, at_b) } else { own }
        };
        (self.on_error == OnError::Status).then(|| (0..self.rows.rows).map(both).collect())
    }
}

/// The meshes of a question at the poses of its rows.
struct Placing {
    question: Question,
    /// Of each row, zero if its poses are good.
    bad: Option<Vec<u8>>,
}

impl Placing {
    /// Both meshes in a row; none if a pose is bad.
    fn at(&self, row: usize) -> Option<[Placed<'_>; 2]> {
        if self.bad.as_ref().is_some_and(|bad| bad[row] != 0) {
            return None;
        }
        let Question { a, b, poses_a, poses_b, rows, .. } = &self.question;
        let [at_a, at_b] = rows.sources(row);
        Some([a.at(poses_a.poses[at_a]), b.at(poses_b.poses[at_b])])
    }
}

impl<T> Answers<T> {
    /// The answers of rows with these leading axes, and a status for each where the caller asked for one.
    pub(crate) fn new(shape: Vec<usize>, values: Vec<T>, status: Option<Vec<u8>>) -> Self {
        Self { shape, values, status }
    }

    /// The same with each answer made into another; those that `is_undecided` have that status.
    pub(crate) fn judged<U>(self, is_undecided: impl Fn(&T) -> bool, of: impl Fn(T) -> U) -> Answers<U> {
        let Self { shape, values, mut status } = self;
        for (status, value) in status.iter_mut().flatten().zip(&values) {
            if *status == 0 && is_undecided(value) {
                *status = UNDECIDED;
            }
        }
        Answers { shape, values: values.into_iter().map(of).collect(), status }
    }

    /// What a verb returns: what `made` makes of the answers and their leading axes and, where the caller asked for them,
    /// the status of each row beside it.
    pub(crate) fn returned<'py>(
        self,
        py: Python<'py>,
        made: impl FnOnce(Vec<T>, &[usize]) -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let answer = made(self.values, &self.shape)?;
        with_status(py, answer, self.status, &self.shape)
    }
}

/// An answer or, where the caller asked for them, the answer and the status of each row.
pub(crate) fn with_status<'py>(
    py: Python<'py>,
    answer: Bound<'py, PyAny>,
    status: Option<Vec<u8>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    match status {
        None => Ok(answer),
        Some(status) => Ok((answer, array(py, status, shape)?).into_pyobject(py)?.into_any()),
    }
}
