//! Whether the solid of a mesh is on either side of its faces.

use rayon::prelude::*;

use super::sheets::turn_along_some_axis;
use super::winding::Judge;
use crate::exact::{AxisRay, Corners, PosedPoint, Spot};
use crate::math::Sign;
use crate::mesh::Mesh;
use crate::mesh::pairs::self_descent::{WantedFaces, collect_self_intersecting};

/// Whether the solid of a mesh is on either side of one of its faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wall {
    /// The same all over the face. The front is where its corners are counterclockwise in the frame of the mesh.
    Sides { front: bool, back: bool },
    /// The face is near the border of an open mesh, or another face that counts meets it elsewhere
    /// than in common corners and edges.
    Unknown,
}

/// The walls of some faces of a mesh.
pub(crate) struct Walls {
    faces: Vec<u32>,
    walls: Vec<Wall>,
}

impl Walls {
    /// Returns the walls of faces that count, which are sorted, without duplicates. Each wall
    /// depends on the mesh and the face alone, not on which other faces are asked about.
    ///
    /// # Complexity
    /// For each of them that of [`Mesh::contains`] for one point.
    pub(crate) fn of(mesh: &Mesh, faces: Vec<u32>) -> Self {
        if faces.is_empty() {
            return Self { faces, walls: Vec::new() };
        }
        let mut marks = vec![false; mesh.faces().len()];
        faces.iter().for_each(|&face| marks[face as usize] = true);
        let mut meets_others = vec![false; mesh.faces().len()];
        for pair in collect_self_intersecting(mesh, WantedFaces::WithMarked(&marks)) {
            if pair.into_iter().all(|face| mesh.counts(face)) {
                pair.into_iter().for_each(|face| meets_others[face as usize] = true);
            }
        }
        let cap = mesh.cap();
        let wall = |judge: &mut Judge<'_>, face: u32| {
            if meets_others[face as usize] || !cap.is_far_from(&mesh.corners(face)) {
                Wall::Unknown
            } else {
                judge.wall_amid(face)
            }
        };
        let walls = faces.par_iter().map_init(|| Judge::new(mesh), |judge, &face| wall(judge, face)).collect();
        Self { faces, walls }
    }

    /// Returns the wall of a face; unknown if it was not asked for.
    pub(crate) fn get(&self, face: u32) -> Wall {
        self.faces.binary_search(&face).map_or(Wall::Unknown, |at| self.walls[at])
    }
}

impl Judge<'_> {
    /// Returns the wall of a face at one of its inner points, for a face that is far from the
    /// border.
    fn wall_amid(&mut self, face: u32) -> Wall {
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
    /// [`Spot::Within`] of a face of an open mesh, given two numbers of the same difference. Far
    /// from the border the winding numbers are within 1/8 of them.
    fn nearest_integers(&mut self, corners: &Corners, [above, below]: [i64; 2]) -> Option<[i64; 2]> {
        /// The sum of that eighth and of what the proved interval may add, with room for more.
        const FAR_FROM_HALF: f64 = 0.375;
        let through = below - above;
        let amid = self.winding_number(&PosedPoint::local(Spot::Within(*corners)));
        // On the face itself it is the mean of both sides.
        let half = 0.5 * through as f64;
        let nearest = (amid.value - half).round();
        let is_certain =
            (amid.lower - half - nearest).abs() < FAR_FROM_HALF && (amid.upper - half - nearest).abs() < FAR_FROM_HALF;
        is_certain.then(|| [nearest as i64, nearest as i64 + through])
    }
}

impl Mesh {
    /// Reports whether the solid is as near as is wanted to the point of [`Spot::Within`] of the corners of a face,
    /// given in any order; for an open mesh, whether its winding number differs between both sides
    /// there. False if the face has no area.
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

/// The winding numbers above and below an inner point of a face along an axis, at two points off the surface that are as
/// near to it as is wanted. They are those of a closed mesh; for an open one their difference alone is meant.
fn windings(mesh: &Mesh, corners: &Corners, axis: usize, stack: &mut Vec<u32>) -> [i64; 2] {
    let point = PosedPoint::local(Spot::Within(*corners));
    let ray = AxisRay { axis, ascending: true };
    let crossings = mesh.crossings(&point, ray, stack);
    // The point may be on an edge of another face. Both points are beside it, on the line that the ray is in.
    let turns = |&holding: &u32| i64::from(point.turns_about(ray, &mesh.corners(holding)));
    let through: i64 = crossings.holding.iter().map(turns).sum();
    [crossings.count, crossings.count + through]
}
