//! The two kinds of surfaces that shapes are made of: meshes and height fields.

use super::Mesh;
use super::height_field::HeightField;
use super::points::face_search::FaceSearch;
use super::solid::winding::{Containment, PointClassifier};
use crate::exact::PosedPoint;
use crate::hierarchy::Child;
use crate::math::relative::UNIT_ROUNDOFF;

/// Triangles with a tree of boxes over them.
pub(crate) trait Faces {
    /// Returns the least and the greatest corner of a box that holds all faces, or `None` if there
    /// is no face.
    fn local_bounds(&self) -> Option<[[f64; 3]; 2]>;

    /// Returns the corners of a face.
    fn corners(&self, face: u32) -> [[f64; 3]; 3];

    /// Returns the numbers of the corners of a face. Of several vertices at one position it names
    /// the first.
    fn places(&self, face: u32) -> [u32; 3];

    /// Returns the position of a vertex.
    fn position(&self, vertex: u32) -> [f64; 3];

    /// Returns the children of a node, each with the center and the half-extents of a box that
    /// holds it. Node 0 is the root.
    fn children(&self, node: u32) -> Vec<(Child, [[f64; 3]; 2])>;

    /// Returns the faces of a leaf.
    fn faces_of(&self, leaf: u32) -> Vec<u32>;

    /// Runs a search: visits the faces of near boxes.
    fn search(&self, search: &mut impl FaceSearch);

    /// Returns the position of a point relative to the inside of the faces.
    fn containment(&self, point: &PosedPoint<'_>) -> Containment;
}

impl Faces for Mesh {
    fn local_bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.local_bounds()
    }

    fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.corners(face)
    }

    fn places(&self, face: u32) -> [u32; 3] {
        let first_at = &self.topology().first_at;
        self.faces()[face as usize].map(|vertex| first_at[vertex as usize])
    }

    fn position(&self, vertex: u32) -> [f64; 3] {
        self.positions().get(vertex as usize)
    }

    fn children(&self, node: u32) -> Vec<(Child, [[f64; 3]; 2])> {
        self.children(node).collect()
    }

    fn faces_of(&self, leaf: u32) -> Vec<u32> {
        self.leaf(leaf).held().to_vec()
    }

    fn search(&self, search: &mut impl FaceSearch) {
        self.search(search);
    }

    fn containment(&self, point: &PosedPoint<'_>) -> Containment {
        PointClassifier::new(self).containment(point)
    }
}

impl Faces for HeightField {
    fn local_bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.local_bounds()
    }

    fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.corners(face)
    }

    fn places(&self, face: u32) -> [u32; 3] {
        self.vertices(face)
    }

    fn position(&self, vertex: u32) -> [f64; 3] {
        self.position(vertex)
    }

    fn children(&self, node: u32) -> Vec<(Child, [[f64; 3]; 2])> {
        self.boxes(node).into_iter().map(|(child, bounds)| (child, center_and_half(bounds))).collect()
    }

    fn faces_of(&self, leaf: u32) -> Vec<u32> {
        vec![2 * leaf, 2 * leaf + 1]
    }

    fn search(&self, search: &mut impl FaceSearch) {
        if self.local_bounds().is_none() {
            return;
        }
        let mut tasks = vec![(f64::NEG_INFINITY, Child::Inner(0))];
        while let Some((bound, child)) = tasks.pop() {
            if bound > search.cut() {
                continue;
            }
            match child {
                Child::Inner(block) => {
                    let start = tasks.len();
                    for (child, [center, half_extents]) in Faces::children(self, block) {
                        let bound = search.bound(&center, &half_extents);
                        if bound > search.cut() {
                            continue;
                        }
                        tasks.push((bound, child));
                    }
                    // The nearest last.
                    tasks[start..].sort_by(|x, y| y.0.total_cmp(&x.0));
                }
                Child::Leaf(cell) => {
                    for face in Faces::faces_of(self, cell) {
                        if search.visit(face).is_break() {
                            return;
                        }
                    }
                }
            }
        }
    }

    fn containment(&self, _: &PosedPoint<'_>) -> Containment {
        Containment::Outside
    }
}

/// Returns the center and the half-extents of a box that holds a box, enlarged by the rounding.
fn center_and_half([min, max]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let center: [f64; 3] = std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]);
    let slack = |k: usize| 4.0 * UNIT_ROUNDOFF * (min[k].abs() + max[k].abs()) + f64::MIN_POSITIVE;
    [center, std::array::from_fn(|k| 0.5 * max[k] - 0.5 * min[k] + slack(k))]
}
