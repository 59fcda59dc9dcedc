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
#[derive(Debug, Default)]
pub(super) struct OtherPlacement {
    /// Placement of a shape of one part, of which only the pose changes.
    stand: Stand,
    /// Placement of a compound, of which every part changes. `None` for a shape of one part.
    compound: Option<Box<Placed>>,
}

impl OtherPlacement {
    /// Reports whether this is the placement of a compound.
    pub(super) fn is_of_compound(&self) -> bool {
        self.compound.is_some()
    }

    /// Frees the parts of a compound.
    pub(super) fn clear(&mut self) {
        self.compound = None;
    }
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

    /// Validates another pose, and writes the placement for [`swap`](Self::swap).
    ///
    /// # Errors
    /// Returns the error of [`Shape::at`].
    pub(super) fn validate_at(&self, world_from_body: &Pose, other: &mut OtherPlacement) -> Result<(), InputError> {
        let is_alone = self.in_world.write_stand(world_from_body, &mut other.stand)?;
        other.compound = if is_alone { None } else { Some(Box::new(self.moved(*world_from_body)?)) };
        Ok(())
    }

    /// Returns the shape and its pose as they will be after [`swap`](Self::swap).
    pub(super) fn standing<'a>(&'a self, other: &'a OtherPlacement) -> (&'a PlacedShape, &'a Stand) {
        other.compound.as_ref().map_or((&self.in_world, &other.stand), |placed| placed.stands())
    }

    /// Returns the shape and its current pose.
    pub(super) fn stands(&self) -> (&PlacedShape, &Stand) {
        (&self.in_world, self.in_world.stand())
    }

    /// Moves the shape to a validated placement, which becomes the placement before the move. A
    /// shape of one part keeps its data, such as its mesh.
    pub(super) fn swap(&mut self, other: &mut OtherPlacement) {
        match &mut other.compound {
            None => self.in_world.swap_stand(&mut other.stand),
            Some(placed) => std::mem::swap(self, placed),
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
