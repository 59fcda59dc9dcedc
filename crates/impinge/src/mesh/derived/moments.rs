//! The moments of the faces below each node of a tree, about a center of each node, for winding
//! numbers seen from afar (docs/notes/proof.md, L17).
//!
//! Source: Barill, Dickson, Schmidt, Levin and Jacobson, *Fast Winding Numbers for Soups and
//! Clouds*, ACM Transactions on Graphics 37(4), 2018.
//!
//! Guarded by `tests/it/solids/winding.rs`.

use crate::exact::Corners;
use crate::hierarchy::{Child, Node, WideTree};
use crate::math::vec3::{cross, length, scale, sub};
use crate::mesh::storage::frame::{PACKING_ERROR, PackedFrame};
use crate::mesh::storage::leaf::Leaf;

/// The moments of the faces below one node, in the packed frame. `y` is a point of a face relative
/// to the center.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Group {
    pub(in crate::mesh) center: [f64; 3],
    /// Upper bound of the distance of any point of the faces from the center.
    pub(in crate::mesh) radius: f64,
    /// Upper bound of the sum of the areas of the faces.
    pub(in crate::mesh) area: f64,
    /// Sum over the faces of the product of the lengths of two edges. The rounding error of area
    /// vectors is relative to it.
    pub(in crate::mesh) size: f64,
    /// Sum of the area vectors.
    pub(in crate::mesh) zeroth: [f64; 3],
    /// `first[i][j]`: sum over the faces of component i of the area vector times the mean of y_j
    /// over the face.
    pub(in crate::mesh) first: [[f64; 3]; 3],
    /// `second[i]`: sum over the faces of component i of the area vector times the mean of y_j y_k
    /// over the face, for jk = 00, 11, 22, 12, 20, 01.
    pub(in crate::mesh) second: [[f64; 6]; 3],
}

/// The moments of the faces below each node of a tree, by the index of the node.
#[derive(Debug)]
pub(crate) struct FarField {
    pub(in crate::mesh) groups: Vec<Group>,
}

/// Returns the index of a symmetric pair in the rows of [`Group::second`].
pub(in crate::mesh) fn pair(j: usize, k: usize) -> usize {
    if j == k { j } else { 6 - j - k }
}

impl FarField {
    /// Computes the moments of the faces below each node of a tree. `corners` returns the corners
    /// of a face in the mesh frame.
    ///
    /// # Complexity
    /// O(n).
    pub(in crate::mesh) fn of(
        tree: &WideTree,
        leaves: &[Leaf],
        frame: &PackedFrame,
        corners: impl Fn(u32) -> Corners,
    ) -> Self {
        let nodes = tree.nodes();
        let mut groups = vec![Group::EMPTY; nodes.len()];
        // Children come after their parents.
        for index in (0..nodes.len()).rev() {
            let mut group = Group::about_box_of(&nodes[index]);
            for lane in 0..nodes[index].count() {
                match nodes[index].child(lane) {
                    Child::Inner(child) => group.add_group(&groups[child as usize]),
                    Child::Leaf(leaf) => {
                        for &face in leaves[leaf as usize].held() {
                            group.add_face(frame, &corners(face));
                        }
                    }
                }
            }
            groups[index] = group;
        }
        Self { groups }
    }
}

impl Group {
    const EMPTY: Self = Self {
        center: [0.0; 3],
        radius: 0.0,
        area: 0.0,
        size: 0.0,
        zeroth: [0.0; 3],
        first: [[0.0; 3]; 3],
        second: [[0.0; 6]; 3],
    };

    /// Returns a group without faces, about the middle of the boxes of a node's children.
    fn about_box_of(node: &Node) -> Self {
        let (mut center, mut squared) = ([0.0; 3], 0.0);
        for axis in 0..3 {
            let lanes = 0..node.count();
            let low = lanes.clone().fold(f64::INFINITY, |low, lane| low.min(f64::from(node.min[axis][lane])));
            let high = lanes.fold(f64::NEG_INFINITY, |high, lane| high.max(f64::from(node.max[axis][lane])));
            center[axis] = 0.5 * (low + high);
            squared += (0.5 * (high - low)).powi(2);
        }
        // The factor covers the rounding of the root, and the added term covers the errors of the
        // corners.
        let radius = squared.sqrt() * (1.0 + 1e-12) + 4.0 * PACKING_ERROR;
        Self { center, radius, ..Self::EMPTY }
    }

    fn add_face(&mut self, frame: &PackedFrame, corners: &Corners) {
        // Edges are computed from the stored corners, so that the edges of a face as small as the
        // packing error have a direction.
        let edge = |to: usize| -> [f64; 3] { std::array::from_fn(|k| (corners[to][k] - corners[0][k]) * frame.scale) };
        let (u, v) = (edge(1), edge(2));
        let normal = scale(&cross(&u, &v), 0.5);
        let size = length(&u) * length(&v);
        self.size += size;
        self.area += length(&normal) + 8.0 * f64::EPSILON * size;
        let [a, b, c] = corners.map(|corner| sub(&frame.pack(corner), &self.center));
        // Means over the triangle of y and of y yᵀ, from its corners and their sum.
        let sum: [f64; 3] = std::array::from_fn(|k| a[k] + b[k] + c[k]);
        for j in 0..3 {
            for i in 0..3 {
                self.first[i][j] += normal[i] * (sum[j] / 3.0);
            }
            for k in j..3 {
                let mean = (sum[j] * sum[k] + a[j] * a[k] + b[j] * b[k] + c[j] * c[k]) / 12.0;
                for i in 0..3 {
                    self.second[i][pair(j, k)] += normal[i] * mean;
                }
            }
        }
        for i in 0..3 {
            self.zeroth[i] += normal[i];
        }
    }

    /// Moves the other group's moments to this center and adds them.
    fn add_group(&mut self, other: &Self) {
        let d: [f64; 3] = std::array::from_fn(|k| other.center[k] - self.center[k]);
        for i in 0..3 {
            let (zeroth, first) = (other.zeroth[i], &other.first[i]);
            for j in 0..3 {
                for k in j..3 {
                    self.second[i][pair(j, k)] +=
                        other.second[i][pair(j, k)] + first[j] * d[k] + first[k] * d[j] + zeroth * d[j] * d[k];
                }
                self.first[i][j] += first[j] + zeroth * d[j];
            }
            self.zeroth[i] += zeroth;
        }
        self.area += other.area;
        self.size += other.size;
    }
}
