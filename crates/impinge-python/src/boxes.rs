//! Axis-aligned boxes as arrays of their corners.

use impinge::query::batch::Broadcast;
use impinge::volume::MinMax;
use pyo3::prelude::*;

use crate::errors::{Fault, kind_and_place, message};
use crate::points::Points;
use crate::poses;

/// Boxes with their leading axes.
pub(crate) struct Boxes {
    /// Lengths of the leading axes. Empty for a single box.
    pub(crate) shape: Vec<usize>,
    /// Boxes in row-major order.
    pub(crate) rows: Vec<MinMax>,
}

impl Boxes {
    /// Reads boxes from lower and upper corners, each (..., 3), which broadcast. Without upper
    /// corners the boxes are points.
    ///
    /// # Errors
    /// `InputError` if a coordinate is not finite or not below 2^`exponent`, if the leading axes do
    /// not broadcast, or if an upper corner is below a lower one.
    pub(crate) fn read(low: &Bound<'_, PyAny>, high: Option<&Bound<'_, PyAny>>, exponent: i32) -> PyResult<Self> {
        let py = low.py();
        let low = Points::read(low, "low", exponent)?;
        let high = high.map(|high| Points::read(high, "high", exponent)).transpose()?;
        let high = high.as_ref().unwrap_or(&low);
        let common = poses::broadcast(py, (&low.shape, "low"), (&high.shape, "high"))?;
        let mut rows = Vec::with_capacity(common.rows());
        for row in 0..common.rows() {
            let at = || Broadcast::place(common.shape(), row);
            let [at_low, at_high] = common.sources(row);
            let (low, high) = (low.rows[at_low], high.rows[at_high]);
            if (0..3).any(|axis| low[axis] > high[axis]) {
                return Err(Fault::new("order", "high", "an upper corner is below the lower one").at(at()).raised(py));
            }
            rows.push(MinMax::new(low, high).map_err(|error| {
                Fault::new(kind_and_place(&error).0, "high", message(&error)).at(at()).hint(error.hint()).raised(py)
            })?);
        }
        Ok(Self { shape: common.shape().to_vec(), rows })
    }

    /// Returns the numbers of an array of the lower and upper corners of boxes, (n, 2, 3).
    pub(crate) fn corners(boxes: &[MinMax]) -> Vec<f64> {
        boxes.iter().flat_map(|bounds| [bounds.min(), bounds.max()]).flatten().collect()
    }
}
