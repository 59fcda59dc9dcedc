//! A skeleton, the skin over it, and its animations.

use super::animation::Animation;
use super::channel::Target;
use super::error::{RigError, RigErrorKind, RigPlace};
use super::rig_pose::RigPose;
use super::skeleton::{BoneSet, Skeleton};
use super::skin::Skin;
use super::timeline::Side;

/// A character as modeled and animated: the input for fitting hit volumes.
///
/// ```
/// use impinge::character::*;
///
/// let bone = Bone { name: "head".into(), parent: None, rest: Transform::IDENTITY };
/// let inverse_bind = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
/// let whole = vec![Influence { joint: 0, weight: 1.0 }];
/// let skin = Skin::new(
///     vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     vec![[0, 1, 2]],
///     vec![Joint { bone: 0, inverse_bind }],
///     &[whole.clone(), whole.clone(), whole],
///     vec![],
/// )?;
/// let nod = Channel {
///     target: Target::Translation(0),
///     interpolation: Interpolation::Linear,
///     times: vec![0.0, 1.0],
///     values: vec![0.0, 0.0, 0.0, 0.0, -2.0, 0.0],
/// };
/// let rig = Rig::new(Skeleton::new(vec![bone])?, skin, vec![Animation::new("nod".into(), vec![nod], 0)?])?;
/// let mut vertices = Vec::new();
/// rig.skin().skinned(&rig.pose_at(0, 0.5)?, &mut vertices);
/// assert_eq!(vertices[1], [1.0, -1.0, 0.0]);
/// # Ok::<(), RigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    skeleton: Skeleton,
    skin: Skin,
    animations: Vec<Animation>,
}

impl Rig {
    /// Builds a rig.
    ///
    /// # Errors
    /// Returns an error if a joint or channel refers to a bone or morph target that does not exist,
    /// or if the rest pose is out of range.
    pub fn new(skeleton: Skeleton, skin: Skin, animations: Vec<Animation>) -> Result<Self, RigError> {
        let (bones, morphs) = (skeleton.bones().len(), skin.morphs().len());
        let missing = |what, index: u32, len, place| {
            Err(RigError::new(RigErrorKind::Missing { what, index: index as usize, len }, place))
        };
        for (at, joint) in skin.joints().iter().enumerate() {
            if joint.bone as usize >= bones {
                return missing("bone", joint.bone, bones, RigPlace::Joint(at));
            }
        }
        for (at, animation) in animations.iter().enumerate() {
            for (channel, track) in animation.tracks().iter().enumerate() {
                let place = RigPlace::Channel { animation: at, channel };
                match track.target {
                    Target::MorphWeight(morph) if morph as usize >= morphs => {
                        return missing("morph target", morph, morphs, place);
                    }
                    Target::Translation(bone) | Target::Rotation(bone) | Target::Scale(bone)
                        if bone as usize >= bones =>
                    {
                        return missing("bone", bone, bones, place);
                    }
                    _ => {}
                }
            }
        }
        let rig = Self { skeleton, skin, animations };
        rig.rest_pose()?;
        Ok(rig)
    }

    /// Returns the skeleton: the bones.
    #[must_use]
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// Returns the skin: the surface over the bones.
    #[must_use]
    pub fn skin(&self) -> &Skin {
        &self.skin
    }

    /// Returns the animations.
    #[must_use]
    pub fn animations(&self) -> &[Animation] {
        &self.animations
    }

    /// Returns the pose as modeled, with every bone and morph weight at rest.
    ///
    /// # Errors
    /// Same as [`pose_at`](Self::pose_at).
    pub fn rest_pose(&self) -> Result<RigPose, RigError> {
        let mut pose = RigPose::default();
        self.reset(&mut pose);
        self.skeleton.place(&pose.locals, None, &mut pose.bones)?;
        Ok(pose)
    }

    /// Returns the pose of an animation at a time in seconds. Whatever the animation does not move
    /// is at rest. Before the first key of a channel its first value holds, after the last key its
    /// last. A NaN time counts as the start.
    ///
    /// # Errors
    /// Returns an error if the animation does not exist, or if scales multiply beyond 2^100.
    pub fn pose_at(&self, animation: usize, time: f64) -> Result<RigPose, RigError> {
        let mut pose = RigPose::default();
        self.pose_into(animation, time, &mut pose)?;
        Ok(pose)
    }

    /// Computes the pose of an animation at a time in seconds into `pose`, whose memory is reused;
    /// otherwise as [`pose_at`](Self::pose_at).
    ///
    /// # Errors
    /// Same as [`pose_at`](Self::pose_at).
    pub fn pose_into(&self, animation: usize, time: f64, pose: &mut RigPose) -> Result<(), RigError> {
        self.pose_on_side(animation, time, Side::After, None, pose)
    }

    /// Does the same as [`pose_into`](Self::pose_into), but only for the bones of a set. The other
    /// bones and the weights of morph targets get unspecified values. This is enough for a crowd
    /// whose hit volumes are queried (see [`Character::bones`](super::Character::bones)).
    ///
    /// # Errors
    /// Same as [`pose_at`](Self::pose_at).
    pub fn pose_bones_into(
        &self,
        animation: usize,
        time: f64,
        set: &BoneSet,
        pose: &mut RigPose,
    ) -> Result<(), RigError> {
        self.pose_on_side(animation, time, Side::After, Some(set), pose)
    }

    pub(super) fn pose_on_side(
        &self,
        animation: usize,
        time: f64,
        side: Side,
        set: Option<&BoneSet>,
        pose: &mut RigPose,
    ) -> Result<(), RigError> {
        let Some(motion) = self.animations.get(animation) else {
            let kind = RigErrorKind::Missing { what: "animation", index: animation, len: self.animations.len() };
            return Err(RigError::new(kind, RigPlace::Rig));
        };
        self.reset(pose);
        // A NaN time counts as the start.
        let time = if time.is_nan() { motion.span()[0] } else { time };
        motion.sample(time, side, set, &mut pose.locals, &mut pose.morph_weights);
        self.skeleton.place(&pose.locals, set, &mut pose.bones)
    }

    fn reset(&self, pose: &mut RigPose) {
        pose.locals.clear();
        pose.locals.extend(self.skeleton.bones().iter().map(|bone| bone.rest));
        pose.morph_weights.clear();
        pose.morph_weights.extend(self.skin.morphs().iter().map(|morph| morph.weight));
    }
}
