//! How far apart two things are, whether they keep a clearance, how deep they are in each other,
//! and how much material they share.

use impinge::query::{Deeper, Depth, Distance, Penetration, Witness};
use pyo3::prelude::*;

use crate::arrays::{numbers, row_array};
use crate::question::{Question, Search};
use crate::verbs::yes_or_no;

/// Returns the distance of two things as seven columns in the world frame: distance, its lower and
/// upper bound, (...), nearest points of a and of b, (..., 3), and their faces, (...). If there are
/// no nearest points, the faces are -1 and the points zero.
#[pyfunction]
pub(crate) fn distance(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    let replies = question.ask(py, Search::OneThread, |batch| batch.distance())?;
    replies.returned(py, |values, shape| columns(py, &values, shape))
}

/// Returns distances as the columns that [`distance`] returns.
pub(crate) fn columns<'py>(py: Python<'py>, values: &[Distance], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let bounds = |of: fn(&Distance) -> f64| numbers(py, values.iter().map(of).collect(), shape);
    let points = |of: fn(&Witness) -> [f64; 3]| {
        let point = |value: &Distance| value.witness.as_ref().map_or([0.0; 3], of);
        row_array(py, values.iter().map(point).collect(), shape)
    };
    let faces = |side: usize| {
        let face = |value: &Distance| {
            let faces = value.witness.and_then(|witness| witness.faces);
            faces.map_or(-1, |faces| i64::from(faces[side]))
        };
        numbers(py, values.iter().map(face).collect(), shape)
    };
    let columns = (
        bounds(Distance::distance)?,
        bounds(|value| value.lower)?,
        bounds(|value| value.upper)?,
        points(|witness| witness.point_a)?,
        points(|witness| witness.point_b)?,
        faces(0)?,
        faces(1)?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}

/// Reports whether the distance of two things is at most `clearance`, in world units: one `bool`
/// without leading axes, or an array. An undecided answer counts as `True`.
#[pyfunction]
pub(crate) fn within(py: Python<'_>, question: Question, clearance: f64) -> PyResult<Bound<'_, PyAny>> {
    yes_or_no(py, question.ask(py, Search::OneThread, move |batch| batch.within(clearance))?)
}

/// Returns the penetration of two things as six columns in the world frame: whether they intersect,
/// lower and upper bound of the depth, (...), and normal, point of a and point of b, (..., 3). All
/// numbers are zero if the things do not intersect.
#[pyfunction]
pub(crate) fn penetration(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    const NONE: Penetration = Penetration { upper: 0.0, ..Penetration::UNKNOWN };
    let replies = question.that_may_take_long().ask(py, Search::Whole, |batch| batch.penetration())?;
    replies.returned(py, |values, shape| {
        let of = |value: &Option<Penetration>| value.unwrap_or(NONE);
        let bounds = |bound: fn(Penetration) -> f64| numbers(py, values.iter().map(|v| bound(of(v))).collect(), shape);
        let vectors =
            |vector: fn(Penetration) -> [f64; 3]| row_array(py, values.iter().map(|v| vector(of(v))).collect(), shape);
        let columns = (
            numbers(py, values.iter().map(Option::is_some).collect(), shape)?,
            bounds(|found| found.lower)?,
            bounds(|found| found.upper)?,
            vectors(|found| found.normal)?,
            vectors(|found| found.point_a)?,
            vectors(|found| found.point_b)?,
        );
        Ok(columns.into_pyobject(py)?.into_any())
    })
}

/// Returns how much material two things share as three columns in the world frame: lower and upper
/// bound of the depth, (...), and a point that has the lower bound, (..., 3). The point is zero if
/// the lower bound is.
#[pyfunction]
pub(crate) fn depth(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    let replies = question.that_may_take_long().ask(py, Search::Whole, |batch| batch.depth())?;
    replies.returned(py, |values, shape| {
        let bounds = |bound: fn(&Depth) -> f64| numbers(py, values.iter().map(bound).collect(), shape);
        let points = values.iter().map(|found| found.point.unwrap_or_default()).collect();
        let columns = (bounds(|found| found.lower)?, bounds(|found| found.upper)?, row_array(py, points, shape)?);
        Ok(columns.into_pyobject(py)?.into_any())
    })
}

/// Reports whether two things share material deeper than `threshold`, in world units and at least
/// zero: one `bool` without leading axes, or an array. An undecided answer counts as `True`.
#[pyfunction]
pub(crate) fn deeper(py: Python<'_>, question: Question, threshold: f64) -> PyResult<Bound<'_, PyAny>> {
    let replies = question.ask(py, Search::Derived, move |batch| batch.deeper(threshold))?;
    yes_or_no(py, replies.map(Deeper::possibly))
}
