//! What is on either side of a face: inside the solid, or not.

use rayon::prelude::*;

use super::Mesh;
use super::self_descent::{WantedFaces, collect_self_intersecting};
use crate::exact::{AxisRay, PosedPoint, Spot};
use crate::math::Sign;

/// Whether the solid of a mesh is on either side of one of its faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wall {
    /// The same all over the face. The front is where its corners are counterclockwise in the frame of the mesh.
    Sides { front: bool, back: bool },
    /// The mesh is open, or another of its faces meets this one elsewhere than in its corners and edges.
    Unknown,
}

/// The walls of some faces of a mesh.
pub(crate) struct Walls {
    faces: Vec<u32>,
    walls: Vec<Wall>,
}

impl Walls {
    /// The walls of these faces, which are sorted, without duplicates.
    ///
    /// # Complexity
    /// For each of them that of [`Mesh::contains`] for one point.
    pub(crate) fn of(mesh: &Mesh, faces: Vec<u32>) -> Self {
        if faces.is_empty() || !mesh.is_closed() {
            return Self { walls: vec![Wall::Unknown; faces.len()], faces };
        }
        let mut marks = vec![false; mesh.faces().len()];
        faces.iter().for_each(|&face| marks[face as usize] = true);
        let mut meets_others = vec![false; mesh.faces().len()];
        for pair in collect_self_intersecting(mesh, WantedFaces::WithMarked(&marks)) {
            pair.into_iter().for_each(|face| meets_others[face as usize] = true);
        }
        let walls =
            faces
                .par_iter()
                .map_init(Vec::new, |stack, &face| {
                    if meets_others[face as usize] { Wall::Unknown } else { amid_face(mesh, face, stack) }
                })
                .collect();
        Self { faces, walls }
    }

    /// The wall of a face; unknown for one that was not asked for.
    pub(crate) fn get(&self, face: u32) -> Wall {
        self.faces.binary_search(&face).map_or(Wall::Unknown, |at| self.walls[at])
    }

    pub(crate) fn faces(&self) -> &[u32] {
        &self.faces
    }
}

impl Mesh {
    /// The name of an edge: the first vertices at the positions of its ends, the lesser first.
    pub(crate) fn edge_name(&self, face: u32, corners: [usize; 2]) -> [u32; 2] {
        let first_at = &self.topology().first_at;
        let [p, q] = corners.map(|corner| first_at[self.faces()[face as usize][corner] as usize]);
        [p.min(q), p.max(q)]
    }

    /// Whether some faces hold together at an edge of this name: as many run one way as the other.
    pub(crate) fn is_balanced_at(&self, edge: [u32; 2], faces: &[u32]) -> bool {
        let first_at = &self.topology().first_at;
        let runs = faces.iter().flat_map(|&face| {
            let [a, b, c] = self.faces()[face as usize].map(|vertex| first_at[vertex as usize]);
            [[a, b], [b, c], [c, a]]
        });
        let net: i64 = runs.map(|[from, to]| i64::from([from, to] == edge) - i64::from([to, from] == edge)).sum();
        net == 0
    }

    /// Whether the solid is beside a face at the point of [`Spot::Within`]; for an open mesh, whether its winding number
    /// differs between both sides there. False where the face has no area.
    pub(crate) fn is_solid_beside(&self, face: u32, stack: &mut Vec<u32>) -> bool {
        match turn_along_some_axis(self, face) {
            None => false,
            Some((axis, _)) => {
                let [above, below] = windings(self, face, axis, stack);
                if self.is_closed() { above != 0 || below != 0 } else { above != below }
            }
        }
    }
}

/// What is on both sides of a face at one of its inner points.
fn amid_face(mesh: &Mesh, face: u32, stack: &mut Vec<u32>) -> Wall {
    let Some((axis, turn)) = turn_along_some_axis(mesh, face) else { return Wall::Unknown };
    let [above, below] = windings(mesh, face, axis, stack).map(|winding| winding != 0);
    if turn == Sign::Positive {
        Wall::Sides { front: above, back: below }
    } else {
        Wall::Sides { front: below, back: above }
    }
}

/// How the corners of a face turn, looking against the axis along which the face is seen largest, or against another one
/// where that is not seen at all; none where the face has no area.
fn turn_along_some_axis(mesh: &Mesh, face: u32) -> Option<(usize, Sign)> {
    let corners = mesh.corners(face);
    let edge = |to: usize| -> [f64; 3] { std::array::from_fn(|k| corners[to][k] - corners[0][k]) };
    let (u, v) = (edge(1), edge(2));
    let seen = |k: usize| (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]).abs();
    let mut axes = [0, 1, 2];
    axes.sort_by(|&x, &y| seen(y).total_cmp(&seen(x)));
    axes.into_iter().find_map(|axis| match turn(mesh, face, axis) {
        Sign::Zero => None,
        turn => Some((axis, turn)),
    })
}

fn turn(mesh: &Mesh, face: u32, axis: usize) -> Sign {
    let [a, b, c] = mesh.corners(face);
    PosedPoint::local(Spot::At(c)).beside(axis, &a, &b)
}

/// The winding numbers just above and just below an inner point of a face along an axis, those of a closed mesh; for an
/// open one their difference alone is meant.
fn windings(mesh: &Mesh, face: u32, axis: usize, stack: &mut Vec<u32>) -> [i64; 2] {
    let point = PosedPoint::local(Spot::Within(mesh.corners(face)));
    let crossings = mesh.crossings(&point, AxisRay { axis, ascending: true }, stack);
    let through: i64 = crossings
        .holding
        .iter()
        .map(|&holding| match turn(mesh, holding, axis) {
            Sign::Positive => 1,
            Sign::Negative => -1,
            Sign::Zero => 0,
        })
        .sum();
    [crossings.count, crossings.count + through]
}
