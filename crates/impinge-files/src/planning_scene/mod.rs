//! Planning scenes of MoveIt: the obstacles around a robot. A scene is a YAML file of the message
//! `moveit_msgs/PlanningScene`, or a `.scene` file in the text format of MoveIt's editor.
//!
//! - Objects are read with their shapes, poses and frames. All else, such as colors, subframes and
//!   the state of the robot, is skipped.
//! - Lengths are in meters. A mesh in a format that states its unit is converted to meters.
//! - A shape that is not supported is an error: an obstacle that is left out could be hit.
//!
//! `yaml` reads YAML into nodes with lines, `message` reads the objects of a message, and
//! `text_form` reads a `.scene` file. `objects` applies the operations of objects, and `frames`
//! places objects of several frames. The module `pieces` of the crate makes the shapes.

mod frames;
mod message;
mod objects;
mod text_form;
mod yaml;

use std::path::{Path, PathBuf};

use impinge::scene::Scene;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    limits::Limits,
    pieces::{Context, DescriptionWarning, Notes, Packages, Shapes},
    regular_file::read_regular_file,
    xml::{self, Encoding},
};
use objects::Objects;

/// Options of [`load_planning_scene`].
#[derive(Clone, Debug, Default)]
pub struct PlanningSceneOptions {
    /// Names of packages, with their folders. Packages that are not here are searched in the
    /// environment variables `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`, then in the folders above
    /// the file.
    pub packages: Vec<(String, PathBuf)>,
    /// Name of the frame of the scene: the root link of the robot. `None` stands for the frame of
    /// the objects, if all have the same.
    pub frame: Option<String>,
    /// Limits on the size of each file.
    pub limits: Limits,
}

/// Obstacles that were loaded from a planning scene.
#[derive(Clone, Debug)]
pub struct PlanningScene {
    /// A part for each object: the union of its shapes.
    pub scene: Scene,
    /// Name of the scene; empty if it has none.
    pub name: String,
    /// Content that was skipped, guessed, or may surprise.
    pub warnings: Vec<DescriptionWarning>,
}

/// Reports whether a path names a planning scene: whether its extension is `.yaml`, `.yml` or
/// `.scene`.
#[must_use]
pub fn is_planning_scene(path: impl AsRef<Path>) -> bool {
    let extension = path.as_ref().extension().unwrap_or_default();
    ["yaml", "yml", "scene"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Loads the obstacles of a planning scene, with the meshes that it names.
///
/// An object is the union of its boxes, spheres, cylinders, cones and meshes. Closed meshes are
/// solids; a mesh that is open is its surface, with a warning. An object of another frame is placed
/// by the `fixed_frame_transforms` of the scene. If these do not have its frame, the frame must be
/// that of all such objects, and is taken for the frame of the scene.
///
/// ```no_run
/// use impinge_files::{PlanningSceneOptions, load_planning_scene};
///
/// let options = PlanningSceneOptions { frame: Some("panda_link0".to_owned()), ..PlanningSceneOptions::default() };
/// let kitchen = load_planning_scene("kitchen.yaml", &options)?;
/// println!("{} obstacles", kitchen.scene.parts().len());
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// Returns an error if a file cannot be read or exceeds the limits, is not a planning scene or has
/// an invalid number; if a shape is not supported, such as a plane or an octomap; if a mesh is
/// missing, ambiguous or invalid; or if objects have several frames that are not known. The error
/// names the file, the line and the object.
pub fn load_planning_scene(path: impl AsRef<Path>, options: &PlanningSceneOptions) -> Result<PlanningScene, LoadError> {
    let path = path.as_ref();
    let mut notes = Notes::new(path);
    let read = read(path, options, &mut notes);
    let (name, scene) =
        read.map_err(|error| if error.path().as_os_str().is_empty() { error.in_file(path) } else { error })?;
    Ok(PlanningScene { scene, name, warnings: notes.into_vec() })
}

/// The content of a file.
struct Content {
    name: String,
    objects: Objects,
    transforms: Vec<frames::Transform>,
}

fn read(path: &Path, options: &PlanningSceneOptions, notes: &mut Notes<'_>) -> Result<(String, Scene), LoadError> {
    let bytes = read_regular_file(path, &options.limits)?;
    if bytes.is_empty() {
        return Err(LoadError::new(LoadErrorKind::Empty));
    }
    let text = xml::decode(bytes, Encoding::UnicodeOrLatin1)?;
    let is_text_form = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("scene"));
    let content = if is_text_form && text_form::opens(&text) {
        text_form::read(&text, notes)?
    } else {
        message::read(&text, &options.limits, notes)?
    };
    let placed = frames::placed(content.objects, content.transforms, options.frame.as_deref(), notes)?;
    let context = Context {
        noun: "object",
        broken: |object, problem| LoadErrorKind::BrokenObject { object, problem },
        place: &place,
    };
    let packages = Packages::new(path, &options.packages);
    let mut shapes = Shapes::new(context, packages, false, &options.limits);
    let mut scene = Scene::new();
    for object in placed {
        match shapes.of(&object.name, &object.pieces, notes)? {
            Some(shape) => {
                let added = scene.add(object.name, &shape, object.pose);
                added.map_err(|error| {
                    LoadError::new(LoadErrorKind::Corrupt { what: error.to_string() }).at(place(object.line))
                })?;
            }
            None => notes.add(|| place(object.line), format!("object {:?} has no shapes, skipped", object.name)),
        }
    }
    Ok((content.name, scene))
}

fn place(line: usize) -> Place {
    Place::Line(line as u64)
}
