//! The shape of a body in its place.

use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::PlacedMesh;
use crate::shape::{PlacedShape, Shape, Stand};

/// A shape in the world, and what it was made of.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    shape: Shape,
    in_world: PlacedShape,
}

/// A placed shape as it will be in another pose.
#[derive(Clone, Debug)]
pub(super) enum Judged {
    /// A shape of one part, of which nothing changes but how it stands.
    Alone(Stand),
    /// A compound, of which every part is.
    Compound(Box<Placed>),
}

impl Placed {
    /// # Errors
    /// As [`Shape::at`].
    pub(super) fn new(shape: &Shape, world_from_body: Pose) -> Result<Self, InputError> {
        Ok(Self { shape: shape.clone(), in_world: shape.at(world_from_body)? })
    }

    /// The same elsewhere.
    ///
    /// # Errors
    /// As [`Shape::at`].
    pub(super) fn moved(&self, world_from_body: Pose) -> Result<Self, InputError> {
        Self::new(&self.shape, world_from_body)
    }

    /// The same elsewhere, for [`follow`](Self::follow).
    ///
    /// # Errors
    /// As [`Shape::at`].
    pub(super) fn judge(&self, world_from_body: &Pose) -> Result<Judged, InputError> {
        match self.in_world.stand_at(world_from_body)? {
            Some(stand) => Ok(Judged::Alone(stand)),
            None => Ok(Judged::Compound(Box::new(self.moved(*world_from_body)?))),
        }
    }

    /// The shape and how it stands once it follows.
    pub(super) fn standing<'a>(&'a self, judged: &'a Judged) -> (&'a PlacedShape, &'a Stand) {
        match judged {
            Judged::Alone(stand) => (&self.in_world, stand),
            Judged::Compound(placed) => placed.stands(),
        }
    }

    /// The shape and how it stands.
    pub(super) fn stands(&self) -> (&PlacedShape, &Stand) {
        (&self.in_world, self.in_world.stand())
    }

    /// Moves the shape to where it was judged. A shape of one part is the mesh that it is wherever it goes.
    pub(super) fn follow(&mut self, judged: Judged) {
        match judged {
            Judged::Alone(stand) => self.in_world.follow(stand),
            Judged::Compound(placed) => *self = *placed,
        }
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

    /// The mesh that the shape is, in its own frame; none if it is something else.
    pub(super) fn mesh(&self) -> Option<PlacedMesh<'_>> {
        self.in_world.as_mesh().filter(|mesh| mesh.world_from_mesh == *self.world_from_body())
    }
}
