//! Broadcasting of the leading axes of two operands, as in NumPy.

use std::error::Error;
use std::fmt;

/// Maps each row of an answer to the rows of the two operands that it uses. Rows are counted in
/// row-major order.
#[derive(Clone, Debug)]
pub struct Broadcast {
    shape: Vec<usize>,
    rows: usize,
    /// Step in each operand along each axis of the answer. Zero if one entry serves the whole axis.
    steps: [Vec<usize>; 2],
}

/// Error: the leading axes of two operands do not broadcast, or there are more rows than a `usize`
/// can count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BroadcastError {
    /// Lengths of the leading axes of the two operands.
    pub shapes: [Vec<usize>; 2],
}

impl Broadcast {
    /// Returns how two operands broadcast, given the lengths of their leading axes. Axes are
    /// aligned at the last one. An axis that has length 1 or is missing takes the length of the
    /// other operand's axis.
    ///
    /// # Errors
    /// If two lengths differ and neither is 1, or if the number of rows exceeds a `usize`.
    ///
    /// ```
    /// use impinge::query::batch::Broadcast;
    ///
    /// let each_with_each = Broadcast::new(&[3, 1], &[2])?;
    /// assert_eq!((each_with_each.shape(), each_with_each.rows()), (&[3, 2][..], 6));
    /// assert_eq!(each_with_each.sources(5), [2, 1]);
    /// assert!(Broadcast::new(&[3], &[2]).is_err());
    /// # Ok::<(), impinge::query::batch::BroadcastError>(())
    /// ```
    pub fn new(a: &[usize], b: &[usize]) -> Result<Self, BroadcastError> {
        Self::of(a, b).ok_or_else(|| BroadcastError { shapes: [a.to_vec(), b.to_vec()] })
    }

    fn of(a: &[usize], b: &[usize]) -> Option<Self> {
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
        // An empty axis makes the answer empty, however long the other axes are.
        let counted = shape.iter().try_fold(1_usize, |rows, &extent| rows.checked_mul(extent));
        let rows = if shape.contains(&0) { 0 } else { counted? };
        let steps = [a, b].map(|own| {
            let mut steps = vec![0; axes];
            let mut step = 1_usize;
            for axis in (0..axes).rev() {
                let extent = extent(own, axis);
                steps[axis] = if extent == 1 { 0 } else { step };
                step = step.saturating_mul(extent);
            }
            steps
        });
        Some(Self { shape, rows, steps })
    }

    /// Returns the length of each leading axis of the answer.
    #[must_use]
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the number of rows of the answer: the product of its leading axes.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the row of each operand that a row of the answer uses. `row` must be less than
    /// [`rows`](Self::rows); otherwise the result is meaningless.
    ///
    /// # Panics
    /// If the answer has no rows, unless it has exactly one leading axis.
    #[must_use]
    pub fn sources(&self, row: usize) -> [usize; 2] {
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

    /// Returns the index of a row along each leading axis. `shape` has the lengths of these axes,
    /// and `row` must be less than their product.
    ///
    /// # Panics
    /// If an axis has length zero, so that there is no row.
    #[must_use]
    pub fn place(shape: &[usize], row: usize) -> Vec<usize> {
        let mut place = vec![0; shape.len()];
        let mut rest = row;
        for axis in (0..shape.len()).rev() {
            place[axis] = rest % shape[axis];
            rest /= shape[axis];
        }
        place
    }
}

impl fmt::Display for BroadcastError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.shapes;
        write!(f, "leading axes {b:?} do not broadcast with {a:?} (lengths have to be equal or 1)")
    }
}

impl Error for BroadcastError {}
