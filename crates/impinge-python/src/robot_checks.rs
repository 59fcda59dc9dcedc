//! Robots of parts, and checks of many configurations.

use impinge::Pose;
use impinge::query::batch::{Answers, Execution};
use impinge::robot::{CheckError, CheckOptions, Collision, Joint, JointKind, Link, Mimic, Other, Robot};
use impinge::scene::{PartId, Scene, SceneError, Stop};
use impinge_files::LoadedRobot;
use pyo3::prelude::*;

use crate::arrays::{array, plain_column, ragged, row_array};
use crate::errors::Fault;
use crate::poses;
use crate::question::Progress;
use crate::robot::{RobotCore, invalid};
use crate::scene::Part;
use crate::shapes::read_shape;
use crate::workers::{self, Call};

/// A joint as Python passes it: name, kind, parent, child, origin, axis, limits and mimic.
type JointRow<'py> =
    (String, String, String, String, Bound<'py, PyAny>, [f64; 3], Option<[f64; 2]>, Option<(String, f64, f64)>);

/// Makes a robot of names of links with their shapes, joints, and pairs of indices of links that
/// are not checked.
#[pyfunction]
pub(crate) fn robot_of_parts(
    py: Python<'_>,
    links: Vec<(String, Option<Bound<'_, PyAny>>)>,
    joints: Vec<JointRow<'_>>,
    ignored: Vec<(usize, usize)>,
) -> PyResult<RobotCore> {
    let shape = |thing: &Bound<'_, PyAny>| read_shape(thing, "links", true).map(|weighed| weighed.shape);
    let link = |(name, thing): &(String, Option<Bound<'_, PyAny>>)| {
        Ok(Link { name: name.clone(), shape: thing.as_ref().map(shape).transpose()? })
    };
    let links = links.iter().map(link).collect::<PyResult<_>>()?;
    let joints = joints.into_iter().map(joint).collect::<PyResult<_>>()?;
    let robot = Robot::new(links, joints);
    let mut robot = robot.map_err(|error| Fault::new("robot", "joints", error.to_string()).raised(py))?;
    robot.choose(ignored.into_iter().map(|(a, b)| ([a, b], Some(String::new()))));
    let (name, groups, states, warnings) = (String::new(), Vec::new(), Vec::new(), Vec::new());
    Ok(RobotCore::from(LoadedRobot { robot, name, groups, states, warnings }))
}

/// Returns the robot with an object attached to a link, given by its index, at a pose, and the
/// indices of links that it may touch.
#[pyfunction]
pub(crate) fn robot_attached(
    robot: &RobotCore,
    name: String,
    shape: &Bound<'_, PyAny>,
    link: usize,
    pose: &Bound<'_, PyAny>,
    touch: Vec<usize>,
) -> PyResult<RobotCore> {
    let py = shape.py();
    let shape = read_shape(shape, "shape", true)?.shape;
    let pose = if pose.is_none() { Pose::IDENTITY } else { poses::read_one(pose, "pose", "one pose, (4, 4)")? };
    let holding = robot.loaded().robot.attached(name, shape, link, pose, &touch);
    let holding = holding.map_err(|error| Fault::new("robot", "attached", error.to_string()).raised(py))?;
    Ok(RobotCore::from(LoadedRobot { robot: holding, ..LoadedRobot::clone(robot.loaded()) }))
}

/// Returns the collisions in each configuration: the offsets of the configurations, (n + 1,);
/// for each collision the index of the link and of what it collides with, (k, 2), where the
/// parts of the scene follow the links; and whether it is undecided, (k,).
#[pyfunction]
pub(crate) fn robot_check<'py>(
    robot: &RobotCore,
    q: &Bound<'py, PyAny>,
    first: bool,
    paddings: (f64, Vec<f64>),
    parts: Vec<Part<'py>>,
    ignored: Vec<(usize, usize)>,
    progress: Progress,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let (py, loaded, Progress(progress)) = (q.py(), robot.loaded().clone(), progress);
    let (self_padding, padding) = paddings;
    let values = plain_column::<f64>(q)?;
    let rows = loaded.robot.check_rows(&values).map_err(|error| invalid(&error).raised(py))?;
    let scene = obstacles(py, &parts)?;
    let ids: Vec<PartId> = scene.parts().collect();
    let ignored = ignored.into_iter().map(|(link, part)| (link, ids[part])).collect::<Vec<_>>();
    let stop = if first { Stop::First } else { Stop::All };
    let links = loaded.robot.links().len();
    let work = move |execution: Execution<'_>| {
        let (padding, ignored) = (padding.clone(), ignored.clone());
        let options = CheckOptions { stop, obstacles: Some(&scene), self_padding, padding, ignored };
        match loaded.robot.check(&values, &options, execution) {
            Err(CheckError::Stopped(stopped)) => Err(stopped),
            found => Ok(found),
        }
    };
    let (found, _) = workers::execute(py, Call { rows, is_brief: false, progress }, work)?;
    let Answers { values, .. }: Answers<Vec<Collision>> =
        found.map_err(|error| Fault::new("out-of-range", "padding", error.to_string()).raised(py))?;
    let other = |other: Other| match other {
        Other::Link(link) => link,
        Other::Obstacle(part) => links + part.index(),
    };
    let (offsets, found) = ragged(values);
    let pairs: Vec<[u32; 2]> = found.iter().map(|c| [c.link as u32, other(c.other) as u32]).collect();
    let undecided: Vec<bool> = found.iter().map(|collision| collision.is_undecided).collect();
    let (places, count) = (offsets.len(), pairs.len());
    Ok((array(py, offsets, &[places])?, row_array(py, pairs, &[count])?, array(py, undecided, &[count])?))
}

/// Returns the scene of some obstacles, each with one pose.
pub(crate) fn obstacles(py: Python<'_>, parts: &[Part<'_>]) -> PyResult<Scene> {
    let mut scene = Scene::new();
    for (name, thing, is_solid, given) in parts {
        let argument = format!("poses[{name:?}]");
        let pose = if given.is_none() {
            Pose::IDENTITY
        } else {
            poses::read_one(given, &argument, "an obstacle has one pose, (4, 4)")?
        };
        let added = scene.add(name.clone(), &read_shape(thing, name, *is_solid)?.shape, pose);
        added.map_err(|error| match error {
            SceneError::Pose { error, .. } => poses::fault(&error, &argument, Vec::new()).raised(py),
            _ => Fault::new("name", "scene", error.to_string()).raised(py),
        })?;
    }
    Ok(scene)
}

fn joint(row: JointRow<'_>) -> PyResult<Joint> {
    let (name, kind, parent, child, origin, axis, limits, mimic) = row;
    let kind = match &kind[..] {
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        "planar" => JointKind::Planar,
        "floating" => JointKind::Floating,
        _ => JointKind::Fixed,
    };
    let argument = format!("the origin of the joint {name:?}");
    let pose = if origin.is_none() { Pose::IDENTITY } else { poses::read_one(&origin, &argument, "one pose, (4, 4)")? };
    let joint = Joint::fixed(name, parent, child, pose).moving(kind, axis);
    let mimic = mimic.map(|(joint, multiplier, offset)| Mimic { joint, multiplier, offset });
    Ok(Joint { limits, mimic, ..joint })
}
