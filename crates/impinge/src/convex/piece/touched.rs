//! The touched faces of a surface in the world, and those of them on which a point lies.

use std::cell::OnceCell;

use crate::math::Pose;
use crate::math::vec3::{dot, sub};
use crate::mesh::Mesh;
use crate::primitive::closest_on_triangle;

/// Distance from a face, relative to its size, up to which a point counts as on it: 2^-24.
const NEAR_FACE: f64 = 1.0 / (1 << 24) as f64;

/// The faces of a surface that may be touched.
pub(crate) struct Touched<'t> {
    mesh: &'t Mesh,
    pose: &'t Pose,
    faces: &'t [u32],
    sorted: OnceCell<Sorted>,
}

/// Faces in the world, ordered by their least coordinate along one axis.
struct Sorted {
    axis: usize,
    /// Greatest extent of a face along the axis, with its tolerance.
    longest: f64,
    faces: Vec<PlacedFace>,
}

struct PlacedFace {
    face: u32,
    corners: [[f64; 3]; 3],
    /// Least and greatest corner of a box that holds all points that count as on the face.
    bounds: [[f64; 3]; 2],
    near: f64,
}

impl<'t> Touched<'t> {
    pub(crate) fn new(mesh: &'t Mesh, pose: &'t Pose, faces: &'t [u32]) -> Self {
        Self { mesh, pose, faces, sorted: OnceCell::new() }
    }

    pub(super) fn pose(&self) -> &'t Pose {
        self.pose
    }

    /// Reports whether a face that `counts` holds a point of the world and rises from it along a
    /// direction.
    ///
    /// # Complexity
    /// O(log n) for n faces, and linear time in the faces that lie beside the point along one axis.
    /// The first call sorts the faces.
    pub(super) fn rises_from(&self, point: &[f64; 3], direction: &[f64; 3], counts: impl Fn(u32) -> bool) -> bool {
        let Sorted { axis, longest, faces } = self.sorted.get_or_init(|| self.sort());
        let least = point[*axis] - longest;
        let first = faces.partition_point(|face| face.bounds[0][*axis] < least);
        let beside = faces[first..].iter().take_while(|face| face.bounds[0][*axis] <= point[*axis]);
        beside.into_iter().any(|face| face.holds(point) && face.rises_from(point, direction) && counts(face.face))
    }

    fn sort(&self) -> Sorted {
        let mut faces: Vec<PlacedFace> =
            self.faces.iter().map(|&face| PlacedFace::new(self.mesh, self.pose, face)).collect();
        let least = |k: usize| faces.iter().map(|face| face.bounds[0][k]).fold(f64::INFINITY, f64::min);
        let greatest = |k: usize| faces.iter().map(|face| face.bounds[1][k]).fold(f64::NEG_INFINITY, f64::max);
        let extent = [0, 1, 2].map(|k| greatest(k) - least(k));
        let axis = (0..3).max_by(|&i, &j| extent[i].total_cmp(&extent[j])).unwrap_or(0);
        let longest = faces.iter().map(|face| face.bounds[1][axis] - face.bounds[0][axis]).fold(0.0, f64::max);
        faces.sort_unstable_by(|x, y| x.bounds[0][axis].total_cmp(&y.bounds[0][axis]));
        Sorted { axis, longest: longest * (1.0 + f64::EPSILON), faces }
    }
}

impl PlacedFace {
    fn new(mesh: &Mesh, pose: &Pose, face: u32) -> Self {
        let corners = mesh.corners(face).map(|corner| pose.apply(corner));
        let size = (0..3).map(|k| (corners[1][k] - corners[0][k]).abs() + (corners[2][k] - corners[0][k]).abs());
        let near = size.sum::<f64>() * NEAR_FACE;
        let end = |k: usize, pick: fn(f64, f64) -> f64| pick(corners[0][k], pick(corners[1][k], corners[2][k]));
        let least = std::array::from_fn(|k| (end(k, f64::min) - near).next_down());
        let greatest = std::array::from_fn(|k| (end(k, f64::max) + near).next_up());
        Self { face, corners, bounds: [least, greatest], near }
    }

    fn holds(&self, point: &[f64; 3]) -> bool {
        let [least, greatest] = &self.bounds;
        (0..3).all(|k| least[k] <= point[k] && point[k] <= greatest[k])
            && closest_on_triangle(point, &self.corners).distance <= self.near
    }

    fn rises_from(&self, point: &[f64; 3], direction: &[f64; 3]) -> bool {
        self.corners.iter().any(|corner| dot(direction, &sub(corner, point)) > self.near)
    }
}
