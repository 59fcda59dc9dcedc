//! A mesh and its pose: one side of a query.

use super::triangle_mesh::Mesh;
use crate::math::Pose;

/// A mesh with its pose in the world, taken as a surface or as a solid.
#[derive(Clone, Copy, Debug)]
pub struct PlacedMesh<'a> {
    /// The mesh, in its own frame.
    pub mesh: &'a Mesh,
    /// Maps the mesh frame to the world frame.
    pub world_from_mesh: Pose,
    /// Whether the mesh is a solid: its surface and all points whose winding number is above 1/2 or
    /// below -1/2.
    pub is_solid: bool,
}

/// A mesh taken as a solid: its surface and all points whose winding number is above 1/2 or below
/// -1/2. See [`Mesh::solid`].
#[derive(Clone, Copy, Debug)]
pub struct SolidMesh<'a>(pub(crate) &'a Mesh);

impl Mesh {
    /// Returns the surface of the mesh at a pose in the world, for a query. The pose maps the mesh
    /// frame to the world frame.
    #[must_use]
    pub fn at(&self, world_from_mesh: Pose) -> PlacedMesh<'_> {
        PlacedMesh { mesh: self, world_from_mesh, is_solid: false }
    }

    /// Returns the mesh as a solid, for a query. A shape that lies wholly inside a solid intersects
    /// it.
    ///
    /// ```
    /// use impinge::{Mesh, Pose, Positions, query};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// let large = Mesh::new(Positions::F32(corners), faces)?;
    /// let inside = large.at(Pose::new([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]], [1.0; 3])?);
    /// assert!(!query::intersects(&large, inside));
    /// assert!(query::intersects(large.solid(), inside));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    #[must_use]
    pub fn solid(&self) -> SolidMesh<'_> {
        SolidMesh(self)
    }
}

impl<'a> SolidMesh<'a> {
    /// Returns the solid at a pose in the world, for a query. The pose maps the mesh frame to the
    /// world frame.
    #[must_use]
    pub fn at(self, world_from_mesh: Pose) -> PlacedMesh<'a> {
        PlacedMesh { mesh: self.0, world_from_mesh, is_solid: true }
    }
}

impl<'a> From<&'a Mesh> for PlacedMesh<'a> {
    /// Returns the surface of the mesh with the identity as its pose.
    fn from(mesh: &'a Mesh) -> Self {
        mesh.at(Pose::IDENTITY)
    }
}

impl<'a> From<SolidMesh<'a>> for PlacedMesh<'a> {
    /// Returns the solid with the identity as its pose.
    fn from(solid: SolidMesh<'a>) -> Self {
        solid.at(Pose::IDENTITY)
    }
}
