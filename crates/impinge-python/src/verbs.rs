//! The verbs, each the library's own in a question's rows.

use impinge::exact::{Crossing, Placement, crossing};
use impinge::mesh::Placed;
use impinge::query::{Distance, Witness};
use impinge::{Pose, query};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyList};

use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::poses::{OnError, Poses};
use crate::question::{Question, array, with_status};

/// `bool`, or an array of them.
#[pyfunction]
pub(crate) fn intersects<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    pose_a: &Bound<'py, PyAny>,
    pose_b: &Bound<'py, PyAny>,
    on_error: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let question = Question::read(a, b, pose_a, pose_b, on_error)?;
    yes_or_no(question, a.py(), |a, b| query::intersects(a, b))
}

/// Answers a question whose safe answer is yes.
fn yes_or_no<'py>(
    question: Question,
    py: Python<'py>,
    ask: impl Fn(Placed<'_>, Placed<'_>) -> bool + Send + Sync + 'static,
) -> PyResult<Bound<'py, PyAny>> {
    let is_single = question.is_single();
    let answers = question.answer(py, true, ask)?;
    let values = match answers.values[..] {
        [value] if is_single => PyBool::new(py, value).to_owned().into_any(),
        _ => array(py, answers.values, &answers.shape)?,
    };
    with_status(values, answers.status, &answers.shape)
}

/// An (k, 2) array, or the offsets of each row with those of all rows in one. `limit` cuts each row short.
#[pyfunction]
pub(crate) fn intersecting_pairs<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    pose_a: &Bound<'py, PyAny>,
    pose_b: &Bound<'py, PyAny>,
    limit: Option<usize>,
    on_error: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = a.py();
    let question = Question::read(a, b, pose_a, pose_b, on_error)?;
    let is_single = question.is_single();
    let answers = question.answer(py, Vec::new(), move |a, b| {
        let mut pairs = query::intersecting_pairs(a, b);
        if let Some(limit) = limit.filter(|&limit| limit < pairs.len()) {
            pairs.truncate(limit);
            pairs.shrink_to_fit();
        }
        pairs
    })?;
    let value = if is_single {
        pair_rows(py, answers.values.into_iter().next().unwrap_or_default())?
    } else {
        let mut offsets = vec![0_i64];
        let mut end = 0;
        for pairs in &answers.values {
            end += pairs.len();
            offsets.push(end as i64);
        }
        let mut rows = Vec::with_capacity(end);
        for pairs in answers.values {
            rows.extend(pairs);
        }
        let offsets = PyArray1::from_vec(py, offsets).into_any();
        (offsets, pair_rows(py, rows)?, answers.shape.clone()).into_pyobject(py)?.into_any()
    };
    with_status(value, answers.status, &answers.shape)
}

fn pair_rows(py: Python<'_>, pairs: Vec<[u32; 2]>) -> PyResult<Bound<'_, PyAny>> {
    let count = pairs.len();
    Ok(PyArray1::from_vec(py, pairs.into_flattened()).reshape([count, 2])?.into_any())
}

/// A list of (n, 3) arrays, in as many lists as there are leading axes.
#[pyfunction]
pub(crate) fn intersection_curves<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    pose_a: &Bound<'py, PyAny>,
    pose_b: &Bound<'py, PyAny>,
    on_error: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = a.py();
    let question = Question::read(a, b, pose_a, pose_b, on_error)?;
    let answers = question.answer(py, Vec::new(), |a, b| query::intersection_curves(a, b).polylines)?;
    let lines = |lines: Vec<Vec<[f64; 3]>>| -> PyResult<Bound<'py, PyAny>> {
        let lines = lines.into_iter().map(|line| {
            let shape = [line.len(), 3];
            array(py, line.into_flattened(), &shape)
        });
        Ok(PyList::new(py, lines.collect::<PyResult<Vec<_>>>()?)?.into_any())
    };
    let mut rows = answers.values.into_iter().map(lines).collect::<PyResult<Vec<_>>>()?;
    // From the last axis to the first, rows are gathered into lists.
    for axis in (0..answers.shape.len()).rev() {
        let (length, lists) = (answers.shape[axis], answers.shape[..axis].iter().product());
        let gathered = (0..lists).map(|at: usize| PyList::new(py, &rows[at * length..(at + 1) * length]));
        rows = gathered.map(|list| Ok(list?.into_any())).collect::<PyResult<Vec<_>>>()?;
    }
    let value = rows.into_iter().next().map_or_else(|| Ok(PyList::empty(py).into_any()), PyResult::Ok)?;
    with_status(value, answers.status, &answers.shape)
}

/// Seven columns: distance, lower and upper bound, (...), points of a and of b, (..., 3), and their faces, (...), which are
/// -1, and the points zero, where a mesh is empty.
#[pyfunction]
pub(crate) fn distance<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    pose_a: &Bound<'py, PyAny>,
    pose_b: &Bound<'py, PyAny>,
    on_error: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = a.py();
    let question = Question::read(a, b, pose_a, pose_b, on_error)?;
    let safe = Distance { lower: 0.0, upper: 0.0, witness: None };
    let answers = question.answer(py, safe, |a, b| query::distance(a, b))?;
    let (shape, values) = (answers.shape, answers.values);
    let points_shape = [&shape[..], &[3]].concat();
    let numbers = |of: fn(&Distance) -> f64| array(py, values.iter().map(of).collect(), &shape);
    let points = |of: fn(&Witness) -> [f64; 3]| {
        let points: Vec<[f64; 3]> = values.iter().map(|value| value.witness.as_ref().map_or([0.0; 3], of)).collect();
        array(py, points.into_flattened(), &points_shape)
    };
    let faces = |of: fn(&Witness) -> u32| {
        let faces = values.iter().map(|value| value.witness.as_ref().map_or(-1, |witness| i64::from(of(witness))));
        array(py, faces.collect(), &shape)
    };
    let columns = (
        numbers(Distance::distance)?,
        numbers(|value| value.lower)?,
        numbers(|value| value.upper)?,
        points(|witness| witness.point_a)?,
        points(|witness| witness.point_b)?,
        faces(|witness| witness.face_a)?,
        faces(|witness| witness.face_b)?,
    );
    with_status(columns.into_pyobject(py)?.into_any(), answers.status, &shape)
}

/// `bool`, or an array of them.
#[pyfunction]
pub(crate) fn within<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    clearance: f64,
    pose_a: &Bound<'py, PyAny>,
    pose_b: &Bound<'py, PyAny>,
    on_error: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let question = Question::read(a, b, pose_a, pose_b, on_error)?;
    yes_or_no(question, a.py(), move |a, b| query::within(a, b, clearance))
}

/// For each pair of faces that meet, (k, 2), a point of the world that both have in common, (k, 3), and whether they lie
/// in one plane, (k,), where the point is the origin instead.
#[pyfunction]
pub(crate) fn contact_points<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    pose_a: &Bound<'py, PyAny>,
    pose_b: &Bound<'py, PyAny>,
    pairs: PyReadonlyArray2<'py, u32>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = a.py();
    let (a, b) = (mesh_of(a, "a")?, mesh_of(b, "b")?);
    let single = |value, name| -> PyResult<Pose> {
        let read = Poses::read(value, name, OnError::Raise)?;
        let message = "a single pose is expected here";
        if read.shape.is_empty() { Ok(read.poses[0]) } else { Err(Fault::new("shape", name, message).raised(py)) }
    };
    let placement = Placement::new(&single(pose_a, "pose_a")?, &single(pose_b, "pose_b")?);
    let mut points = Vec::new();
    let mut coplanar = Vec::new();
    for pair in pairs.as_slice()?.as_chunks::<2>().0 {
        let faces = [a.faces().len(), b.faces().len()];
        if (0..2).any(|side| pair[side] as usize >= faces[side]) {
            return Err(Fault::new("index-out-of-bounds", "pairs", format!("there is no pair {pair:?}")).raised(py));
        }
        let common = crossing(&placement, &a.corners(pair[0]), &b.corners(pair[1]));
        points.push(match &common {
            Crossing::Apart | Crossing::Coplanar => [0.0; 3],
            Crossing::Point(end) => end.point,
            Crossing::Segment(from, to) => std::array::from_fn(|k| from.point[k] / 2.0 + to.point[k] / 2.0),
        });
        coplanar.push(matches!(common, Crossing::Coplanar));
    }
    let count = points.len();
    let points = array(py, points.into_flattened(), &[count, 3])?;
    Ok((points, array(py, coplanar, &[count])?).into_pyobject(py)?.into_any())
}
