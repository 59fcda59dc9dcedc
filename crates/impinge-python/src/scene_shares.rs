//! Shares of the check of one configuration of a scene, for several machines: the broad phase, and
//! the check of some of its pairs.

use impinge::query::batch::Execution;
use numpy::{PyArray2, PyArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::question::wants_status;
use crate::scene::{Ignored, MovedScene, Part, QuestionOption, check_poses, configurations};
use crate::workers::{self, Call};

/// Returns the leading axes of the poses, and the broad phase if there is one configuration. The
/// broad phase is its status, the pairs of indices of parts whose boxes are near each other, (k,
/// 2), and the box of each part in the world, (n, 6), lower corner first. A part without a box has
/// NaN.
#[pyfunction]
pub(crate) fn scene_candidates<'py>(
    py: Python<'py>,
    parts: Vec<Part<'py>>,
    ignored: Ignored<'py>,
    question: QuestionOption,
    on_error: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (wants_status, QuestionOption(question)) = (wants_status(on_error)?, question);
    let MovedScene { scene, moves } = MovedScene::read(py, &parts, Some(&ignored))?;
    let rows = check_poses(py, &scene, &moves, wants_status)?;
    let axes = configurations(&scene, &moves).shape().to_vec();
    if rows != 1 {
        return Ok((axes, py.None()).into_pyobject(py)?.into_any());
    }
    let found = workers::run(py, move |budget| {
        let found = scene.candidates(question, &configurations(&scene, &moves), 0, budget)?;
        let pairs: Vec<[u32; 2]> = found.pairs.iter().map(|pair| pair.map(|part| part.index() as u32)).collect();
        let boxes: Vec<[f64; 6]> = found.boxes.iter().map(|corners| numbers_of_box(*corners)).collect();
        Ok((found.status as u8, pairs, boxes))
    })?;
    let (status, pairs, boxes) = found.map_err(crate::limits::raised)?;
    let (count, parts) = (pairs.len(), boxes.len());
    let broad = (status, row_array(py, pairs, &[count])?, row_array(py, boxes, &[parts])?);
    Ok((axes, broad).into_pyobject(py)?.into_any())
}

/// Returns the numbers of a box, or NaN.
pub(crate) fn numbers_of_box(corners: Option<[[f64; 3]; 2]>) -> [f64; 6] {
    corners.map_or([f64::NAN; 6], |[[a, b, c], [d, e, f]]| [a, b, c, d, e, f])
}

/// Checks some pairs of indices of parts, (k, 2), in one configuration. Returns those for which the
/// answer is yes, in their order, and whether each of them is undecided.
#[pyfunction]
pub(crate) fn check_pairs<'py>(
    py: Python<'py>,
    parts: Vec<Part<'py>>,
    pairs: &Bound<'py, PyArray2<u32>>,
    question: QuestionOption,
) -> PyResult<Bound<'py, PyAny>> {
    let QuestionOption(question) = question;
    let MovedScene { scene, moves } = MovedScene::read(py, &parts, None)?;
    let ids: Vec<_> = scene.parts().collect();
    let pairs = pairs.readonly();
    let named = pairs.as_slice()?.as_chunks::<2>().0.iter().map(|pair| {
        let part =
            |at: u32| ids.get(at as usize).copied().ok_or_else(|| PyIndexError::new_err("there is no such part"));
        Ok([part(pair[0])?, part(pair[1])?])
    });
    let named = named.collect::<PyResult<Vec<_>>>()?;
    let call = Call { rows: named.len(), is_brief: false, progress: false };
    let work = move |execution: Execution<'_>| {
        scene.check_pairs(question, &named, &configurations(&scene, &moves), 0, execution)
    };
    let (found, _) = workers::execute(py, call, work)?;
    let undecided: Vec<bool> = found.iter().map(|pair| pair.is_undecided).collect();
    let found: Vec<[u32; 2]> = found.iter().map(|pair| pair.parts.map(|part| part.index() as u32)).collect();
    let count = found.len();
    Ok((row_array(py, found, &[count])?, array(py, undecided, &[count])?).into_pyobject(py)?.into_any())
}
