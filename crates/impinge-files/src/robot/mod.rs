//! Robots: URDF (ROS, *Unified Robot Description Format*) with the meshes that it names, and SRDF
//! (MoveIt, *Semantic Robot Description Format*) about the same robot.
//!
//! - Links, joints, and the shapes of links are read. All else, such as inertia, materials,
//!   transmissions and elements of simulators, is skipped.
//! - Lengths are in meters. A mesh in a format that states its unit is converted to meters. The
//!   axes of a mesh are those of its file, also those of COLLADA: that is the convention of ROS.
//! - Links and joints may be in any order.
//!
//! `urdf`, `geometry` and `attributes` read a URDF file, and `srdf` reads an SRDF file. `audit`
//! writes one. The module `pieces` of the crate makes the shapes.

mod attributes;
mod audit;
mod geometry;
mod problem;
mod srdf;
mod urdf;

use std::path::{Path, PathBuf};

use impinge::robot::{Link, Robot, RobotError};

use crate::{
    error::{LoadError, LoadErrorKind},
    limits::Limits,
    pieces::{Context, DescriptionWarning, Notes, Packages, Shapes},
    regular_file::read_regular_file,
    xml::{self, Encoding},
    xml_tree::Tree,
};
use urdf::Description;

pub use problem::RobotProblem;
pub use srdf::{LoadedState, RobotGroup};

/// The shapes that represent the links of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobotGeometry {
    /// The elements `collision`.
    #[default]
    Collision,
    /// The elements `visual`.
    Visual,
    /// The elements `collision`, with the convex hull of each mesh.
    Hull,
}

/// Options of [`load_robot`].
#[derive(Clone, Debug, Default)]
pub struct RobotOptions {
    /// SRDF file about the robot, if any.
    pub srdf: Option<PathBuf>,
    /// Names of packages, with their folders. Packages that are not here are searched in the
    /// environment variables `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`, then in the folders above
    /// the URDF file.
    pub packages: Vec<(String, PathBuf)>,
    /// The shapes that represent the links.
    pub geometry: RobotGeometry,
    /// Limits on the size of each file.
    pub limits: Limits,
}

/// A robot that was loaded from files.
#[derive(Clone, Debug)]
pub struct LoadedRobot {
    /// The robot.
    pub robot: Robot,
    /// Name of the robot.
    pub name: String,
    /// Groups of joints of the SRDF file.
    pub groups: Vec<RobotGroup>,
    /// Named states of the SRDF file.
    pub states: Vec<LoadedState>,
    /// Content that was skipped, guessed, or may surprise.
    pub warnings: Vec<DescriptionWarning>,
}

/// Loads a robot from a URDF file, with the meshes that it names, and optionally an SRDF file.
///
/// A link is the union of its shapes. Closed meshes are solids; a mesh that is open is its surface,
/// with a warning. Pairs of links that a joint or only fixed joints connect are not checked, nor
/// are those that the SRDF file disables.
///
/// ```no_run
/// use impinge_files::{RobotOptions, load_robot};
///
/// let options = RobotOptions { srdf: Some("panda.srdf".into()), ..RobotOptions::default() };
/// let panda = load_robot("panda.urdf", &options)?;
/// println!("{} coordinates", panda.robot.coordinates().len());
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// Returns an error if a file cannot be read or exceeds the limits, is a xacro, SDF or MJCF file,
/// is not well-formed XML, or has an invalid number; if links and joints are not one tree; or if a
/// mesh is missing, ambiguous or invalid. The error names the file, the line, and the link or the
/// joint.
pub fn load_robot(path: impl AsRef<Path>, options: &RobotOptions) -> Result<LoadedRobot, LoadError> {
    let path = path.as_ref();
    let mut notes = Notes::new(path);
    let (name, mut robot) = read_urdf(path, options, &mut notes).map_err(|error| named(error, path))?;
    let mut warnings = notes.into_vec();
    let (mut groups, mut states) = (Vec::new(), Vec::new());
    if let Some(path) = &options.srdf {
        let mut notes = Notes::new(path);
        let mut read = || {
            let text = read_text(path, &options.limits)?;
            srdf::read(&Tree::parse(&text)?, &robot, &name, &mut notes)
        };
        let semantics = read().map_err(|error| named(error, path))?;
        robot.choose(semantics.choices);
        (groups, states) = (semantics.groups, semantics.states);
        warnings.extend(notes.into_vec());
    }
    Ok(LoadedRobot { robot, name, groups, states, warnings })
}

/// Returns an error with the path of the file, unless it has the path of another file.
fn named(error: LoadError, path: &Path) -> LoadError {
    if error.path().as_os_str().is_empty() { error.in_file(path) } else { error }
}

fn read_text(path: &Path, limits: &Limits) -> Result<String, LoadError> {
    let bytes = read_regular_file(path, limits)?;
    if bytes.is_empty() {
        return Err(LoadError::new(LoadErrorKind::Empty));
    }
    xml::decode(bytes, Encoding::UnicodeOrLatin1)
}

fn read_urdf(path: &Path, options: &RobotOptions, notes: &mut Notes<'_>) -> Result<(String, Robot), LoadError> {
    let text = read_text(path, &options.limits)?;
    let tree = Tree::parse(&text)?;
    let Description { name, links: texts, joints, joint_elements } = urdf::read(&tree, notes)?;
    let names: Vec<String> = texts.iter().map(|link| link.name.clone()).collect();
    let place_of = |error: &RobotError| {
        let subject = error.subject()?;
        let link = names.iter().rposition(|name| subject == format!("link {name:?}")).map(|at| texts[at].element);
        let joint = || joints.iter().rposition(|joint| subject == format!("joint {:?}", joint.name));
        Some(tree.place(link.or_else(|| Some(joint_elements[joint()?]))?))
    };
    let broken = |error: RobotError| {
        let place = place_of(&error);
        let error = LoadError::new(LoadErrorKind::BrokenRobot { problem: RobotProblem::Tree(error) });
        if let Some(place) = place { error.at(place) } else { error }
    };
    // The tree is validated before any mesh is loaded.
    let bare = |name: &String| Link { name: name.clone(), shape: None };
    Robot::new(names.iter().map(bare).collect(), joints.clone()).map_err(broken)?;
    let packages = Packages::new(path, &options.packages);
    let context = Context {
        noun: "link",
        broken: |link, problem| LoadErrorKind::BrokenRobot { problem: RobotProblem::Link { link, problem } },
        place: &|element| tree.place(element),
    };
    let mut shapes = Shapes::new(context, packages, options.geometry == RobotGeometry::Hull, &options.limits);
    let mut links = Vec::with_capacity(texts.len());
    let mut only_visual = Vec::new();
    for link in &texts {
        let pieces = if options.geometry == RobotGeometry::Visual { &link.visual } else { &link.collision };
        if link.collision.is_empty() && !link.visual.is_empty() {
            only_visual.push(link.name.as_str());
        }
        links.push(Link { name: link.name.clone(), shape: shapes.of(&link.name, pieces, notes)? });
    }
    if !only_visual.is_empty() && options.geometry != RobotGeometry::Visual {
        let message = format!("links without collision geometry, which cannot collide: {}", only_visual.join(", "));
        notes.add_about_all(message);
    }
    Ok((name, Robot::new(links, joints.clone()).map_err(broken)?))
}
