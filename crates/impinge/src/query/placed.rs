//! The arguments of a query: things with their poses.

use std::borrow::Cow;

use crate::mesh::{Mesh, PlacedMesh, SolidMesh};
use crate::shape::PlacedShape;

/// A thing in the world: a mesh, as its surface or as a solid, a shape, or a compound.
///
/// Queries take everything that converts to it: `&mesh`, `mesh.at(pose)`, `mesh.solid()`,
/// `mesh.solid().at(pose)`, `shape.at(pose)?` and references to a placed shape. A mesh without a
/// pose has the identity as its pose, so its own frame is the world frame.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, Shape, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let sphere = Shape::sphere([0.0; 3], 0.5)?;
/// let above = Pose::from_translation([0.25, 0.25, 0.5])?;
/// assert!(query::intersects(&mesh, sphere.at(above)?)); // they touch
/// assert!(!query::intersects(&mesh, mesh.at(above)));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Placed<'a> {
    /// A mesh with its pose, as its surface or as a solid.
    Mesh(PlacedMesh<'a>),
    /// A shape or a compound with its pose. A shape that is made of one mesh counts as that mesh.
    Shape(Cow<'a, PlacedShape>),
}

impl Placed<'_> {
    /// Returns the mesh, or `None` if this is a shape that is not made of one mesh.
    #[must_use]
    pub fn mesh(&self) -> Option<PlacedMesh<'_>> {
        match self {
            Self::Mesh(mesh) => Some(*mesh),
            Self::Shape(shape) => shape.as_mesh(),
        }
    }

    /// Returns this thing as a shape. A mesh becomes the shape of its surface or its solid.
    pub(super) fn shape(&self) -> Cow<'_, PlacedShape> {
        match self {
            Self::Mesh(mesh) => Cow::Owned(PlacedShape::from(*mesh)),
            Self::Shape(shape) => Cow::Borrowed(shape),
        }
    }
}

/// Returns both meshes, or `None` if one of the two things is not a mesh.
pub(super) fn meshes<'p>(a: &'p Placed<'_>, b: &'p Placed<'_>) -> Option<[PlacedMesh<'p>; 2]> {
    Some([a.mesh()?, b.mesh()?])
}

impl<'a> From<&'a Mesh> for Placed<'a> {
    fn from(mesh: &'a Mesh) -> Self {
        Self::Mesh(mesh.into())
    }
}

impl<'a> From<SolidMesh<'a>> for Placed<'a> {
    fn from(solid: SolidMesh<'a>) -> Self {
        Self::Mesh(solid.into())
    }
}

impl<'a> From<PlacedMesh<'a>> for Placed<'a> {
    fn from(mesh: PlacedMesh<'a>) -> Self {
        Self::Mesh(mesh)
    }
}

impl<'a> From<&'a PlacedShape> for Placed<'a> {
    fn from(shape: &'a PlacedShape) -> Self {
        Self::Shape(Cow::Borrowed(shape))
    }
}

impl From<PlacedShape> for Placed<'_> {
    fn from(shape: PlacedShape) -> Self {
        Self::Shape(Cow::Owned(shape))
    }
}

impl<'a> From<&'a Self> for Placed<'a> {
    fn from(placed: &'a Self) -> Self {
        match placed {
            Self::Mesh(mesh) => Self::Mesh(*mesh),
            Self::Shape(shape) => Self::Shape(Cow::Borrowed(shape)),
        }
    }
}
