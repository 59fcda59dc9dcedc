//! The robot and the obstacles of a question, from files and options.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use impinge::robot::{CheckError, CheckOptions, Collision, ConfigurationError, Other, Robot};
use impinge::scene::{Scene, Stop};
use impinge::{Mesh, Shape};
use impinge_files::{
    LoadedRobot, PlanningSceneOptions, RobotGeometry, RobotOptions, SceneOptions, Unit, is_planning_scene,
    load_planning_scene, load_robot, load_scene,
};

use crate::check::timed;
use crate::console;
use crate::failure::Failure;

/// Files of a robot.
#[derive(Args)]
pub(super) struct RobotArguments {
    /// The URDF file; process a xacro file first
    #[arg(value_name = "URDF")]
    urdf: PathBuf,
    /// SRDF file: pairs of links that are not checked, groups and states
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// Folder of a package that package:// URIs name; may be repeated
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = package)]
    packages: Vec<(String, PathBuf)>,
    /// The shapes of the links
    #[arg(long, value_name = "KIND", default_value = "collision")]
    geometry: Geometry,
    /// Print one JSON object instead of the report
    #[arg(long)]
    pub(super) json: bool,
}

/// Values of `--geometry`.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Geometry {
    /// The collision elements
    Collision,
    /// The visual elements
    Visual,
    /// The collision elements, with convex hulls of meshes
    Hull,
}

/// Obstacles and clearances.
#[derive(Args)]
pub(super) struct Surroundings {
    /// Obstacles in the frame of the root link: a scene in glTF, GLB or any format of meshes, or a
    /// planning scene of MoveIt (.yaml, .yml or .scene)
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Distance that links keep from obstacles: for all links, or for one; may be repeated
    #[arg(long, value_name = "[LINK=]D", allow_hyphen_values = true)]
    padding: Vec<String>,
    /// Distance that links keep from each other
    #[arg(long, value_name = "D", default_value_t = 0.0, allow_hyphen_values = true)]
    self_padding: f64,
}

/// Configurations that are checked.
#[derive(Args)]
pub(super) struct Configurations {
    /// Configurations: a .csv file, which may begin with the names of the joints, or a .npy file
    #[arg(long, value_name = "FILE")]
    pub(super) configs: PathBuf,
}

/// A page for a browser.
#[derive(Args)]
pub(super) struct View {
    /// Write a page for a browser to an .html file: the robot in its configurations, with a slider
    ///
    /// Of configurations the page shows those that collide. It needs no other file and no network.
    #[arg(long, value_name = "OUT")]
    pub(super) view: Option<PathBuf>,
}

/// A robot and obstacles.
pub(super) struct Loaded {
    pub(super) robot: LoadedRobot,
    pub(super) scene: Option<Scene>,
    /// Duration of loading, in seconds.
    pub(super) seconds: f64,
}

fn package(text: &str) -> Result<(String, PathBuf), String> {
    let parts = text.split_once('=').filter(|(name, folder)| !name.is_empty() && !folder.is_empty());
    parts.map(|(name, folder)| (name.to_owned(), folder.into())).ok_or_else(|| "write NAME=DIR".to_owned())
}

impl RobotArguments {
    /// Loads the robot and the obstacles, and prints warnings about their files.
    pub(super) fn load(&self, surroundings: Option<&Surroundings>) -> Result<Loaded, Failure> {
        let options = RobotOptions {
            srdf: self.srdf.clone(),
            packages: self.packages.clone(),
            geometry: match self.geometry {
                Geometry::Collision => RobotGeometry::Collision,
                Geometry::Visual => RobotGeometry::Visual,
                Geometry::Hull => RobotGeometry::Hull,
            },
            ..RobotOptions::default()
        };
        let load = || -> Result<_, Failure> {
            let robot = load_robot(&self.urdf, &options)?;
            let path = surroundings.and_then(|surroundings| surroundings.scene.as_ref());
            let scene = path.map(|path| self.load_obstacles(path, &robot.robot)).transpose()?;
            Ok((robot, scene))
        };
        let (loaded, seconds) = timed("loading", load);
        let (robot, scene) = loaded?;
        robot.warnings.iter().for_each(|warning| console::warn(&warning.to_string()));
        Ok(Loaded { robot, scene, seconds })
    }

    fn load_obstacles(&self, path: &Path, robot: &Robot) -> Result<Scene, Failure> {
        if is_planning_scene(path) {
            let frame = Some(robot.links()[robot.root()].name.clone());
            let options =
                PlanningSceneOptions { packages: self.packages.clone(), frame, ..PlanningSceneOptions::default() };
            let planning = load_planning_scene(path, &options)?;
            planning.warnings.iter().for_each(|warning| console::warn(&warning.to_string()));
            return Ok(planning.scene);
        }
        let model = load_scene(path, &SceneOptions { unit: Some(Unit::Meter), ..SceneOptions::default() })?;
        model.warnings.iter().for_each(|warning| console::warn(&format!("{}: {warning}", path.display())));
        // The inside of an open mesh is not known, so it is its surface, as in a robot.
        let shape = |mesh: &Mesh| if mesh.is_closed() { Shape::from(mesh.solid()) } else { Shape::from(mesh) };
        model.into_scene(shape).map_err(|error| Failure::from(error).in_file(path))
    }
}

impl Surroundings {
    /// Returns the options of a check of the robot.
    pub(super) fn options<'l>(&self, loaded: &'l Loaded, stop: Stop) -> Result<CheckOptions<'l>, Failure> {
        let robot = &loaded.robot.robot;
        let distance = |text: &str| {
            let distance = text.parse::<f64>().ok().filter(|distance| distance.is_finite() && *distance >= 0.0);
            distance.ok_or_else(|| {
                Failure::new("padding", format!("{text:?} is not a distance"))
                    .hint("write a number of meters, as in 0.01")
            })
        };
        let mut padding = vec![0.0; robot.links().len()];
        // Paddings of single links replace the padding of all, in any order.
        for text in self.padding.iter().filter(|text| !text.contains('=')) {
            padding.fill(distance(text)?);
        }
        for (name, text) in self.padding.iter().filter_map(|text| text.split_once('=')) {
            let unknown = || Failure::new("name", format!("the robot has no link {name:?}")).at("--padding");
            padding[robot.link(name).ok_or_else(unknown)?] = distance(text)?;
        }
        let obstacles = loaded.scene.as_ref();
        Ok(CheckOptions { stop, obstacles, self_padding: self.self_padding, padding, ignored: Vec::new() })
    }
}

impl Loaded {
    pub(super) fn robot(&self) -> &Robot {
        &self.robot.robot
    }

    /// Returns the names of a pair.
    pub(super) fn names(&self, link: usize, other: Other) -> [String; 2] {
        let link_name = |link: usize| self.robot().links()[link].name.clone();
        let part_name = |part| self.scene.as_ref().map_or(String::new(), |scene| scene.name(part).to_owned());
        let other = match other {
            Other::Link(other) => link_name(other),
            Other::Obstacle(part) => part_name(part),
        };
        [link_name(link), other]
    }

    pub(super) fn names_of(&self, collision: &Collision) -> [String; 2] {
        self.names(collision.link, collision.other)
    }
}

/// Returns the failure for configurations that cannot be checked.
pub(super) fn failure(error: &CheckError) -> Failure {
    match error {
        CheckError::Configuration(ConfigurationError::NonFinite { row, coordinate }) => {
            Failure::new("non-finite", "a value is NaN or infinite").at(format!("row {row}, column {coordinate}"))
        }
        CheckError::Padding => Failure::new("padding", error.to_string()),
        CheckError::Stopped(_) => Failure::new("memory", error.to_string()),
        _ => Failure::new("configurations", error.to_string()),
    }
}
