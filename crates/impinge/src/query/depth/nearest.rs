//! The face of a placed mesh that is nearest to a point of the world.
//!
//! Guarded by `tests/it/clash/reports.rs`.

use std::ops::ControlFlow::{self, Continue};

use super::face::{gap, world_box, world_corners};
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
