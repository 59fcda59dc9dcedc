//! Arrays of poses, (..., 4, 4), and leading axes that broadcast.

use impinge::query::batch::{Broadcast, Poses};
use impinge::{InputError, Pose};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;

use crate::arrays::Plain;
use crate::errors::{Fault, kind_and_place, message};

const PLAIN: Plain = Plain { core: &[4, 4], reader: "plain_poses" };

/// Reads poses from `None`, an array or nested sequences. Matrices that are no poses become faulty rows.
///
/// # Errors
/// `InputError` if it is no array of matrices.
pub(crate) fn read(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Poses> {
    if value.is_none() {
        return Ok(Poses::default());
    }
    let plain = PLAIN.read(value, name)?;
    let shape = plain.shape();
    let lead = &shape[..shape.len() - 2];
    let (matrices, _) = plain.as_slice()?.as_chunks::<4>().0.as_chunks::<4>();
    Poses::from_matrices(lead, matrices).map_err(|error| fault(&error, name, Vec::new()).raised(value.py()))
}

/// Reads poses, each of which has to be one, and their leading axes.
///
/// # Errors
/// As [`read`], and if a matrix is no pose.
pub(crate) fn read_all(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, Vec<Pose>)> {
    let poses = read(value, name)?;
    raise_first_fault(value.py(), &poses, name)?;
    Ok((poses.shape().to_vec(), poses.into_all()))
}

/// Reads one pose.
///
/// # Errors
/// As [`read_all`], and if there are leading axes.
pub(crate) fn read_one(value: &Bound<'_, PyAny>, name: &str, message: &'static str) -> PyResult<Pose> {
    match &read_all(value, name)? {
        (shape, poses) if shape.is_empty() && poses.len() == 1 => Ok(poses[0]),
        _ => Err(Fault::new("shape", name, message).raised(value.py())),
    }
}

/// Raises the first fault of some poses.
pub(crate) fn raise_first_fault(py: Python<'_>, poses: &Poses, name: &str) -> PyResult<()> {
    match poses.first_fault() {
        None => Ok(()),
        Some((row, error)) => Err(fault(error, name, Broadcast::place(poses.shape(), row)).raised(py)),
    }
}

pub(crate) fn fault(error: &InputError, name: &str, mut at: Vec<usize>) -> Fault {
    let (kind, place) = kind_and_place(error);
    at.extend(place);
    let rigid = "round shapes want a rotation and a translation, within 1e-4";
    let hint = if kind == "not-rigid" { Some(rigid) } else { error.hint() };
    Fault::new(kind, name, message(error)).at(at).hint(hint)
}

/// Returns how the leading axes of two arguments broadcast, by their names.
///
/// # Errors
/// `InputError` naming the second, if they do not fit.
pub(crate) fn broadcast(
    py: Python<'_>,
    (a, name_a): (&[usize], &str),
    (b, name_b): (&[usize], &str),
) -> PyResult<Broadcast> {
    Broadcast::new(a, b).map_err(|error| Fault::new("shape", name_b, format!("{error}, those of {name_a}")).raised(py))
}
