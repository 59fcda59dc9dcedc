//! Places objects in the frame of the scene.

use impinge::Pose;

use super::{
    objects::{Object, Objects},
    place,
};
use crate::{error::LoadError, pieces::Notes};

/// A transform of `fixed_frame_transforms`.
pub(super) struct Transform {
    pub(super) child: String,
    /// Map from the child's frame to the frame of the scene.
    pub(super) scene_from_child: Pose,
}

/// Returns the objects with their poses in the frame of the scene.
///
/// # Errors
/// Returns an error if two objects have different frames that are not known, because at most one of
/// them can be the frame of the scene.
pub(super) fn placed(
    objects: Objects,
    transforms: Vec<Transform>,
    scene_frame: Option<&str>,
    notes: &mut Notes<'_>,
) -> Result<Vec<Object>, LoadError> {
    // Names of ROS 1 may begin with a slash.
    let plain = |frame: &str| frame.trim().trim_start_matches('/').to_owned();
    let scene_frame = scene_frame.map(plain);
    let mut assumed: Option<String> = None;
    let mut all = objects.into_vec();
    for object in &mut all {
        let frame = plain(&object.frame);
        if frame.is_empty() || Some(&frame) == scene_frame.as_ref() || Some(&frame) == assumed.as_ref() {
            continue;
        }
        // The last transform of a name counts.
        if let Some(known) = transforms.iter().rev().find(|known| plain(&known.child) == frame) {
            object.pose = known.scene_from_child.compose(&object.pose).map_err(|error| {
                LoadError::refused(format!("a smaller pose of object {:?}", object.name), &error).at(place(object.line))
            })?;
            continue;
        }
        if let Some(assumed) = &assumed {
            let expected = format!("the frame {assumed:?} of the objects before object {:?}", object.name);
            let error = LoadError::syntax(expected, frame.as_bytes()).at(place(object.line));
            return Err(error.with_hint("fixed_frame_transforms states where another frame is"));
        }
        if let Some(scene_frame) = &scene_frame {
            let message = format!("the frame {frame:?} is not known, and is taken for {scene_frame:?}");
            notes.add(|| place(object.line), message);
        }
        assumed = Some(frame);
    }
    Ok(all)
}
