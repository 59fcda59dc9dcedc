//! How far apart two meshes are, and whether they keep a clearance. Each row starts from where the last one of its block
//! was nearest, which changes no answer.

use impinge::mesh::{Options, Placed};
use impinge::query::{self, Distance, Solid, Witness, WitnessCache};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::question::{Question, SolidOption};
use crate::verbs::yes_or_no;

/// Seven columns: distance, lower and upper bound, (...), points of a and of b, (..., 3), and their faces, (...), which are
/// -1, and the points zero, where there are none.
#[pyfunction]
pub(crate) fn distance<'py>(py: Python<'py>, question: Question, solid: SolidOption) -> PyResult<Bound<'py, PyAny>> {
    const TOUCHING: Distance = Distance { lower: 0.0, upper: 0.0, witness: None };
    let answers = question.answer_learning(py, TOUCHING, move |cache: &mut WitnessCache, a, b| {
        let surfaces = query::distance_with(a, b, cache, &Options::default());
        if surfaces.upper > 0.0 && is_contained(a, b, solid.0) { TOUCHING } else { surfaces }
    })?;
    answers.returned(py, |values, shape| {
        let numbers = |of: fn(&Distance) -> f64| array(py, values.iter().map(of).collect(), shape);
        let points = |of: fn(&Witness) -> [f64; 3]| {
            let point = |value: &Distance| value.witness.as_ref().map_or([0.0; 3], of);
            row_array(py, values.iter().map(point).collect(), shape)
        };
        let faces = |of: fn(&Witness) -> u32| {
            let face = |value: &Distance| value.witness.as_ref().map_or(-1, |witness| i64::from(of(witness)));
            array(py, values.iter().map(face).collect(), shape)
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
        Ok(columns.into_pyobject(py)?.into_any())
    })
}

/// `bool`, or an array of them.
#[pyfunction]
pub(crate) fn within<'py>(
    py: Python<'py>,
    question: Question,
    clearance: f64,
    solid: SolidOption,
) -> PyResult<Bound<'py, PyAny>> {
    let ask = move |cache: &mut WitnessCache, a: Placed<'_>, b: Placed<'_>| {
        query::within_with(a, b, clearance, cache, &Options::default()) || is_contained(a, b, solid.0)
    };
    yes_or_no(py, question.answer_learning(py, true, ask)?)
}

/// Whether one of two meshes whose surfaces are apart has a part inside the other, a solid one.
fn is_contained(a: Placed<'_>, b: Placed<'_>, solid: Solid) -> bool {
    solid != Solid::Neither && query::intersects_solid(a, b, solid)
}
