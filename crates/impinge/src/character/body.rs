//! A character with its parts and their volumes, ready for queries.

use std::sync::Arc;

use super::error::RigError;
use super::fit::{self, HitPart, Mode, Piece};
use super::frame::Frame;
use super::plan::{PartPlan, Plan, bones_of_faces, sample_poses};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::samples::PartVertices;
use super::skeleton::BoneSet;
use super::skin_tree::SkinTree;
use super::visit::visit_positions;
use crate::math::vec3::length;

/// The hit volumes of a rigged character: one for each part, fixed to a bone.
#[derive(Clone, Debug)]
pub struct Character {
    parts: Vec<HitPart>,
    part_of_face: Vec<u32>,
    /// Tree over the faces of the skin, for rays at the surface itself.
    skin_tree: Arc<SkinTree>,
    /// Convex pieces, sorted by part. Empty unless the character was refined.
    pub(super) pieces: Vec<Piece>,
    /// The bones that pieces are fixed to, sorted and without duplicates.
    pub(super) piece_anchors: Vec<u32>,
}

/// How far the vertices of one part stick out of the volumes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leak {
    /// Share of the part's vertices that are outside all volumes, from 0 to 1, averaged over poses
    /// of all animations.
    pub share: f64,
    /// Distance from the volumes to the farthest vertex outside, in units of the rig, rounded. It
    /// is 0 if no vertex is outside.
    pub farthest: f64,
}

impl Character {
    /// Fits volumes to the parts of a plan. Parts without faces are left out.
    ///
    /// # Errors
    /// Returns an error if the plan names bones that do not exist, the rig has no faces, a pose is
    /// out of range, or the speed of an animation between two keys has no bound. Returns
    /// [`TooMany`](super::RigErrorKind::TooMany) if a rig of this size has too many keys for its
    /// vertices.
    ///
    /// # Accuracy
    /// Conservative volumes enclose each vertex at rest and at *every* time of every animation, by
    /// construction. They enclose the vertices at sampled times. Between these, the curve of a
    /// vertex, seen from the bone of the volume, deviates from its chord by at most a proved bound,
    /// which is added (`impinge-files/tests/it/characters` checks vertex by vertex). A face whose
    /// corners are in one convex volume is entirely in it, so no ray that hits the surface misses
    /// the volumes.
    ///
    /// # Complexity
    /// Three passes over all samples and vertices. Fast animations have about ten samples per
    /// second, and each key has one or two. The work is limited to a multiple of the rig's size: if
    /// it would be more, there are fewer samples between keys, and the volumes are larger.
    pub fn fit(rig: &Rig, plan: &Plan, mode: Mode) -> Result<Self, RigError> {
        let (parts, part_of_face) = fit::parts(rig, plan, mode)?;
        Ok(Self::new(rig, parts, part_of_face))
    }

    fn new(rig: &Rig, parts: Vec<HitPart>, part_of_face: Vec<u32>) -> Self {
        let skin_tree = Arc::new(SkinTree::new(rig));
        Self { parts, part_of_face, skin_tree, pieces: Vec::new(), piece_anchors: Vec::new() }
    }

    /// Refines the volumes into convex hulls, each around at most `faces` faces (at least one) that
    /// follow the same bone. The hulls enclose these faces conservatively. A ray that enters a
    /// volume is then tested against its hulls, so the reported part is much more often the part
    /// that the surface itself would report. All other queries still use the volumes of the parts.
    ///
    /// # Errors
    /// Same as [`fit`](Self::fit).
    ///
    /// # Complexity
    /// Same as [`fit`](Self::fit).
    pub fn refine(&mut self, rig: &Rig, faces: usize) -> Result<(), RigError> {
        self.pieces = fit::pieces(rig, &self.part_of_face, faces)?;
        self.piece_anchors = self.pieces.iter().map(|piece| piece.anchor).collect();
        self.piece_anchors.sort_unstable();
        self.piece_anchors.dedup();
        Ok(())
    }

    /// Returns the number of hulls that refine the volumes. It is 0 unless the character was
    /// [refined](Self::refine).
    #[must_use]
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Builds a character from existing parts, such as saved ones. Every face goes to the part of
    /// its bone, as [`Plan::part_of_bones`] finds it.
    ///
    /// # Errors
    /// Returns an error if there are no parts, a bone does not exist, or the rig has no faces.
    pub fn of_parts(rig: &Rig, parts: Vec<HitPart>) -> Result<Self, RigError> {
        let plans = parts.iter().map(|part| PartPlan {
            name: part.name.clone(),
            bones: part.bones.clone(),
            anchor: part.anchor,
            kind: None,
        });
        let part_of_bone = Plan { parts: plans.collect() }.part_of_bones(rig)?;
        let part_of_face = bones_of_faces(rig).into_iter().map(|bone| part_of_bone[bone as usize]).collect();
        Ok(Self::new(rig, parts, part_of_face))
    }

    /// Returns the parts.
    #[must_use]
    pub fn parts(&self) -> &[HitPart] {
        &self.parts
    }

    /// Returns the bones that the volumes are fixed to, and all their ancestors: those that
    /// [`Rig::pose_bones_into`](super::Rig::pose_bones_into) must compute for queries of the
    /// volumes.
    #[must_use]
    pub fn bones(&self, rig: &Rig) -> BoneSet {
        let anchors = self.parts.iter().map(|part| part.anchor);
        rig.skeleton().bone_set(anchors.chain(self.piece_anchors.iter().copied()))
    }

    /// Returns the index of the part of each face of the skin.
    #[must_use]
    pub fn part_of_face(&self) -> &[u32] {
        &self.part_of_face
    }

    pub(super) fn skin_tree(&self) -> &SkinTree {
        &self.skin_tree
    }

    /// Returns for each part the rigid frame, in the world, of the bone that its volume is fixed
    /// to, for a pose of the rig. The volume is given in that frame.
    ///
    /// # Panics
    /// If the pose lacks a bone that a part is fixed to.
    #[must_use]
    pub fn frames(&self, pose: &RigPose) -> Vec<Frame> {
        let frame = |part: &HitPart| {
            let bone = &pose.bones()[part.anchor as usize];
            Frame::new(bone.rotation_wxyz, bone.origin())
        };
        self.parts.iter().map(frame).collect()
    }

    /// Measures, for each part, the share of its vertices that are outside all volumes and their
    /// largest distance. Uses about 100 poses over all animations. It proves nothing about other
    /// poses.
    ///
    /// # Errors
    /// Same as [`fit`](Self::fit).
    pub fn leaks(&self, rig: &Rig) -> Result<Vec<Leak>, RigError> {
        let mut held: Vec<PartVertices> =
            self.parts.iter().map(|part| PartVertices { anchor: part.anchor, vertices: Vec::new() }).collect();
        for (face, &part) in rig.skin().faces().iter().zip(&self.part_of_face) {
            held[part as usize].vertices.extend(face);
        }
        let mut leaks = vec![Leak::default(); self.parts.len()];
        let mut counts = vec![0_u32; self.parts.len()];
        for part in &mut held {
            part.vertices.sort_unstable();
            part.vertices.dedup();
        }
        for pose in sample_poses(rig, 96)? {
            let frames = self.frames(&pose);
            visit_positions(rig, &pose, &held, |part, _, point| {
                counts[part] += 1;
                let mut least = self.parts[part].volume.signed_distance(point);
                // Allows for the rounding of the distance.
                let tolerance = 1e-12 * (length(&point) + least.abs());
                if least > tolerance {
                    let world = frames[part].apply(point);
                    for (other, frame) in self.parts.iter().zip(&frames) {
                        least = least.min(other.volume.signed_distance(frame.local(world)));
                    }
                }
                if least > tolerance {
                    leaks[part].share += 1.0;
                    leaks[part].farthest = leaks[part].farthest.max(least);
                }
            });
        }
        leaks.iter_mut().zip(counts).for_each(|(leak, count)| leak.share /= f64::from(count.max(1)));
        Ok(leaks)
    }
}
