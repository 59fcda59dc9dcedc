//! One of the two things of a batch, at its poses.

use rayon::prelude::*;

use super::poses::Poses;
use crate::input::InputError;
use crate::mesh::PlacedMesh;
use crate::query::Placed;
use crate::shape::{PlacedShape, Shape};

/// A thing and its poses.
#[derive(Clone, Debug)]
pub(super) struct Side {
    shape: Shape,
    poses: Poses,
    /// The shape at each pose, if several rows share one pose. Absent for a mesh, which is placed
    /// at no cost.
    placed: Option<Vec<Result<PlacedShape, InputError>>>,
}

impl Side {
    /// Checks the poses against the shape: round shapes need rigid poses.
    pub(super) fn new(shape: Shape, mut poses: Poses) -> Self {
        if !shape.is_affine() {
            poses.reject_if(|pose| shape.check_pose(pose));
        }
        Self { shape, poses, placed: None }
    }

    /// Places the shape at each pose once, if there are more rows than poses.
    pub(super) fn shared_by(self, rows: usize) -> Self {
        if rows <= self.poses.len() || self.shape.as_mesh().is_some() {
            return self;
        }
        let place = |row: usize| self.shape.at(*self.poses.get(row).map_err(Clone::clone)?);
        let placed = (0..self.poses.len()).into_par_iter().map(place).collect();
        Self { placed: Some(placed), ..self }
    }

    pub(super) fn poses(&self) -> &Poses {
        &self.poses
    }

    /// Reports whether queries with two things of this kind are never undecided.
    pub(super) fn is_exact(&self) -> bool {
        self.shape.is_affine() && !self.shape.as_mesh().is_some_and(|(_, is_solid)| is_solid)
    }

    /// Returns the thing at the pose of a row.
    ///
    /// # Errors
    /// The error of the pose, if it is invalid.
    pub(super) fn at(&self, row: usize) -> Result<Placed<'_>, InputError> {
        if let Some(placed) = &self.placed {
            return placed[row].as_ref().map(Into::into).map_err(Clone::clone);
        }
        let world_from_mesh = *self.poses.get(row).map_err(Clone::clone)?;
        match self.shape.as_mesh() {
            Some((mesh, is_solid)) => Ok(PlacedMesh { mesh, world_from_mesh, is_solid }.into()),
            None => Ok(self.shape.at(world_from_mesh)?.into()),
        }
    }
}
