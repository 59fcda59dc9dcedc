//! Queries about two things. Each calls the query of the library for the rows of a batch.

use impinge::Mesh;
use impinge::query::batch::Batch;
use impinge::query::{ContactOptions, Curves, Penetrates, Query, Share};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays::{array, numbers, ragged, row_array};
use crate::contacts;
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::question::{Question, Replies, Search};
use crate::workers;

/// Validates the arguments of a query of two things, and returns the leading axes of its answers.
#[pyfunction]
pub(crate) fn leading_axes(question: Question) -> Vec<usize> {
    question.leading_axes().to_vec()
}

/// Reports whether two things intersect: one `bool` without leading axes, or an array. An undecided
/// answer counts as `True`.
#[pyfunction]
pub(crate) fn intersects(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    yes_or_no(py, question.ask(py, Search::OneThread, |batch| batch.intersects())?)
}

/// Reports whether the interiors of two things intersect: one `bool` without leading axes, or an
/// array. An undecided answer counts as `True`.
#[pyfunction]
pub(crate) fn penetrates(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    yes_or_no(py, question.ask(py, Search::Derived, |batch| batch.penetrates())?.map(Penetrates::possibly))
}

/// Converts booleans for Python: one `bool` without leading axes, or an array.
pub(crate) fn yes_or_no(py: Python<'_>, replies: Replies<bool>) -> PyResult<Bound<'_, PyAny>> {
    replies.returned(py, |values, shape| numbers(py, values, shape))
}

/// Returns the pairs of intersecting faces and whether there are more: a (k, 2) array and a `bool`.
/// With leading axes it returns the offsets of the rows, the pairs of all rows in one array, the
/// leading axes, and an array of `bool`.
#[pyfunction]
pub(crate) fn intersecting_pairs(
    py: Python<'_>,
    question: Question,
    limit: Option<usize>,
) -> PyResult<Bound<'_, PyAny>> {
    both_meshes(py, &question)?;
    let verb = move |batch: &Batch<'_>| batch.intersecting_pairs_up_to(limit.unwrap_or(usize::MAX));
    question.ask(py, Search::AllThreads, verb)?.returned(py, |values, shape| {
        let (pairs, truncated): (Vec<_>, Vec<bool>) =
            values.into_iter().map(|some| (some.pairs, some.truncated)).unzip();
        let (offsets, pairs) = ragged(pairs);
        let (count, places) = (pairs.len(), offsets.len());
        let pairs = row_array(py, pairs, &[count])?;
        match truncated[..] {
            [truncated] if shape.is_empty() => Ok((pairs, truncated).into_pyobject(py)?.into_any()),
            _ => {
                let truncated = array(py, truncated, shape)?;
                Ok((array(py, offsets, &[places])?, pairs, shape, truncated).into_pyobject(py)?.into_any())
            }
        }
    })
}

/// Returns the pairs of intersecting faces of one share of the search, (k, 2). There must be one
/// row.
#[pyfunction]
pub(crate) fn intersecting_pairs_in(
    py: Python<'_>,
    question: Question,
    index: u32,
    of: u32,
) -> PyResult<Bound<'_, PyAny>> {
    both_meshes(py, &question)?;
    let share = Share::new(index, of).ok_or_else(|| PyIndexError::new_err("there is no such share"))?;
    let verb = move |batch: &Batch<'_>| {
        batch.each(Vec::new(), |query, a, b| match (a.mesh(), b.mesh()) {
            (Some(a), Some(b)) => query.intersecting_pairs_in(a, b, share),
            _ => Vec::new(),
        })
    };
    question.ask(py, Search::AllThreads, verb)?.returned(py, |values, _| {
        let pairs: Vec<[u32; 2]> = values.into_iter().flatten().collect();
        let count = pairs.len();
        row_array(py, pairs, &[count])
    })
}

/// Returns the intersection curves in the world frame: a list of (n, 3) arrays, one for each
/// polyline. A point at which surfaces touch is an array of one row. With leading axes the lists
/// are nested.
#[pyfunction]
pub(crate) fn intersection_curves(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    both_meshes(py, &question)?;
    let lines = |Curves { mut polylines, points, .. }: Curves| -> PyResult<Bound<'_, PyAny>> {
        polylines.extend(points.into_iter().map(|point| vec![point]));
        let lines = polylines.into_iter().map(|line| {
            let count = line.len();
            row_array(py, line, &[count])
        });
        Ok(PyList::new(py, lines.collect::<PyResult<Vec<_>>>()?)?.into_any())
    };
    question.ask(py, Search::AllThreads, |batch| batch.intersection_curves())?.returned(py, |values, shape| {
        let mut rows = values.into_iter().map(lines).collect::<PyResult<Vec<_>>>()?;
        // Rows are gathered into lists from the last axis to the first.
        for axis in (0..shape.len()).rev() {
            let (length, lists) = (shape[axis], shape[..axis].iter().product());
            let gathered = (0..lists).map(|at: usize| PyList::new(py, &rows[at * length..(at + 1) * length]));
            rows = gathered.map(|list| Ok(list?.into_any())).collect::<PyResult<Vec<_>>>()?;
        }
        rows.into_iter().next().map_or_else(|| Ok(PyList::empty(py).into_any()), PyResult::Ok)
    })
}

/// Returns the contacts of two things: the leading axes and the columns of `contacts::columns`.
#[pyfunction]
pub(crate) fn contacts_of(
    py: Python<'_>,
    question: Question,
    margin: f64,
    most_points: usize,
) -> PyResult<Bound<'_, PyAny>> {
    let options = ContactOptions { margin, most_points };
    let replies = question.that_may_take_long().ask(py, Search::Whole, move |batch| batch.contacts(options))?;
    replies.returned(py, |values, shape| {
        let columns = contacts::columns(py, values.iter().map(Vec::as_slice))?;
        Ok((shape, columns).into_pyobject(py)?.into_any())
    })
}

/// Returns the pairs of faces of one mesh that intersect outside of common corners and edges, (k,
/// 2).
#[pyfunction]
pub(crate) fn self_intersecting_pairs<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    let pairs = workers::run(py, move |budget| Query::new().with_budget(budget).self_intersecting_pairs(&mesh))?;
    let count = pairs.len();
    row_array(py, pairs, &[count])
}

/// Returns the two meshes of a query about faces.
fn both_meshes<'q>(py: Python<'_>, question: &'q Question) -> PyResult<[&'q Mesh; 2]> {
    let mesh = |side: usize, name: &str| {
        let mesh = question.things()[side].shape.as_mesh();
        mesh.map(|(mesh, _)| mesh)
            .ok_or_else(|| Fault::new("type", name, "must be a mesh: the answer names faces").raised(py))
    };
    Ok([mesh(0, "a")?, mesh(1, "b")?])
}
