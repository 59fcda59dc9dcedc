//! A character ready to be struck: parts with their volumes, and one pose of it.

use std::sync::Arc;

use super::error::RigError;
use super::fit::{self, HitPart, Mode, Piece, places};
use super::frame::Frame;
use super::plan::{PartPlan, Plan, bones_of_faces, some_poses};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::samples::Held;
use super::skeleton::BoneSet;
use super::skin_tree::SkinTree;
use crate::math::vec3::length;

/// The hit volumes of a rigged character.
#[derive(Clone, Debug)]
pub struct Character {
    parts: Vec<HitPart>,
    part_of_face: Vec<u32>,
    /// Of the faces, for rays at the surface itself.
    skin_tree: Arc<SkinTree>,
    /// By part; empty unless the character was refined.
    pub(super) pieces: Vec<Piece>,
    /// The bones that pieces are fixed to, each once.
    pub(super) piece_anchors: Vec<u32>,
}

/// What of a surface is outside of the volumes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leak {
    /// The share of vertices, over poses of all animations.
    pub share: f64,
    /// How far the farthest is outside, in units of the rig.
    pub farthest: f64,
}

impl Character {
    /// Fits volumes to the parts of a plan.
    ///
    /// # Errors
    /// A plan that names bones which do not exist, a rig without faces, one whose poses leave their range, or an animation
    /// whose speed between keys has no bound.
    ///
    /// # Accuracy
    /// Conservative volumes hold each vertex at rest and at *every* time of every animation, by construction: they hold
    /// the vertices at sampled times, and the curves between these, seen from the bone of the volume, deviate from their
    /// chords by a bound that is added (`impinge-files/tests/it/characters` checks vertex by vertex). A face whose
    /// corners are in one volume is in it whole, so no ray that meets the surface misses the volumes.
    ///
    /// # Complexity
    /// Three runs over all samples and vertices; some ten samples for each second of an animation that moves fast, and one for
    /// each of its keys.
    pub fn fit(rig: &Rig, plan: &Plan, mode: Mode) -> Result<Self, RigError> {
        let (parts, part_of_face) = fit::parts(rig, plan, mode)?;
        Ok(Self::new(rig, parts, part_of_face))
    }

    fn new(rig: &Rig, parts: Vec<HitPart>, part_of_face: Vec<u32>) -> Self {
        let skin_tree = Arc::new(SkinTree::new(rig));
        Self { parts, part_of_face, skin_tree, pieces: Vec::new(), piece_anchors: Vec::new() }
    }

    /// Opens the volumes into hulls about groups of at most `faces` faces that go with one bone, which conservatively hold them.
    /// Rays that enter a volume then go on to these, so that what they strike is what they would strike on the surface far
    /// more often. All other questions are still asked of the parts' volumes.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    ///
    /// # Complexity
    /// As [`fit`](Self::fit).
    pub fn refine(&mut self, rig: &Rig, faces: usize) -> Result<(), RigError> {
        self.pieces = fit::pieces(rig, &self.part_of_face, faces)?;
        self.piece_anchors = self.pieces.iter().map(|piece| piece.anchor).collect();
        self.piece_anchors.sort_unstable();
        self.piece_anchors.dedup();
        Ok(())
    }

    /// How many hulls the volumes are opened into; none unless the character was [refined](Self::refine).
    #[must_use]
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// A character whose parts somebody else found, as when they were saved: every face goes to the part of its bone.
    ///
    /// # Errors
    /// No parts, bones that do not exist, or a rig without faces.
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

    /// The parts.
    #[must_use]
    pub fn parts(&self) -> &[HitPart] {
        &self.parts
    }

    /// The bones that its volumes are fixed to, and all that these hang on.
    #[must_use]
    pub fn bones(&self, rig: &Rig) -> BoneSet {
        let anchors = self.parts.iter().map(|part| part.anchor);
        rig.skeleton().bone_set(anchors.chain(self.piece_anchors.iter().copied()))
    }

    /// The part of each face of the skin.
    #[must_use]
    pub fn part_of_face(&self) -> &[u32] {
        &self.part_of_face
    }

    pub(super) fn skin_tree(&self) -> &SkinTree {
        &self.skin_tree
    }

    /// The frames of the parts in a pose of the rig.
    #[must_use]
    pub fn frames(&self, pose: &RigPose) -> Vec<Frame> {
        let frame = |part: &HitPart| {
            let bone = &pose.bones()[part.anchor as usize];
            Frame::new(bone.rotation_wxyz, bone.origin())
        };
        self.parts.iter().map(frame).collect()
    }

    /// What of each part's vertices is outside of all volumes, in some hundred poses of all animations.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn leaks(&self, rig: &Rig) -> Result<Vec<Leak>, RigError> {
        let mut held: Vec<Held> =
            self.parts.iter().map(|part| Held { anchor: part.anchor, vertices: Vec::new() }).collect();
        for (face, &part) in rig.skin().faces().iter().zip(&self.part_of_face) {
            held[part as usize].vertices.extend(face);
        }
        let mut leaks = vec![Leak::default(); self.parts.len()];
        let mut counts = vec![0_u32; self.parts.len()];
        for part in &mut held {
            part.vertices.sort_unstable();
            part.vertices.dedup();
        }
        for pose in some_poses(rig, 96)? {
            let frames = self.frames(&pose);
            places(rig, &pose, &held, |part, _, point| {
                counts[part] += 1;
                let mut least = self.parts[part].volume.signed_distance(point);
                // Up to the rounding of the distance.
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
