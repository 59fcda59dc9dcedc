//! A mesh with positions of 16 bits in its box: a third of the bytes, and exact enough to be drawn.

use std::collections::HashMap;

use impinge::{Mesh, Positions};

use super::integers::{push_differences, push_integer, push_numbers};

/// Largest coordinate of a position.
const LAST: f64 = u16::MAX as f64;

/// Box in which positions have 16 bits for each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    low: [f64; 3],
    size: [f64; 3],
}

impl Frame {
    /// Returns the box around points, or `None` without any.
    pub(super) fn around(points: impl IntoIterator<Item = [f64; 3]>) -> Option<Self> {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for point in points {
            low = std::array::from_fn(|k| low[k].min(point[k]));
            high = std::array::from_fn(|k| high[k].max(point[k]));
        }
        (low[0] <= high[0]).then(|| Self { low, size: std::array::from_fn(|k| high[k] - low[k]) })
    }

    /// Returns a point in steps of the box, rounded to nearest.
    pub(super) fn steps(&self, point: [f64; 3]) -> [u16; 3] {
        std::array::from_fn(|k| {
            let share = if self.size[k] > 0.0 { (point[k] - self.low[k]) / self.size[k] } else { 0.0 };
            (share * LAST).round() as u16
        })
    }

    /// Returns the largest distance between a point and its rounded position.
    pub(super) fn error(&self) -> f64 {
        self.size.iter().map(|size| (0.5 * size / LAST).powi(2)).sum::<f64>().sqrt()
    }

    /// Appends the lower corner and the size.
    pub(super) fn push(&self, bytes: &mut Vec<u8>) {
        push_numbers(bytes, self.low.iter().chain(&self.size));
    }
}

/// Appends points in steps: all x, then all y, then all z.
pub(super) fn push_points(bytes: &mut Vec<u8>, points: &[[u16; 3]]) {
    (0..3).for_each(|k| push_differences(bytes, points.iter().map(|point| point[k])));
}

/// A mesh whose positions have 16 bits for each axis.
pub(super) struct QuantizedMesh {
    pub(super) frame: Frame,
    is_closed: bool,
    /// Positions, each once, in the order in which faces first use them.
    points: Vec<[u16; 3]>,
    /// Faces whose corners are still different.
    faces: Vec<[u32; 3]>,
}

impl QuantizedMesh {
    /// Rounds the positions of a mesh, and joins those that became equal. Returns `None` if no face
    /// is left.
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        Self::of_faces(mesh, mesh.faces().iter().copied())
    }

    /// Rounds the positions of some faces of a mesh as [`new`](Self::new) rounds them, so that they
    /// lie on the mesh. Returns `None` if no face is left.
    pub(super) fn of_faces(mesh: &Mesh, faces: impl Iterator<Item = [u32; 3]>) -> Option<Self> {
        let corner = |vertex: u32| match mesh.positions() {
            Positions::F32(points) => points[vertex as usize].map(f64::from),
            Positions::F64(points) => points[vertex as usize],
        };
        let frame = Frame::around(mesh.faces().iter().flatten().map(|&vertex| corner(vertex)))?;
        let mut numbers: HashMap<[u16; 3], u32> = HashMap::new();
        let (mut points, mut kept) = (Vec::new(), Vec::new());
        for face in faces {
            let steps = face.map(|vertex| frame.steps(corner(vertex)));
            if steps[0] == steps[1] || steps[1] == steps[2] || steps[2] == steps[0] {
                continue;
            }
            kept.push(steps.map(|step| {
                *numbers.entry(step).or_insert_with(|| {
                    points.push(step);
                    points.len() as u32 - 1
                })
            }));
        }
        (!kept.is_empty()).then(|| Self { frame, is_closed: mesh.is_closed(), points, faces: kept })
    }

    /// Appends the mesh: its box, whether it is closed, the numbers of positions and faces, the
    /// positions, and the corners. Each corner is its distance below the next unused position.
    pub(super) fn push(&self, bytes: &mut Vec<u8>) {
        self.frame.push(bytes);
        push_integer(bytes, self.is_closed.into());
        push_integer(bytes, self.points.len() as u64);
        push_integer(bytes, self.faces.len() as u64);
        push_points(bytes, &self.points);
        let mut unused = 0;
        for &corner in self.faces.iter().flatten() {
            push_integer(bytes, (unused - corner).into());
            unused = unused.max(corner + 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_within_the_stated_error() {
        let points = [[500_000.0, -3.0, 0.0], [500_010.0, 1.0, 0.0], [500_003.3, 0.1, 0.0], [500_009.9, -2.99, 0.0]];
        let frame = Frame::around(points).unwrap();
        assert_eq!(frame.steps(points[0]), [0, 0, 0]);
        assert_eq!(frame.steps(points[1]), [65535, 65535, 0]);
        for point in points {
            let steps = frame.steps(point);
            let back: [f64; 3] = std::array::from_fn(|k| frame.low[k] + frame.size[k] * f64::from(steps[k]) / LAST);
            let error = (0..3).map(|k| (back[k] - point[k]).powi(2)).sum::<f64>().sqrt();
            assert!(error <= frame.error() * (1.0 + 1e-6), "{error}");
        }
        assert_eq!(Frame::around([]), None);
    }

    #[test]
    fn equal_positions_are_joined_and_flat_faces_are_left_out() {
        // Vertex 3 is unused, vertices 0 and 4 are equal, and face 1 is smaller than a step.
        let points = vec![[0.0; 3], [9.0, 0.0, 0.0], [0.0, 9.0, 9.0], [99.0; 3], [0.0; 3], [1e-9, 0.0, 0.0]];
        let mesh = Mesh::new(Positions::F64(points), vec![[0, 1, 2], [0, 5, 1], [2, 1, 4]]).unwrap();
        let quantized = QuantizedMesh::new(&mesh).unwrap();
        assert_eq!(quantized.points, [[0; 3], [65535, 0, 0], [0, 65535, 65535]]);
        assert_eq!(quantized.faces, [[0, 1, 2], [2, 1, 0]]);
        let mut bytes = Vec::new();
        quantized.push(&mut bytes);
        assert_eq!(bytes[48..51], [0, 3, 2]);
        // Three new positions, then the distances of 2, 1 and 0 below 3.
        assert_eq!(bytes[bytes.len() - 6..], [0, 0, 0, 1, 2, 3]);
    }

    #[test]
    fn an_empty_mesh_is_not_drawn() {
        assert!(QuantizedMesh::new(&Mesh::new(Positions::F64(Vec::new()), Vec::new()).unwrap()).is_none());
    }
}
