//! Pictures of two meshes, and of robots.

use impinge::query;
use impinge::robot::CheckOptions;
use impinge_report::picture::{Axis, Pair, PairView, RobotView, pair, png, robot as draw_robot};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{array, plain_column};
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::robot::{RobotCore, invalid};
use crate::robot_checks::obstacles;
use crate::scene::Part;
use crate::{poses, workers};

/// Options of a picture of two meshes: its size in pixels, azimuth and elevation of the camera in
/// degrees, whether Y points up and not Z, and whether only the contact is shown.
type View = ([u32; 2], [f64; 2], bool, bool);

/// Draws two meshes with their intersecting pairs of faces, (k, 2), and the curves in which they
/// intersect. Returns red, green and blue, (height, width, 3).
#[pyfunction]
pub(crate) fn picture_of_pair<'py>(
    py: Python<'py>,
    meshes: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    world_from_mesh: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    pairs: &Bound<'py, PyAny>,
    view: View,
) -> PyResult<Bound<'py, PyAny>> {
    let (size, angles, is_y_up, focus_on_contact) = view;
    let (a, b) = (mesh_of(&meshes.0, "a")?, mesh_of(&meshes.1, "b")?);
    let pose = |value, name| poses::read_one(value, name, "must be one pose, (4, 4)");
    let world_from_mesh = [pose(&world_from_mesh.0, "pose_a")?, pose(&world_from_mesh.1, "pose_b")?];
    let pairs = plain_column::<u32>(pairs)?.as_chunks::<2>().0.to_vec();
    let up = if is_y_up { Axis::Y } else { Axis::Z };
    let picture = workers::run(py, move |_| {
        let curves = query::curves_of_pairs(a.at(world_from_mesh[0]), b.at(world_from_mesh[1]), &pairs);
        let shown = Pair { meshes: [&a, &b], world_from_mesh, pairs: &pairs, curves: &curves };
        pair(&shown, PairView { size, angles, up, focus_on_contact })
    })?;
    let [width, height] = picture.size().map(|side| side as usize);
    array(py, picture.pixels().as_flattened().to_vec(), &[height, width, 3])
}

/// Draws a robot in one configuration with obstacles. Returns red, green and blue, (height, width,
/// 3).
#[pyfunction]
pub(crate) fn picture_of_robot<'py>(
    robot: &RobotCore,
    q: &Bound<'py, PyAny>,
    parts: Vec<Part<'py>>,
    view: ([u32; 2], [f64; 2], bool),
) -> PyResult<Bound<'py, PyAny>> {
    let (py, loaded, (size, angles, is_y_up)) = (q.py(), robot.loaded().clone(), view);
    let values = plain_column::<f64>(q)?;
    loaded.robot.check_rows(&values).map_err(|error| invalid(&error).raised(py))?;
    let scene = obstacles(py, &parts)?;
    let view = RobotView { size, angles, up: if is_y_up { Axis::Y } else { Axis::Z } };
    let picture = workers::run(py, move |_| {
        let options = CheckOptions { obstacles: Some(&scene), ..CheckOptions::default() };
        draw_robot(&loaded.robot, &values, &options, view)
    })?;
    let picture = picture.map_err(|error| Fault::new("out-of-range", "q", error.to_string()).raised(py))?;
    let [width, height] = picture.size().map(|side| side as usize);
    array(py, picture.pixels().as_flattened().to_vec(), &[height, width, 3])
}

/// Returns red, green and blue, (height, width, 3), as a PNG file.
#[pyfunction]
pub(crate) fn to_png<'py>(py: Python<'py>, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
    let (height, width, _): (u32, u32, usize) = pixels.getattr("shape")?.extract()?;
    let bytes = plain_column::<u8>(pixels)?;
    let file = workers::run(py, move |_| png([width, height], &bytes))??;
    Ok(PyBytes::new(py, &file))
}
