//! The box of a mesh's surface, for what is told and hinted; no answer rests on it.

use impinge::{Mesh, Pose};
use rayon::prelude::*;

/// An axis-aligned box, rounded to nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Bounds {
    /// The box of the faces' corners in the frame that the pose maps to; none for a mesh without faces.
    pub(crate) fn of(mesh: &Mesh, pose: &Pose) -> Option<Self> {
        let of_face = |face: &[u32; 3]| {
            let corners = face.map(|vertex| pose.apply(mesh.positions().get(vertex as usize)));
            corners.map(|corner| Self { min: corner, max: corner }).into_iter().reduce(Self::union)
        };
        mesh.faces().par_iter().filter_map(of_face).reduce_with(Self::union)
    }

    /// Lengths along the axes.
    pub(crate) fn extents(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.max[axis] - self.min[axis])
    }

    /// The length of the diagonal.
    pub(crate) fn diagonal(&self) -> f64 {
        self.extents().iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Whether `other` lies in the interior.
    pub(crate) fn encloses(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] < other.min[axis] && other.max[axis] < self.max[axis])
    }

    fn union(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }
}
