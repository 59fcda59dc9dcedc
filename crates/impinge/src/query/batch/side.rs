//! One of the two things of a batch, at its poses.

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
    /// Where a shape stands that has one pose; none for a mesh, which is placed at no cost.
    alone: Option<Box<PlacedShape>>,
}

impl Side {
    pub(super) fn new(shape: Shape, mut poses: Poses) -> Self {
        if !shape.is_affine() {
            poses.refuse(|pose| shape.judge(pose));
        }
        let is_alone = poses.len() == 1 && shape.as_mesh().is_none();
        let alone = is_alone.then(|| poses.get(0).ok()).flatten().and_then(|pose| shape.at(*pose).ok().map(Box::new));
        Self { shape, poses, alone }
    }

    pub(super) fn poses(&self) -> &Poses {
        &self.poses
    }

    /// Returns the thing at the pose of a row; the error if that is faulty.
    pub(super) fn at(&self, row: usize) -> Result<Placed<'_>, InputError> {
        let world_from_mesh = *self.poses.get(row).map_err(Clone::clone)?;
        if let Some((mesh, is_solid)) = self.shape.as_mesh() {
            return Ok(PlacedMesh { mesh, world_from_mesh, is_solid }.into());
        }
        match &self.alone {
            Some(placed) => Ok(placed.as_ref().into()),
            None => Ok(self.shape.at(world_from_mesh)?.into()),
        }
    }
}
