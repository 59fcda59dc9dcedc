//! The planned parts of a character, each with some of its bones.

use super::error::{RigError, RigErrorKind, RigPlace};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::volume::VolumeKind;

/// The parts of a character before volumes are fitted. A person may edit them.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The parts, in the order of their first bones.
    pub parts: Vec<PartPlan>,
}

/// A planned part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartPlan {
    /// The name of the part in results.
    pub name: String,
    /// The indices of the bones whose faces belong to the part.
    pub bones: Vec<u32>,
    /// The index of the bone that the volume is fixed to.
    pub anchor: u32,
    /// The kind of the volume, or `None` to choose the best.
    pub kind: Option<VolumeKind>,
}

impl Plan {
    /// Returns for every bone the index of its part: the part that lists the bone, else the part
    /// that lists its closest listed ancestor, else the first part.
    ///
    /// # Errors
    /// Returns an error if there are no parts or a bone does not exist.
    pub fn part_of_bones(&self, rig: &Rig) -> Result<Vec<u32>, RigError> {
        let len = rig.skeleton().bones().len();
        if self.parts.is_empty() {
            return Err(RigError::new(RigErrorKind::Empty, RigPlace::Rig));
        }
        let mut listed = vec![None; len];
        for (part, plan) in (0..).zip(&self.parts) {
            for &bone in plan.bones.iter().chain([&plan.anchor]) {
                if bone as usize >= len {
                    let kind = RigErrorKind::Missing { what: "bone", index: bone as usize, len };
                    return Err(RigError::new(kind, RigPlace::Rig));
                }
            }
            plan.bones.iter().for_each(|&bone| listed[bone as usize] = Some(part));
        }
        let mut found = vec![0; len];
        for &bone in rig.skeleton().order() {
            let parent = rig.skeleton().bones()[bone as usize].parent;
            let inherited = parent.map_or(0, |parent| found[parent as usize]);
            found[bone as usize] = listed[bone as usize].unwrap_or(inherited);
        }
        Ok(found)
    }
}

/// Returns the bone of each face: the one that its corners follow most, or the lowest index in a
/// tie.
pub(super) fn bones_of_faces(rig: &Rig) -> Vec<u32> {
    let skin = rig.skin();
    let mut shares: Vec<(u32, f64)> = Vec::new();
    let of_face = |face: &[u32; 3]| {
        shares.clear();
        for influence in face.iter().flat_map(|&corner| skin.influences(corner)) {
            let bone = skin.joints()[influence.joint as usize].bone;
            match shares.iter_mut().find(|share| share.0 == bone) {
                Some(share) => share.1 += influence.weight,
                None => shares.push((bone, influence.weight)),
            }
        }
        let most = shares.iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        most.map_or(0, |share| share.0)
    };
    skin.faces().iter().map(of_face).collect()
}

/// Returns the rest pose and about `count` poses spread over the animations.
pub(super) fn sample_poses(rig: &Rig, count: usize) -> Result<Vec<RigPose>, RigError> {
    let mut poses = vec![rig.rest_pose()?];
    let animations = rig.animations().len();
    let each = count.div_ceil(animations.max(1)).max(1);
    // If there are many animations, uses only some of them.
    for at in (0..animations).step_by(animations.div_ceil(count).max(1)) {
        let [start, end] = rig.animations()[at].span();
        for step in 0..each {
            let share = (step as f64 + 0.5) / each as f64;
            poses.push(rig.pose_at(at, start + share * (end - start))?);
        }
    }
    Ok(poses)
}
