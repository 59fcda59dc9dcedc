//! Arrays of poses, (..., 4, 4), and the broadcasting of leading axes.

use impinge::query::batch::{Broadcast, Poses};
use impinge::{InputError, Pose};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;

use crate::arrays::Plain;
use crate::errors::{Fault, kind_and_place, message};

/// Arrays of matrices.
const PLAIN: Plain = Plain { core: &[4, 4], reader: "plain_poses" };

/// Reads poses from `None`, an array or nested sequences. A matrix that is not a valid pose becomes
/// a row with an error.
///
/// # Errors
/// `InputError` if the value is not an array of matrices.
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

/// Reads poses that must all be valid, and their leading axes.
///
/// # Errors
/// As for [`read`], and if a pose is invalid.
pub(crate) fn read_all(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, Vec<Pose>)> {
    let poses = read(value, name)?;
    raise_first_fault(value.py(), &poses, name)?;
    Ok((poses.shape().to_vec(), poses.into_all()))
}

/// Reads one pose.
///
/// # Errors
/// As for [`read_all`], and if there are leading axes.
pub(crate) fn read_one(value: &Bound<'_, PyAny>, name: &str, message: &'static str) -> PyResult<Pose> {
    match &read_all(value, name)? {
        (shape, poses) if shape.is_empty() && poses.len() == 1 => Ok(poses[0]),
        _ => Err(Fault::new("shape", name, message).raised(value.py())),
    }
}

/// Raises the first error of some poses.
pub(crate) fn raise_first_fault(py: Python<'_>, poses: &Poses, name: &str) -> PyResult<()> {
    match poses.first_fault() {
        None => Ok(()),
        Some((row, error)) => Err(fault(error, name, Broadcast::place(poses.shape(), row)).raised(py)),
    }
}

/// Returns an error about a pose at an index of an argument.
pub(crate) fn fault(error: &InputError, name: &str, mut at: Vec<usize>) -> Fault {
    let (kind, place) = kind_and_place(error);
    at.extend(place);
    let rigid = "round shapes need a rotation and a translation, within 1e-4";
    let hint = if kind == "not-rigid" { Some(rigid) } else { error.hint() };
    Fault::new(kind, name, message(error)).at(at).hint(hint)
}

/// Returns how the leading axes of two arguments broadcast.
///
/// # Errors
/// `InputError` about the second argument, if they do not broadcast.
pub(crate) fn broadcast(
    py: Python<'_>,
    (a, name_a): (&[usize], &str),
    (b, name_b): (&[usize], &str),
) -> PyResult<Broadcast> {
    Broadcast::new(a, b).map_err(|error| Fault::new("shape", name_b, format!("{error}, those of {name_a}")).raised(py))
}
