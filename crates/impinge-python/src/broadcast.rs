//! NumPy's broadcasting of the leading axes of two arrays of poses.

use pyo3::prelude::*;

use crate::errors::Fault;

/// Which row of either operand each row of the answer takes; rows are counted in row-major order.
#[derive(Clone, Debug)]
pub(crate) struct Broadcast {
    /// The leading axes of the answer.
    pub(crate) shape: Vec<usize>,
    /// Rows of the answer: the product of `shape`.
    pub(crate) rows: usize,
    /// Steps in each operand along each axis of the answer; zero where one entry serves the whole axis.
    steps: [Vec<usize>; 2],
}

impl Broadcast {
    /// The common shape of two operands; nothing where they do not fit or there are more rows than can be counted.
    pub(crate) fn new(a: &[usize], b: &[usize]) -> Option<Self> {
        let axes = a.len().max(b.len());
        let extent = |shape: &[usize], axis: usize| (axis + shape.len()).checked_sub(axes).map_or(1, |own| shape[own]);
        let mut shape = Vec::with_capacity(axes);
        for axis in 0..axes {
            shape.push(match (extent(a, axis), extent(b, axis)) {
                (same, other) if same == other => same,
                (1, extent) | (extent, 1) => extent,
                _ => return None,
            });
        }
        // An empty axis makes the answer empty, however long the others are.
        let counted = shape.iter().try_fold(1_usize, |rows, &extent| rows.checked_mul(extent));
        let rows = if shape.contains(&0) { 0 } else { counted? };
        let steps = [a, b].map(|own| {
            let mut steps = vec![0; axes];
            let mut step = 1;
            for axis in (0..axes).rev() {
                let extent = extent(own, axis);
                steps[axis] = if extent == 1 { 0 } else { step };
                step *= extent;
            }
            steps
        });
        Some(Self { shape, rows, steps })
    }

    /// [`new`](Self::new) of the leading axes of two arguments, by their names.
    ///
    /// # Errors
    /// `InputError` naming the second, where they do not fit.
    pub(crate) fn of(py: Python<'_>, (a, name_a): (&[usize], &str), (b, name_b): (&[usize], &str)) -> PyResult<Self> {
        Self::new(a, b).ok_or_else(|| {
            let message = format!("leading axes {b:?} do not broadcast with {a:?}, those of {name_a}");
            Fault::new("shape", name_b, message).raised(py)
        })
    }

    /// The rows of the two operands that a row of the answer takes.
    pub(crate) fn sources(&self, row: usize) -> [usize; 2] {
        if let [_] = self.shape[..] {
            return [row * self.steps[0][0], row * self.steps[1][0]];
        }
        let mut sources = [0; 2];
        let mut rest = row;
        for axis in (0..self.shape.len()).rev() {
            let at = rest % self.shape[axis];
            rest /= self.shape[axis];
            sources[0] += at * self.steps[0][axis];
            sources[1] += at * self.steps[1][axis];
        }
        sources
    }

    /// The place of a row along each axis.
    pub(crate) fn place(shape: &[usize], row: usize) -> Vec<usize> {
        let mut place = vec![0; shape.len()];
        let mut rest = row;
        for axis in (0..shape.len()).rev() {
            place[axis] = rest % shape[axis];
            rest /= shape[axis];
        }
        place
    }
}
