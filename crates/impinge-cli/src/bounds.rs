//! Bounding boxes for reports and hints. No answer depends on them.

use impinge::{Mesh, Pose};
use rayon::prelude::*;

/// An axis-aligned box whose corners are rounded to nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Bounds {
    /// Returns the box of the faces' corners after the pose maps them. Returns `None` if the mesh
    /// has no faces.
    pub(crate) fn of(mesh: &Mesh, pose: &Pose) -> Option<Self> {
        let of_face = |face: &[u32; 3]| {
            let corners = face.map(|vertex| pose.apply(mesh.positions().get(vertex as usize)));
            corners.map(|corner| Self { min: corner, max: corner }).into_iter().reduce(Self::union)
        };
        mesh.faces().par_iter().filter_map(of_face).reduce_with(Self::union)
    }

    /// Returns the edge lengths along the axes.
    pub(crate) fn extents(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.max[axis] - self.min[axis])
    }

    /// Returns the length of the diagonal.
    pub(crate) fn diagonal(&self) -> f64 {
        self.extents().iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Reports whether `other` lies in the interior of this box.
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
