//! How far apart two meshes are, whether they keep a clearance, and how deep they are in each other. Each row of distances starts
//! from where the last one of its block was nearest, which changes no answer.

use impinge::mesh::{Options, Placed};
use impinge::query::shapes::{Penetration, Proximity};
use impinge::query::{self, Distance, Witness, WitnessCache};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::question::{Answers, Question, SolidOption};
use crate::verbs::yes_or_no;

/// Seven columns: distance, lower and upper bound, (...), points of a and of b, (..., 3), and their faces, (...), which are
/// -1, and the points zero, where there are none.
#[pyfunction]
pub(crate) fn distance<'py>(py: Python<'py>, question: Question, solid: SolidOption) -> PyResult<Bound<'py, PyAny>> {
    const TOUCHING: Distance = Distance { lower: 0.0, upper: 0.0, witness: None };
    let ask = move |cache: &mut WitnessCache, options: &Options<'_>, a: Placed<'_>, b: Placed<'_>| {
        let of_surfaces = query::distance_with(a, b, cache, options);
        let nested = if of_surfaces.upper > 0.0 { query::nested(a, b, solid.0) } else { Proximity::Apart };
        (if nested == Proximity::Apart { of_surfaces } else { TOUCHING }, nested == Proximity::Undecided)
    };
    let answers = question.answer_interruptibly(py, solid.0, true, (TOUCHING, false), ask)?;
    let answers = answers.judged(|found| found.1, |found| found.0);
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

/// `bool`, or an array of them; what is undecided counts as yes.
#[pyfunction]
pub(crate) fn within<'py>(
    py: Python<'py>,
    question: Question,
    clearance: f64,
    solid: SolidOption,
) -> PyResult<Bound<'py, PyAny>> {
    let ask = move |cache: &mut WitnessCache, options: &Options<'_>, a: Placed<'_>, b: Placed<'_>| {
        if query::within_with(a, b, clearance, cache, options) {
            return Proximity::Meets;
        }
        if clearance >= 0.0 { query::nested(a, b, solid.0) } else { Proximity::Apart }
    };
    let answers = question.answer_interruptibly(py, solid.0, true, Proximity::Meets, ask)?;
    yes_or_no(py, answers.judged(|&found| found == Proximity::Undecided, |found| found != Proximity::Apart))
}

/// What `penetration_columns` makes of two meshes, taken as solids.
#[pyfunction]
pub(crate) fn penetration(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    let answers = question.that_takes_long().answer(py, Some(UNKNOWN_DEPTH), |a, b| query::penetration(a, b))?;
    penetration_columns(py, answers)
}

/// What is known of the depth of two bodies of which nothing is.
pub(crate) const UNKNOWN_DEPTH: Penetration = Penetration { upper: f64::INFINITY, ..NO_DEPTH };

const NO_DEPTH: Penetration =
    Penetration { lower: 0.0, upper: 0.0, normal: [0.0; 3], point_a: [0.0; 3], point_b: [0.0; 3] };

/// Six columns: whether they meet, lower and upper bound, (...), and normal and points of a and of b, (..., 3); all are zero
/// where they do not.
pub(crate) fn penetration_columns(py: Python<'_>, answers: Answers<Option<Penetration>>) -> PyResult<Bound<'_, PyAny>> {
    answers.returned(py, |values, shape| {
        let of = |value: &Option<Penetration>| value.unwrap_or(NO_DEPTH);
        let numbers = |number: fn(Penetration) -> f64| array(py, values.iter().map(|v| number(of(v))).collect(), shape);
        let vectors =
            |vector: fn(Penetration) -> [f64; 3]| row_array(py, values.iter().map(|v| vector(of(v))).collect(), shape);
        let columns = (
            array(py, values.iter().map(Option::is_some).collect(), shape)?,
            numbers(|found| found.lower)?,
            numbers(|found| found.upper)?,
            vectors(|found| found.normal)?,
            vectors(|found| found.point_a)?,
            vectors(|found| found.point_b)?,
        );
        Ok(columns.into_pyobject(py)?.into_any())
    })
}
