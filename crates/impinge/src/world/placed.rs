//! The shape of a body at its pose.

use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::PlacedMesh;
use crate::shape::{Form, PlacedShape, Shape, Stand};

/// A shape placed in the world, together with the shape itself.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    shape: Shape,
    in_world: PlacedShape,
}

/// A validated placement of a shape at another pose.
#[derive(Clone, Debug)]
pub(super) enum ValidPlacement {
    /// Placement of a shape of one part, of which only the pose changes.
    Alone(Stand),
    /// Placement of a compound, of which every part changes.
    Compound(Box<Placed>),
}

impl Placed {
    /// Places a shape.
    ///
    /// # Errors
    /// Returns the error of [`Shape::at`].
    pub(super) fn new(shape: &Shape, world_from_body: Pose) -> Result<Self, InputError> {
        Ok(Self { shape: shape.clone(), in_world: shape.at(world_from_body)? })
    }

    /// Returns the shape placed at another pose.
    ///
    /// # Errors
    /// Returns the error of [`Shape::at`].
    pub(super) fn moved(&self, world_from_body: Pose) -> Result<Self, InputError> {
        Self::new(&self.shape, world_from_body)
    }

    /// Validates another pose, and returns the placement for [`swap`](Self::swap).
    ///
    /// # Errors
    /// Returns the error of [`Shape::at`].
    pub(super) fn validate_at(&self, world_from_body: &Pose) -> Result<ValidPlacement, InputError> {
        match self.in_world.stand_at(world_from_body)? {
            Some(stand) => Ok(ValidPlacement::Alone(stand)),
            None => Ok(ValidPlacement::Compound(Box::new(self.moved(*world_from_body)?))),
        }
    }

    /// Returns the shape and its pose as they will be after [`swap`](Self::swap).
    pub(super) fn standing<'a>(&'a self, placement: &'a ValidPlacement) -> (&'a PlacedShape, &'a Stand) {
        match placement {
            ValidPlacement::Alone(stand) => (&self.in_world, stand),
            ValidPlacement::Compound(placed) => placed.stands(),
        }
    }

    /// Returns the shape and its current pose.
    pub(super) fn stands(&self) -> (&PlacedShape, &Stand) {
        (&self.in_world, self.in_world.stand())
    }

    /// Moves the shape to a validated placement, which becomes the placement before the move. A
    /// shape of one part keeps its data, such as its mesh.
    pub(super) fn swap(&mut self, placement: &mut ValidPlacement) {
        match placement {
            ValidPlacement::Alone(stand) => self.in_world.swap_stand(stand),
            ValidPlacement::Compound(placed) => std::mem::swap(self, placed),
        }
    }

    /// Reports whether queries about this shape take about a microsecond: it is a half-space or one
    /// convex set.
    pub(super) fn is_quick(&self) -> bool {
        matches!(self.in_world.parts(), [part] if matches!(part.form(), Form::Convex(_) | Form::HalfSpace(_)))
    }

    pub(super) fn shape(&self) -> &Shape {
        &self.shape
    }

    pub(super) fn in_world(&self) -> &PlacedShape {
        &self.in_world
    }

    pub(super) fn world_from_body(&self) -> &Pose {
        self.in_world.world_from_local()
    }

    /// Returns the mesh if the shape is a mesh, in its own frame, or `None` otherwise.
    pub(super) fn mesh(&self) -> Option<PlacedMesh<'_>> {
        self.in_world.as_mesh().filter(|mesh| mesh.world_from_mesh == *self.world_from_body())
    }
}
