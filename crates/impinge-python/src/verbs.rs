//! The verbs on two meshes, each the library's own in a question's rows.

use std::collections::HashMap;

use impinge::exact::{Crossing, Placement, crossing};
use impinge::mesh::{Options, Placed};
use impinge::query::shapes::Proximity;
use impinge::query::{self, ContactPatch, Curves, HitCache, Penetrates, Solid};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyList};

use crate::arrays::{array, ragged, row_array};
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::question::{Answers, Question, SolidOption};
use crate::workers;

/// `bool`, or an array of them; what is undecided counts as yes.
#[pyfunction]
pub(crate) fn intersects<'py>(py: Python<'py>, question: Question, solid: SolidOption) -> PyResult<Bound<'py, PyAny>> {
    let ask = move |cache: &mut HitCache, options: &Options<'_>, a: Placed<'_>, b: Placed<'_>| {
        if query::intersects_with(a, b, cache, options) {
            return Proximity::Meets;
        }
        query::nested(a, b, solid.0)
    };
    let answers = question.answer_interruptibly(py, solid.0, true, Proximity::Meets, ask)?;
    yes_or_no(py, answers.judged(|&found| found == Proximity::Undecided, |found| found != Proximity::Apart))
}

/// `bool`, or an array of them; what is undecided counts as yes.
#[pyfunction]
pub(crate) fn penetrates<'py>(py: Python<'py>, question: Question) -> PyResult<Bound<'py, PyAny>> {
    let answers = question.answer(py, Penetrates::Undecided, |a, b| query::penetrates(a, b))?;
    yes_or_no(py, answers.judged(|&answer| answer == Penetrates::Undecided, Penetrates::possibly))
}

/// Booleans as Python has them: one of its own, or an array.
pub(crate) fn yes_or_no(py: Python<'_>, answers: Answers<bool>) -> PyResult<Bound<'_, PyAny>> {
    answers.returned(py, |values, shape| match values[..] {
        [value] if shape.is_empty() => Ok(PyBool::new(py, value).to_owned().into_any()),
        _ => array(py, values, shape),
    })
}

/// An (k, 2) array, or the offsets of each row with those of all rows in one. `limit` cuts each row short.
#[pyfunction]
pub(crate) fn intersecting_pairs<'py>(
    py: Python<'py>,
    question: Question,
    limit: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let answers =
        question.answer_interruptibly(py, Solid::Neither, false, Vec::new(), move |(), options, a, b| match limit {
            Some(limit) => query::intersecting_pairs_up_to(a, b, limit, options).pairs,
            None => query::intersecting_pairs_with(a, b, options),
        })?;
    answers.returned(py, |values, shape| {
        let (offsets, pairs) = ragged(values);
        let (count, is_single) = (pairs.len(), shape.is_empty());
        let pairs = row_array(py, pairs, &[count])?;
        if is_single {
            return Ok(pairs);
        }
        let places = offsets.len();
        Ok((array(py, offsets, &[places])?, pairs, shape).into_pyobject(py)?.into_any())
    })
}

/// A list of (n, 3) arrays, of one row for points that surfaces touch in; in as many lists as there are leading axes.
#[pyfunction]
pub(crate) fn intersection_curves<'py>(py: Python<'py>, question: Question) -> PyResult<Bound<'py, PyAny>> {
    let answers = question.answer(py, Vec::new(), |a, b| {
        let Curves { mut polylines, points, .. } = query::intersection_curves(a, b);
        polylines.extend(points.into_iter().map(|point| vec![point]));
        polylines
    })?;
    let lines = |lines: Vec<Vec<[f64; 3]>>| -> PyResult<Bound<'py, PyAny>> {
        let lines = lines.into_iter().map(|line| {
            let count = line.len();
            row_array(py, line, &[count])
        });
        Ok(PyList::new(py, lines.collect::<PyResult<Vec<_>>>()?)?.into_any())
    };
    answers.returned(py, |values, shape| {
        let mut rows = values.into_iter().map(lines).collect::<PyResult<Vec<_>>>()?;
        // From the last axis to the first, rows are gathered into lists.
        for axis in (0..shape.len()).rev() {
            let (length, lists) = (shape[axis], shape[..axis].iter().product());
            let gathered = (0..lists).map(|at: usize| PyList::new(py, &rows[at * length..(at + 1) * length]));
            rows = gathered.map(|list| Ok(list?.into_any())).collect::<PyResult<Vec<_>>>()?;
        }
        rows.into_iter().next().map_or_else(|| Ok(PyList::empty(py).into_any()), PyResult::Ok)
    })
}

/// An (k, 2) array.
#[pyfunction]
pub(crate) fn self_intersecting_pairs<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    let pairs = workers::run(py, move |_| query::self_intersecting_pairs(&mesh))?;
    let count = pairs.len();
    row_array(py, pairs, &[count])
}

/// For each pair of faces that meet, (k, 2), a point of the world that both have in common, (k, 3), and whether they lie
/// in one plane, (k,), where the point is the origin instead.
#[pyfunction]
pub(crate) fn contact_points<'py>(
    py: Python<'py>,
    question: Question,
    pairs: PyReadonlyArray2<'py, u32>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(([a, b], [world_from_a, world_from_b])) = question.single() else {
        return Err(Fault::new("shape", "pose_b", "a single pose is expected here").raised(py));
    };
    let placement = Placement::new(&world_from_a, &world_from_b);
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
    Ok((row_array(py, points, &[count])?, array(py, coplanar, &[count])?).into_pyobject(py)?.into_any())
}

/// For each pair of faces that meet, (k, 2), the normal of the region in which it does, (k, 3), and how deep that is, (k,); zeros
/// for a pair that does not meet.
#[pyfunction]
pub(crate) fn contact_normals<'py>(
    py: Python<'py>,
    question: Question,
    pairs: PyReadonlyArray2<'py, u32>,
) -> PyResult<Bound<'py, PyAny>> {
    let pairs = pairs.as_slice()?.as_chunks::<2>().0.to_vec();
    let count = pairs.len();
    let answers = question.that_takes_long().answer(py, Vec::new(), move |a, b| {
        let patches = query::contact_patches(a, b);
        let of_patch = |patch: &ContactPatch| {
            let found = (patch.normal, patch.depth);
            patch.pairs.iter().map(move |&pair| (pair, found)).collect::<Vec<_>>()
        };
        let found: HashMap<[u32; 2], ([f64; 3], f64)> = patches.iter().flat_map(of_patch).collect();
        pairs.iter().map(|pair| found.get(pair).copied().unwrap_or_default()).collect::<Vec<_>>()
    })?;
    answers.returned(py, |values, _| {
        let (normals, depths): (Vec<[f64; 3]>, Vec<f64>) = values.into_iter().flatten().unzip();
        Ok((row_array(py, normals, &[count])?, array(py, depths, &[count])?).into_pyobject(py)?.into_any())
    })
}
