//! What all verbs on two meshes have in common: which meshes, at which poses, on which threads, with which safe answer
//! where a pose is none.

use impinge::Mesh;
use impinge::mesh::Placed;
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::broadcast::Broadcast;
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::poses::{OnError, Poses};
use crate::workers;

/// The most pairs of triangles for which a call may keep to the caller's thread, where Ctrl-C waits for it: at some ten
/// nanoseconds a pair, a fraction of a second in the worst case and microseconds in almost any.
const MOST_BRIEF_PAIRS: u128 = 1 << 24;

/// The most rows for which other threads are not worth waking, which takes some ten microseconds.
const MOST_BRIEF_ROWS: usize = 16;

/// Two meshes and the rows of poses at which they are asked about.
pub(crate) struct Question {
    a: Mesh,
    b: Mesh,
    poses_a: Poses,
    poses_b: Poses,
    rows: Broadcast,
    on_error: OnError,
}

/// The answers to a question, in row-major order of its leading axes.
pub(crate) struct Answers<T> {
    /// The leading axes; none where a single pose was asked about.
    pub(crate) shape: Vec<usize>,
    /// One answer a row.
    pub(crate) values: Vec<T>,
    /// A status a row, where the caller asked for one.
    pub(crate) status: Option<Vec<u8>>,
}

impl Question {
    /// Reads and judges the arguments that every verb takes.
    ///
    /// # Errors
    /// `InputError` naming the argument, and the row and entry in it.
    pub(crate) fn read(
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
        pose_a: &Bound<'_, PyAny>,
        pose_b: &Bound<'_, PyAny>,
        on_error: &str,
    ) -> PyResult<Self> {
        let py = a.py();
        let (mesh_a, mesh_b) = (mesh_of(a, "a")?, mesh_of(b, "b")?);
        let on_error = OnError::read(py, on_error)?;
        let poses_a = Poses::read(pose_a, "pose_a", on_error)?;
        let poses_b = Poses::read(pose_b, "pose_b", on_error)?;
        let Some(rows) = Broadcast::new(&poses_a.shape, &poses_b.shape) else {
            let (a, b) = (&poses_a.shape, &poses_b.shape);
            let message = format!("leading axes {b:?} do not broadcast with {a:?}, those of pose_a");
            return Err(Fault::new("shape", "pose_b", message).raised(py));
        };
        Ok(Self { a: mesh_a, b: mesh_b, poses_a, poses_b, rows, on_error })
    }

    /// Whether a single pose is asked about.
    pub(crate) fn is_single(&self) -> bool {
        self.rows.shape.is_empty()
    }

    /// Asks `ask` about each row, on all threads and without the interpreter; a row with a bad pose gets `safe`.
    pub(crate) fn answer<T: Clone + Send + Sync + 'static>(
        self,
        py: Python<'_>,
        safe: T,
        ask: impl Fn(Placed<'_>, Placed<'_>) -> T + Send + Sync + 'static,
    ) -> PyResult<Answers<T>> {
        let Self { a, b, poses_a, poses_b, rows, on_error } = self;
        let count = rows.rows;
        let shape = rows.shape.clone();
        let status = (on_error == OnError::Status).then(|| {
            let of = |poses: &Poses, row: usize| poses.status.as_ref().map_or(0, |status| status[row]);
            let both = |row| {
                let [at_a, at_b] = rows.sources(row);
                let own = of(&poses_a, at_a);
                if own == 0 { of(&poses_b, at_b) } else { own }
            };
            (0..count).map(both).collect::<Vec<u8>>()
        });
        let bad = status.clone().filter(|status| status.iter().any(|&status| status != 0));
        let worst = a.faces().len() as u128 * b.faces().len() as u128 * count as u128;
        let brief = count <= MOST_BRIEF_ROWS && worst <= MOST_BRIEF_PAIRS;
        let safely = safe.clone();
        let values = workers::rows(py, count, brief, safe, move |row| {
            if bad.as_ref().is_some_and(|bad| bad[row] != 0) {
                return safely.clone();
            }
            let [at_a, at_b] = rows.sources(row);
            ask(a.at(poses_a.poses[at_a]), b.at(poses_b.poses[at_b]))
        })?;
        Ok(Answers { shape, values, status })
    }
}

/// An array with these leading axes.
pub(crate) fn array<'py, T: Element>(py: Python<'py>, values: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape.to_vec())?.into_any())
}

/// What a verb returns: its answer or, where the caller asked for them, the answer and the status of each row.
pub(crate) fn with_status<'py>(
    answer: Bound<'py, PyAny>,
    status: Option<Vec<u8>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let py = answer.py();
    match status {
        None => Ok(answer),
        Some(status) => Ok((answer, array(py, status, shape)?).into_pyobject(py)?.into_any()),
    }
}
