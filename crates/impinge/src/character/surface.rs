//! The skinned surface itself, to confirm what the volumes say.

use crate::input::InputError;
use crate::mesh::{Mesh, Positions, Ray};

use super::body::Character;
use super::plan::bones_of_faces;
use super::rig::Rig;
use super::rig_pose::RigPose;

/// The surface of a character in one pose, as an exact mesh that is refitted to the next.
#[derive(Clone, Debug)]
pub struct Surface {
    mesh: Mesh,
    bone_of_face: Vec<u32>,
    vertices: Vec<[f64; 3]>,
}

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// The part of the face.
    pub part: u32,
    /// The bone that the face's corners follow most.
    pub bone: u32,
    /// The face.
    pub face: u32,
    /// In units of the direction's length.
    pub t: f64,
    /// In the world frame, rounded.
    pub point: [f64; 3],
}

impl Surface {
    /// The surface in a pose.
    ///
    /// # Errors
    /// Vertices out of the range of meshes, which no pose of a rig has.
    pub fn new(rig: &Rig, pose: &RigPose) -> Result<Self, InputError> {
        let mut vertices = Vec::new();
        rig.skin().skinned(pose, &mut vertices);
        let mesh = Mesh::new(Positions::F64(vertices.clone()), rig.skin().faces().to_vec())?;
        Ok(Self { mesh, bone_of_face: bones_of_faces(rig), vertices })
    }

    /// Moves the surface to another pose; its hierarchy is refitted.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn set(&mut self, rig: &Rig, pose: &RigPose) -> Result<(), InputError> {
        rig.skin().skinned(pose, &mut self.vertices);
        self.mesh.refit(Positions::F64(self.vertices.clone())).map(|_| ())
    }

    /// The mesh, in the world frame, for any question of meshes.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Where a ray first meets the surface, exactly.
    #[must_use]
    pub fn ray_cast(&self, character: &Character, ray: &Ray) -> Option<SurfaceHit> {
        let hit = self.mesh.ray_cast(ray)?;
        Some(SurfaceHit {
            part: character.part_of_face()[hit.face as usize],
            bone: self.bone_of_face[hit.face as usize],
            face: hit.face,
            t: hit.t,
            point: hit.point,
        })
    }
}
