//! Queries about two things. Each calls the query of the library for the rows of a batch.

use std::collections::HashMap;

use impinge::Mesh;
use impinge::exact::{Crossing, Placement, crossing};
use impinge::query::batch::Batch;
use impinge::query::{self, ContactOptions, ContactPatch, Curves, Penetrates, Query};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyList};

use crate::arrays::{array, ragged, row_array};
use crate::contacts;
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::question::{Question, Replies, Search};
use crate::workers;

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
    yes_or_no(py, question.ask(py, Search::AllThreads, |batch| batch.penetrates())?.map(Penetrates::possibly))
}

/// Converts booleans for Python: one `bool` without leading axes, or an array.
pub(crate) fn yes_or_no(py: Python<'_>, replies: Replies<bool>) -> PyResult<Bound<'_, PyAny>> {
    replies.returned(py, |values, shape| match values[..] {
        [value] if shape.is_empty() => Ok(PyBool::new(py, value).to_owned().into_any()),
        _ => array(py, values, shape),
    })
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

/// Returns for each pair of intersecting faces, (k, 2), a common point in the world frame, (k, 3),
/// and whether the faces lie in one plane, (k,). The point of such a pair is the origin instead.
#[pyfunction]
pub(crate) fn contact_points<'py>(
    py: Python<'py>,
    question: Question,
    pairs: PyReadonlyArray2<'py, u32>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some([world_from_a, world_from_b]) = question.single() else {
        return Err(Fault::new("shape", "pose_b", "a single pose is expected here").raised(py));
    };
    let [a, b] = both_meshes(py, &question)?;
    let placement = Placement::new(&world_from_a, &world_from_b);
    let mut points = Vec::new();
    let mut coplanar = Vec::new();
    for pair in pairs.as_slice()?.as_chunks::<2>().0 {
        let faces = [a.faces().len(), b.faces().len()];
        if (0..2).any(|side| pair[side] as usize >= faces[side]) {
            let message = format!("pair {pair:?} is out of range: a has {} faces, b has {}", faces[0], faces[1]);
            return Err(Fault::new("index-out-of-bounds", "pairs", message).raised(py));
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
    Ok((row_array(py, points, &[count])?, array(py, coplanar, &[count])?).into_pyobject(py)?.into_any())
}

/// Returns for each pair of intersecting faces, (k, 2), the normal, (k, 3), and the depth, (k,), of
/// its region of contact, in the world frame. Pairs that do not intersect get zeros.
#[pyfunction]
pub(crate) fn contact_normals<'py>(
    py: Python<'py>,
    question: Question,
    pairs: PyReadonlyArray2<'py, u32>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some([world_from_a, world_from_b]) = question.single() else {
        return Err(Fault::new("shape", "pose_b", "a single pose is expected here").raised(py));
    };
    let [a, b] = both_meshes(py, &question)?.map(Clone::clone);
    let pairs = pairs.as_slice()?.as_chunks::<2>().0.to_vec();
    let count = pairs.len();
    let found = workers::run(py, move |_| {
        let patches = query::contact_patches(a.at(world_from_a), b.at(world_from_b));
        let of_patch = |patch: &ContactPatch| {
            let found = (patch.normal, patch.depth);
            patch.pairs.iter().map(move |&pair| (pair, found)).collect::<Vec<_>>()
        };
        let found: HashMap<[u32; 2], ([f64; 3], f64)> = patches.iter().flat_map(of_patch).collect();
        pairs.iter().map(|pair| found.get(pair).copied().unwrap_or_default()).collect::<Vec<_>>()
    })?;
    let (normals, depths): (Vec<[f64; 3]>, Vec<f64>) = found.into_iter().unzip();
    Ok((row_array(py, normals, &[count])?, array(py, depths, &[count])?).into_pyobject(py)?.into_any())
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
