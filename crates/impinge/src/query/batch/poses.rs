//! Poses with leading axes. Some of the poses may be invalid.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;

/// Poses in rows with leading axes, in row-major order. An invalid pose keeps its row and its
/// error. Cloning is cheap, as clones share the poses.
#[derive(Clone, Debug)]
pub struct Poses {
    shape: Vec<usize>,
    poses: Arc<Vec<Pose>>,
    faults: BTreeMap<usize, InputError>,
}

impl Default for Poses {
    /// Returns the identity, without leading axes.
    fn default() -> Self {
        Self::from(Pose::IDENTITY)
    }
}

impl From<Pose> for Poses {
    /// Returns one pose, without leading axes.
    fn from(pose: Pose) -> Self {
        Self { shape: Vec::new(), poses: Arc::new(vec![pose]), faults: BTreeMap::new() }
    }
}

impl From<Vec<Pose>> for Poses {
    /// Returns poses along one leading axis.
    fn from(poses: Vec<Pose>) -> Self {
        Self { shape: vec![poses.len()], poses: Arc::new(poses), faults: BTreeMap::new() }
    }
}

impl Poses {
    /// Returns the poses of 4 x 4 matrices, in row-major order. `shape` has the lengths of the
    /// leading axes. A matrix that is not a valid pose becomes a row with an error
    /// ([`Pose::from_matrix`]).
    ///
    /// # Errors
    /// [`OtherCount`](InputErrorKind::OtherCount) if the number of matrices is not the product of
    /// the leading axes.
    ///
    /// ```
    /// use impinge::query::batch::Poses;
    ///
    /// let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    /// let poses = Poses::from_matrices(&[2], &[identity, [[f64::NAN; 4]; 4]])?;
    /// assert_eq!(poses.first_fault().map(|(row, _)| row), Some(1));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    pub fn from_matrices(shape: &[usize], matrices: &[[[f64; 4]; 4]]) -> Result<Self, InputError> {
        let expected = shape.iter().fold(1_usize, |rows, &extent| rows.saturating_mul(extent));
        if matrices.len() != expected {
            let count = matrices.len();
            return Err(InputError::new(InputErrorKind::OtherCount { what: "poses", count, expected }));
        }
        let mut poses = Vec::with_capacity(matrices.len());
        let mut faults = BTreeMap::new();
        for (row, matrix) in matrices.iter().enumerate() {
            poses.push(Pose::from_matrix(*matrix).unwrap_or_else(|error| {
                faults.insert(row, error);
                Pose::IDENTITY
            }));
        }
        Ok(Self { shape: shape.to_vec(), poses: Arc::new(poses), faults })
    }

    /// Returns the length of each leading axis. Empty for a single pose.
    #[must_use]
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.poses.len()
    }

    /// Reports whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
    }

    /// Returns the pose of a row.
    ///
    /// # Errors
    /// Returns the error of the row if its pose is invalid.
    ///
    /// # Panics
    /// If `row` is not less than [`len`](Self::len).
    pub fn get(&self, row: usize) -> Result<&Pose, &InputError> {
        match self.faults.get(&row) {
            Some(error) => Err(error),
            None => Ok(&self.poses[row]),
        }
    }

    /// Returns the first row with an invalid pose and its error, or `None` if all poses are valid.
    #[must_use]
    pub fn first_fault(&self) -> Option<(usize, &InputError)> {
        self.faults.iter().next().map(|(&row, error)| (row, error))
    }

    /// Returns the poses of all rows, in row-major order. A row with an invalid pose has the
    /// identity.
    #[must_use]
    pub fn into_all(self) -> Vec<Pose> {
        Arc::unwrap_or_clone(self.poses)
    }

    /// Adds an error to each row whose pose `check` rejects. A row keeps an error that it already
    /// has.
    pub(crate) fn reject_if(&mut self, check: impl Fn(&Pose) -> Result<(), InputError>) {
        for (row, pose) in self.poses.iter().enumerate() {
            if let Err(error) = check(pose) {
                self.faults.entry(row).or_insert(error);
            }
        }
    }
}
