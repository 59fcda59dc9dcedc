//! A mesh and its pose: one side of a query.

use super::triangle_mesh::Mesh;
use crate::math::Pose;

/// A mesh and where it stands in the world.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Maps the mesh's own frame to the world.
    pub world_from_mesh: Pose,
}

impl<'a> From<&'a Mesh> for Placed<'a> {
    /// The mesh where its own frame is the world.
    fn from(mesh: &'a Mesh) -> Self {
        mesh.at(Pose::IDENTITY)
    }
}

impl Mesh {
    /// The mesh placed in the world, for a query.
    #[must_use]
    pub fn at(&self, world_from_mesh: Pose) -> Placed<'_> {
        Placed { mesh: self, world_from_mesh }
    }
}
