//! Arrays of poses, (..., 4, 4), judged before any work.

use impinge::{InputError, Pose};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;

use crate::arrays::Plain;
use crate::broadcast::Broadcast;
use crate::errors::{Fault, kind_and_place, message};

const PLAIN: Plain = Plain { core: &[4, 4], reader: "plain_poses" };

/// What becomes of a pose that is none.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum OnError {
    /// The call raises `InputError`, naming it.
    Raise,
    /// Its rows are answered safely, and a status says so.
    Status,
}

impl OnError {
    /// Reads the option of that name.
    pub(crate) fn read(option: &Bound<'_, PyAny>) -> PyResult<Self> {
        match option.extract::<&str>() {
            Ok("raise") => Ok(Self::Raise),
            Ok("status") => Ok(Self::Status),
            _ => {
                let message = format!("must be \"raise\" or \"status\", not {}", option.repr()?);
                Err(Fault::new("option", "on_error", message).raised(option.py()))
            }
        }
    }
}

/// Poses with their leading axes.
pub(crate) struct Poses {
    /// The leading axes; none for a single pose.
    pub(crate) shape: Vec<usize>,
    /// In row-major order; the identity stands for what is no pose.
    pub(crate) poses: Vec<Pose>,
    /// The value of `impinge.Status` of each, where any is bad.
    pub(crate) status: Option<Vec<u8>>,
}

impl Poses {
    /// Reads `None`, an array or nested sequences.
    ///
    /// # Errors
    /// `InputError` where it is no array of matrices; where one of them is no pose, unless `on_error` lets it pass.
    pub(crate) fn read(value: &Bound<'_, PyAny>, name: &str, on_error: OnError) -> PyResult<Self> {
        if value.is_none() {
            return Ok(Self { shape: Vec::new(), poses: vec![Pose::IDENTITY], status: None });
        }
        let plain = PLAIN.read(value, name)?;
        let shape = plain.shape();
        let lead = shape[..shape.len() - 2].to_vec();
        let numbers = plain.as_slice()?;
        let (matrices, _) = numbers.as_chunks::<4>().0.as_chunks::<4>();
        let mut poses = Vec::with_capacity(matrices.len());
        let mut status = None;
        for (row, matrix) in matrices.iter().enumerate() {
            match Pose::from_matrix(*matrix) {
                Ok(pose) => poses.push(pose),
                Err(error) if on_error == OnError::Raise => {
                    return Err(fault(&error, name, Broadcast::place(&lead, row)).raised(value.py()));
                }
                Err(error) => {
                    poses.push(Pose::IDENTITY);
                    status.get_or_insert_with(|| vec![0; matrices.len()])[row] = status_of(&error);
                }
            }
        }
        Ok(Self { shape: lead, poses, status })
    }
}

fn fault(error: &InputError, name: &str, mut at: Vec<usize>) -> Fault {
    let (kind, place) = kind_and_place(error);
    at.extend(place);
    Fault::new(kind, name, message(error)).at(at).hint(error.hint())
}

/// The value of `impinge.Status` for an error.
fn status_of(error: &InputError) -> u8 {
    match kind_and_place(error).0 {
        "non-finite" => 1,
        "out-of-range" => 2,
        "not-affine" => 3,
        _ => 4, // singular: a matrix has no other faults
    }
}
