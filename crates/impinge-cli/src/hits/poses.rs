//! The poses of a character that a picture shows.

use std::path::Path;

use impinge::character::{Rig, RigPose};

use crate::failure::Failure;

/// Number of frames of one animation, and maximum number of frames if several animations are shown.
const FRAMES: usize = 8;

/// Returns the poses to draw: evenly spaced times of one animation, or the rest pose and the middle
/// of each of the first seven animations.
///
/// # Errors
/// Returns an error if the animation does not exist, or a pose is out of range.
pub(super) fn poses(rig: &Rig, animation: Option<&str>, path: &Path) -> Result<Vec<RigPose>, Failure> {
    let broken = |error: impinge::character::RigError| Failure::new("rig", error.to_string()).in_file(path);
    let at = |animation: usize, share: f64| {
        let [start, end] = rig.animations()[animation].span();
        rig.pose_at(animation, start + share * (end - start)).map_err(broken)
    };
    let Some(name) = animation else {
        let mut poses = vec![rig.rest_pose().map_err(broken)?];
        for animation in 0..rig.animations().len().min(FRAMES - 1) {
            poses.push(at(animation, 0.5)?);
        }
        return Ok(poses);
    };
    let Some(found) = rig.animations().iter().position(|animation| animation.name() == name) else {
        let known: Vec<&str> = rig.animations().iter().map(|animation| animation.name()).collect();
        let failure = Failure::new("no-animation", format!("there is no animation {name:?}")).in_file(path);
        return Err(failure.hint(format!("its animations are {}", known.join(", "))));
    };
    (0..FRAMES).map(|frame| at(found, frame as f64 / (FRAMES - 1) as f64)).collect()
}
