//! The skinned surface itself, to confirm the answers of the volumes.

use crate::input::InputError;
use crate::mesh::{Mesh, Positions, Ray};

use super::body::Character;
use super::plan::bones_of_faces;
use super::rig::Rig;
use super::rig_pose::RigPose;

/// The skinned surface of a character in one pose, as a mesh in the world frame that is refitted
/// for other poses. Its vertices are rounded; queries of the mesh are exact.
#[derive(Clone, Debug)]
pub struct Surface {
    mesh: Mesh,
    bone_of_face: Vec<u32>,
    vertices: Vec<[f64; 3]>,
}

/// The first intersection of a ray with the surface of a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Index of the part that the face belongs to.
    pub part: u32,
    /// Index of the bone that the face's corners follow most.
    pub bone: u32,
    /// Index of the face in the skin.
    pub face: u32,
    /// Ray parameter of the intersection, in units of the direction's length. Its relative error is
    /// at most 2^-40.
    pub t: f64,
    /// The point of the intersection, in the world frame, rounded.
    pub point: [f64; 3],
}

impl Surface {
    /// Builds the surface in a pose, which must include all bones.
    ///
    /// # Errors
    /// Returns an error if vertices are out of the range of meshes, which they never are for poses
    /// of a rig.
    pub fn new(rig: &Rig, pose: &RigPose) -> Result<Self, InputError> {
        let mut vertices = Vec::new();
        rig.skin().skinned(pose, &mut vertices);
        let mesh = Mesh::new(Positions::F64(vertices.clone()), rig.skin().faces().to_vec())?;
        Ok(Self { mesh, bone_of_face: bones_of_faces(rig), vertices })
    }

    /// Moves the surface to another pose, which must include all bones, and refits its hierarchy.
    ///
    /// # Errors
    /// Same as [`new`](Self::new).
    pub fn set(&mut self, rig: &Rig, pose: &RigPose) -> Result<(), InputError> {
        rig.skin().skinned(pose, &mut self.vertices);
        self.mesh.refit(Positions::F64(self.vertices.clone())).map(|_| ())
    }

    /// Returns the mesh, in the world frame, for any mesh query.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the first intersection of a ray, given in the world frame, with the surface,
    /// exactly, or `None` if the ray misses it. The character gives the part of each face.
    ///
    /// # Panics
    /// If the character has no part for the face, because it was fitted to another rig.
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
