//! One of the two things of a batch, at its poses.

use rayon::prelude::*;

use super::poses::Poses;
use crate::input::InputError;
use crate::mesh::PlacedMesh;
use crate::query::Placed;
use crate::shape::{Acceptance, PlacedShape, Shape};

/// Maximum number of parts, over all poses, that are placed before the rows are answered. Each
/// takes about 300 bytes. If there are more, the thing is placed for each row.
const MAX_SHARED_PARTS: usize = 1 << 18;

/// A thing and its poses.
#[derive(Clone, Debug)]
pub(super) struct Side {
    shape: Shape,
    poses: Poses,
    /// The shape at each pose, if several rows share one pose and there are few parts. Absent for a
    /// mesh, which is placed at no cost.
    placed: Option<Vec<Result<PlacedShape, InputError>>>,
}

impl Side {
    /// Checks the poses against the shape: round shapes need rigid poses.
    pub(super) fn new(shape: Shape, mut poses: Poses) -> Self {
        if !shape.is_affine() {
            let acceptance = Acceptance::of(&shape);
            poses.reject_if(|pose| acceptance.check(pose));
        }
        Self { shape, poses, placed: None }
    }

    /// Places the shape at each pose once, if there are more rows than poses, and not too many
    /// parts.
    pub(super) fn shared_by(self, rows: usize) -> Self {
        let parts = self.poses.len().saturating_mul(self.shape.part_count());
        if rows <= self.poses.len() || parts > MAX_SHARED_PARTS || self.shape.as_mesh().is_some() {
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

    /// Checks the pose of a row.
    ///
    /// # Errors
    /// The error of the pose, if it is invalid.
    pub(super) fn check(&self, row: usize) -> Result<(), &InputError> {
        self.poses.get(row).map(drop)
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
