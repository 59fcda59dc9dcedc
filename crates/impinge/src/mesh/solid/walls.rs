//! The sides of a face on which the solid of a mesh is (docs/notes/proof.md, L19 and L19a).
//!
//! Guarded by `tests/it/solids/bricks.rs` and `open.rs`.

use rayon::prelude::*;

use super::crossings::PackedPoint;
use super::sheets::turn_along_some_axis;
use super::winding::PointClassifier;
use crate::budget::Budget;
use crate::exact::{AxisRay, Corners, PosedPoint, Spot};
use crate::math::Sign;
use crate::mesh::Mesh;
use crate::mesh::pairs::self_descent::{WantedFaces, collect_self_intersecting};

/// The sides of one face on which the solid of its mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wall {
    /// Both sides are known and the same all over the face. The front is the side from which the
    /// corners are counterclockwise in the frame of the mesh.
    Sides { front: bool, back: bool },
    /// The face is near the border of an open mesh, or another face that counts intersects it
    /// outside common corners and edges.
    Unknown,
}

/// The walls of some faces of a mesh.
pub(crate) struct Walls {
    faces: Vec<u32>,
    walls: Vec<Wall>,
}

impl Walls {
    /// Returns the walls of faces that count, which must be sorted and without duplicates. Each
    /// wall depends on the mesh and the face alone, not on the other faces in the list. Once the
    /// budget is spent, the walls of the faces that are left are unknown.
    ///
    /// # Complexity
    /// For each face, the cost of [`Mesh::contains`] for one point.
    pub(crate) fn of(mesh: &Mesh, faces: Vec<u32>, budget: &Budget<'_>) -> Self {
        if faces.is_empty() {
            return Self { faces, walls: Vec::new() };
        }
        let mut marks = vec![false; mesh.faces().len()];
        faces.iter().for_each(|&face| marks[face as usize] = true);
        let mut intersects_others = vec![false; mesh.faces().len()];
        for pair in collect_self_intersecting(mesh, WantedFaces::WithMarked(&marks), budget) {
            if pair.into_iter().all(|face| mesh.counts(face)) {
                pair.into_iter().for_each(|face| intersects_others[face as usize] = true);
            }
        }
        let cap = mesh.cap();
        let wall = |classifier: &mut PointClassifier<'_>, face: u32| {
            if budget.is_spent() || intersects_others[face as usize] || !cap.is_far_from(&mesh.corners(face)) {
                Wall::Unknown
            } else {
                classifier.wall_at_inner_point(face)
            }
        };
        let walls = faces
            .par_iter()
            .map_init(|| PointClassifier::new(mesh), |classifier, &face| wall(classifier, face))
            .collect();
        Self { faces, walls }
    }

    /// Returns the wall of a face, or [`Wall::Unknown`] if the face was not in the list.
    pub(crate) fn get(&self, face: u32) -> Wall {
        self.faces.binary_search(&face).map_or(Wall::Unknown, |at| self.walls[at])
    }
}

impl PointClassifier<'_> {
    /// Returns the wall of a face at one of its inner points. The face must be far from the border.
    fn wall_at_inner_point(&mut self, face: u32) -> Wall {
        let corners = self.mesh.corners(face);
        let Some((axis, turn)) = turn_along_some_axis(&corners) else { return Wall::Unknown };
        let sides = windings(self.mesh, &corners, axis, &mut self.stack);
        let Some([above, below]) =
            (if self.mesh.is_closed() { Some(sides) } else { self.nearest_integers(&corners, sides) })
        else {
            return Wall::Unknown;
        };
        let [above, below] = [above != 0, below != 0];
        if turn == Sign::Positive {
            Wall::Sides { front: above, back: below }
        } else {
            Wall::Sides { front: below, back: above }
        }
    }

    /// Returns the integers nearest to the winding numbers above and below the point of
    /// [`Spot::Within`] of a face of an open mesh. The given numbers have the same difference. Far
    /// from the border the winding numbers are within 1/8 of the integers. Returns `None` if the
    /// proved interval leaves a doubt.
    fn nearest_integers(&mut self, corners: &Corners, [above, below]: [i64; 2]) -> Option<[i64; 2]> {
        /// Maximum distance of the proved interval from the integer: 1/8 plus the width of the
        /// interval, with room for more.
        const FAR_FROM_HALF: f64 = 0.375;
        let through = below - above;
        let on_face = self.winding_number(&PosedPoint::local(Spot::Within(*corners)));
        // On the face itself the winding number is the mean of both sides.
        let half = 0.5 * through as f64;
        let nearest = (on_face.value - half).round();
        let is_certain = (on_face.lower - half - nearest).abs() < FAR_FROM_HALF
            && (on_face.upper - half - nearest).abs() < FAR_FROM_HALF;
        is_certain.then(|| [nearest as i64, nearest as i64 + through])
    }
}

impl Mesh {
    /// Reports whether points of the solid are arbitrarily near to the point of [`Spot::Within`] of
    /// the corners of a face, given in any order. For an open mesh, reports whether the winding
    /// numbers on both sides of the face differ there. Returns `false` if the face has no area.
    pub(crate) fn is_solid_beside(&self, corners: &Corners, stack: &mut Vec<u32>) -> bool {
        match turn_along_some_axis(corners) {
            None => false,
            Some((axis, _)) => {
                let [above, below] = windings(self, corners, axis, stack);
                if self.is_closed() { above != 0 || below != 0 } else { above != below }
            }
        }
    }
}

/// Returns the winding numbers above and below an inner point of a face along an axis, at two
/// points off the surface that are arbitrarily near to it. They are exact for a closed mesh. For an
/// open mesh only their difference has a meaning.
fn windings(mesh: &Mesh, corners: &Corners, axis: usize, stack: &mut Vec<u32>) -> [i64; 2] {
    let point = PosedPoint::local(Spot::Within(*corners));
    let ray = AxisRay { axis, ascending: true };
    let crossings = mesh.crossings(&point, &PackedPoint::new(mesh, &point), ray, stack);
    // The point may be on an edge of another face. Both points are beside that edge, on the line of
    // the ray.
    let turns = |&holding: &u32| i64::from(point.turns_about(ray, &mesh.corners(holding)));
    let through: i64 = crossings.holding.iter().map(turns).sum();
    [crossings.count, crossings.count + through]
}
