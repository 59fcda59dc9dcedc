//! The face of a placed mesh that is nearest to a point, through the tree of the mesh.
//!
//! Guarded by `tests/it/clash/reports.rs` and `tests/it/clash/large.rs`.

use std::ops::ControlFlow::{self, Continue};

use super::face::{Face, gap, world_box, world_corners};
use crate::math::vec3::Vector;
use crate::mesh::{FaceSearch, PlacedMesh};
use crate::primitive::PreparedTriangle;

/// The nearest face to a point, in the world frame. Numbers are rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NearestFace {
    /// Index of the face. Of several that are equally near it is the first.
    pub(crate) face: u32,
    /// Nearest point of the face.
    pub(crate) foot: Vector,
    /// Distance of the point from the face.
    pub(crate) distance: f64,
}

/// Returns the face of a mesh that is nearest to a point, or `None` without faces.
pub(crate) fn nearest_face(placed: &PlacedMesh<'_>, point: &Vector) -> Option<NearestFace> {
    let mut search = Search { placed, point, best: None };
    placed.mesh.search(&mut search);
    search.best
}

struct Search<'s, 'm> {
    placed: &'s PlacedMesh<'m>,
    point: &'s Vector,
    best: Option<NearestFace>,
}

impl FaceSearch for Search<'_, '_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        gap(&world_box(&self.placed.world_from_mesh, self.point, center, half_extents), &[[0.0; 3]; 2])
    }

    fn cut(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |best| best.distance)
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let corners = world_corners(self.placed, face, &[0.0; 3]);
        let (squared, foot) = PreparedTriangle::new(&corners).nearest(self.point, &corners);
        let found = NearestFace { face, foot, distance: squared.sqrt() };
        let is_nearer =
            |best: NearestFace| (found.distance, face) < (best.distance, best.face) || best.distance.is_nan();
        if self.best.is_none_or(is_nearer) {
            self.best = Some(found);
        }
        Continue(())
    }
}

/// Number in place of that of a face that a search did not collect.
pub(super) const NOT_NEAR: u32 = u32::MAX;

/// A search for the nearest to a point among the faces that the search for a depth collected.
pub(super) struct Nearest<'s, 'm> {
    placed: &'s PlacedMesh<'m>,
    origin: &'s Vector,
    faces: &'s [Face],
    place_of: &'s [u32],
    point: &'s Vector,
    best: Option<(f64, Vector, u32)>,
}

impl<'s, 'm> Nearest<'s, 'm> {
    /// Prepares a search in the frame with an origin in the world. `place_of` has the place of each
    /// face of the mesh among the collected ones, or [`NOT_NEAR`].
    pub(super) fn new(
        (placed, origin): (&'s PlacedMesh<'m>, &'s Vector),
        (faces, place_of): (&'s [Face], &'s [u32]),
        point: &'s Vector,
    ) -> Self {
        Self { placed, origin, faces, place_of, point, best: None }
    }

    /// Returns the squared distance of the point from the nearest face, the nearest point of the
    /// face, and the place of the face: the first of several that are equally near.
    pub(super) fn find(mut self) -> Option<(f64, Vector, u32)> {
        self.placed.mesh.search(&mut self);
        self.best
    }
}

impl FaceSearch for Nearest<'_, '_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        let [low, high] = world_box(&self.placed.world_from_mesh, self.origin, center, half_extents);
        let apart = |axis: usize| (low[axis] - self.point[axis]).max(self.point[axis] - high[axis]).max(0.0);
        (0..3).map(|axis| apart(axis).powi(2)).sum::<f64>().sqrt()
    }

    fn cut(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |(squared, ..)| squared.sqrt())
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let place = self.place_of[face as usize];
        if place != NOT_NEAR {
            // A face that is equally near counts.
            let most = self.best.map_or(f64::INFINITY, |(squared, ..)| squared.next_up());
            if let Some((squared, foot)) = self.faces[place as usize].nearest_within(self.point, most)
                && self.best.is_none_or(|(least, _, first)| (squared, place) < (least, first))
            {
                self.best = Some((squared, foot, place));
            }
        }
        Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Budget;
    use crate::math::Pose;
    use crate::mesh::{Mesh, Positions};
    use crate::query::depth::side::Side;

    /// Returns the six sides of a cube of side n, each in squares of two triangles. Vertices are on
    /// the lattice, and those on edges repeat.
    fn cube(n: usize) -> Mesh {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for side in 0..6 {
            let (axis, is_high) = (side / 2, side % 2 == 1);
            let first = vertices.len() as u32;
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let mut vertex = [0.0; 3];
                vertex[axis] = if is_high { n as f64 } else { 0.0 };
                (vertex[(axis + 1) % 3], vertex[(axis + 2) % 3]) = (i as f64, j as f64);
                vertices.push(vertex);
            }
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let at = |i: usize, j: usize| first + (i * (n + 1) + j) as u32;
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                faces.extend(if is_high { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
        Mesh::new(Positions::F64(vertices), faces).expect("a mesh")
    }

    #[test]
    fn the_tree_finds_the_face_that_a_scan_finds_on_a_lattice() {
        let mesh = cube(10);
        assert!(mesh.is_closed());
        let pose = Pose::from_translation([0.5, -2.0, 4.0]).expect("a pose");
        let origin = [5.0, 3.0, 9.0];
        let bounds = [[-4.0; 3], [4.0; 3]];
        let mut compared = 0;
        for margin in [0.5, 3.0, 100.0] {
            let side = Side::new(mesh.at(pose), origin, &bounds, (margin, 1e-12), Budget::unlimited()).expect("a side");
            if side.faces.len() <= 512 {
                continue;
            }
            let all: Vec<u32> = (0..side.faces.len() as u32).collect();
            let halves = || (-8..=8).map(|step| 0.5 * f64::from(step));
            for point in halves().flat_map(|x| halves().flat_map(move |y| halves().map(move |z| [x, y, z]))) {
                let scanned = all.iter().fold(None, |best: Option<(f64, Vector, u32)>, &face| {
                    let most = best.map_or(f64::INFINITY, |(squared, ..)| squared);
                    let found = side.faces[face as usize].nearest_within(&point, most);
                    found.filter(|(squared, _)| *squared < most).map(|(squared, foot)| (squared, foot, face)).or(best)
                });
                assert_eq!(side.nearest(&point, &all), scanned, "{point:?}");
                compared += 1;
            }
        }
        assert!(compared > 4000, "{compared}");
    }
}
