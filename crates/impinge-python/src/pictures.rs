//! Pictures of two meshes, of scenes and of robots.

use impinge::query;
use impinge::robot::CheckOptions;
use impinge_report::picture::{self, Axis, Pair, PairView, Picture, RobotView, SceneView, pair, png};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{array, plain_column};
use crate::clash::{Part, scene_of};
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::model::unit_of;
use crate::robot::{RobotCore, invalid};
use crate::robot_checks::obstacles;
use crate::scene;
use crate::{poses, workers};

/// Options of a picture: its size in pixels, azimuth and elevation of the camera in degrees, and
/// the name of the axis that points up.
type View = ([u32; 2], [f64; 2], String);

/// Draws two meshes with their intersecting pairs of faces, (k, 2), and the curves in which they
/// intersect, or only their surroundings. Returns red, green and blue, (height, width, 3).
#[pyfunction]
pub(crate) fn picture_of_pair<'py>(
    py: Python<'py>,
    meshes: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    world_from_mesh: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    pairs: &Bound<'py, PyAny>,
    view: View,
    focus_on_contact: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (size, angles, up) = view;
    let (a, b) = (mesh_of(&meshes.0, "a")?, mesh_of(&meshes.1, "b")?);
    let pose = |value, name| poses::read_one(value, name, "must be one pose, (4, 4)");
    let world_from_mesh = [pose(&world_from_mesh.0, "pose_a")?, pose(&world_from_mesh.1, "pose_b")?];
    let pairs = plain_column::<u32>(pairs)?.as_chunks::<2>().0.to_vec();
    let picture = workers::run(py, move |_| {
        let curves = query::curves_of_pairs(a.at(world_from_mesh[0]), b.at(world_from_mesh[1]), &pairs);
        let shown = Pair { meshes: [&a, &b], world_from_mesh, pairs: &pairs, curves: &curves };
        pair(&shown, PairView { size, angles, up: axis(&up), focus_on_contact })
    })?;
    pixels(py, &picture)
}

/// Draws the parts of a scene. Returns red, green and blue, (height, width, 3).
#[pyfunction]
pub(crate) fn picture_of_scene<'py>(
    py: Python<'py>,
    parts: Vec<Part<'py>>,
    view: View,
    unit: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let (size, angles, up) = view;
    let view = SceneView { size, angles, up: axis(&up), unit: unit_of(py, unit)? };
    let scene = scene_of(py, parts)?;
    let picture = workers::run(py, move |_| picture::scene(&scene, view))?;
    pixels(py, &picture)
}

/// Returns the axis with a name, which Python validated.
pub(crate) fn axis(name: &str) -> Axis {
    [Axis::X, Axis::Y].into_iter().find(|axis| axis.name() == name).unwrap_or(Axis::Z)
}

/// Returns red, green and blue of a picture, (height, width, 3).
pub(crate) fn pixels<'py>(py: Python<'py>, picture: &Picture) -> PyResult<Bound<'py, PyAny>> {
    let [width, height] = picture.size().map(|side| side as usize);
    array(py, picture.pixels().as_flattened().to_vec(), &[height, width, 3])
}

/// Draws a robot in one configuration with obstacles. Returns red, green and blue, (height, width,
/// 3).
#[pyfunction]
pub(crate) fn picture_of_robot<'py>(
    robot: &RobotCore,
    q: &Bound<'py, PyAny>,
    parts: Vec<scene::Part<'py>>,
    view: View,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, loaded, (size, angles, up)) = (q.py(), robot.loaded().clone(), view);
    let values = plain_column::<f64>(q)?;
    loaded.robot.check_rows(&values).map_err(|error| invalid(&error).raised(py))?;
    let scene = obstacles(py, &parts)?;
    let view = RobotView { size, angles, up: axis(&up) };
    let picture = workers::run(py, move |_| {
        let options = CheckOptions { obstacles: Some(&scene), ..CheckOptions::default() };
        picture::robot(&loaded.robot, &values, &options, view)
    })?;
    pixels(py, &picture.map_err(|error| Fault::new("out-of-range", "q", error.to_string()).raised(py))?)
}

/// Returns red, green and blue, (height, width, 3), as a PNG file.
#[pyfunction]
pub(crate) fn to_png<'py>(py: Python<'py>, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
    let (height, width, _): (u32, u32, usize) = pixels.getattr("shape")?.extract()?;
    let bytes = plain_column::<u8>(pixels)?;
    let file = workers::run(py, move |_| png([width, height], &bytes))??;
    Ok(PyBytes::new(py, &file))
}
