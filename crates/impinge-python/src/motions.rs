//! Motions of bodies, and when the bodies first touch.

use impinge::budget::Stopped;
use impinge::query::batch::{Broadcast, Execution};
use impinge::sweep::{self, Impact, Motion, Sweep, Touch};
use impinge::{InputError, Pose};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::errors::{Fault, kind_and_place, message};
use crate::points::Points;
use crate::poses;
use crate::question::{Progress, SolidOption};
use crate::shapes::read_shape;
use crate::workers::{self, Call};

/// Exponent of the magnitude below which numbers of a pose must be, 2^300.
const EXPONENT: i32 = 300;

/// Maximum number of motions of single features that run on the caller's thread.
const MAX_FEATURES_ON_CALLER: usize = 256;

/// Base class of `impinge.Motion`: validated motions with their leading axes.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct MotionBase {
    shape: Vec<usize>,
    motions: Vec<Motion>,
}

/// Linear velocity, angular velocity, and the pivot or `None`.
type Screw<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

#[pymethods]
impl MotionBase {
    /// Makes motions to another pose or by a screw. All arrays have the same leading axes.
    #[new]
    fn new(pose_t0: &Bound<'_, PyAny>, pose_t1: &Bound<'_, PyAny>, screw: Option<Screw<'_>>) -> PyResult<Self> {
        let (shape, from) = poses::read_all(pose_t0, "pose_t0")?;
        let made: Vec<Result<Motion, InputError>> = if let Some((linear, angular, pivot)) = screw {
            let linear = Points::read(&linear, "linear", EXPONENT)?.rows;
            let angular = Points::read(&angular, "angular", EXPONENT)?.rows;
            let pivots = if pivot.is_none() { None } else { Some(Points::read(&pivot, "pivot", EXPONENT)?.rows) };
            let velocities = linear.into_iter().zip(angular).enumerate();
            let screws = from.iter().zip(velocities);
            screws
                .map(|(&pose, (row, (linear, angular)))| {
                    let pivot = pivots.as_ref().map(|pivots| pivots[row]);
                    Motion::screw(pose, linear, angular, pivot)
                })
                .collect()
        } else {
            let (_, to) = poses::read_all(pose_t1, "pose_t1")?;
            from.iter().zip(to).map(|(&from, to)| Motion::between(from, to)).collect()
        };
        let mut motions = Vec::with_capacity(made.len());
        for (row, motion) in made.into_iter().enumerate() {
            motions.push(motion.map_err(|error| {
                let at = Broadcast::place(&shape, row);
                Fault::new(kind_and_place(&error).0, "motion", message(&error))
                    .at(at)
                    .hint(error.hint())
                    .raised(pose_t0.py())
            })?);
        }
        Ok(Self { shape, motions })
    }

    #[getter]
    fn shape(&self) -> Vec<usize> {
        self.shape.clone()
    }

    /// Returns the poses of all motions at one time from 0 to 1, (..., 4, 4).
    fn poses_at<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyAny>> {
        let matrices = self.motions.iter().flat_map(|motion| matrix(&motion.at(t))).collect();
        array(py, matrices, &[&self.shape[..], &[4, 4]].concat())
    }
}

/// Returns the entries of a pose's 4 x 4 matrix, row by row.
pub(crate) fn matrix(pose: &Pose) -> [f64; 16] {
    let mut numbers = [0.0; 16];
    for row in 0..3 {
        numbers[4 * row..4 * row + 3].copy_from_slice(&pose.linear()[row]);
        numbers[4 * row + 3] = pose.translation()[row];
    }
    numbers[15] = 1.0;
    numbers
}

/// Returns the motions of an argument. `None` is a body at rest with the identity as its pose.
pub(crate) fn motions_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, Vec<Motion>)> {
    if value.is_none() {
        return Ok((Vec::new(), vec![Motion::default()]));
    }
    match value.cast::<MotionBase>() {
        Ok(base) => Ok((base.get().shape.clone(), base.get().motions.clone())),
        Err(_) => {
            let message = format!("must be an impinge.Motion, not {}", value.get_type().qualname()?);
            let hint = Some("impinge.Motion(pose_t0, pose_t1), or impinge.Motion.screw(...)");
            Err(Fault::new("type", name, message).hint(hint).raised(value.py()))
        }
    }
}

/// Arguments: the things a and b, their motions, which of them is solid if it is a mesh, and
/// whether to show the progress.
type Moving<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, SolidOption, Progress);

/// Returns the lower and the upper bound of each time of impact, from 0 at the start to 1 at the
/// end, then the point, the normal, the parts and the faces of the first touch, as six arrays. Both
/// bounds are infinite without contact. A part or a face of -1, and NaN, stand for a missing one.
#[pyfunction]
pub(crate) fn time_of_impact<'py>(
    py: Python<'py>,
    moving: Moving<'py>,
    clearance: f64,
    ignore_touch: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (a, b, motion_a, motion_b, SolidOption(is_solid), Progress(progress)) = moving;
    let (a, b) = (read_shape(&a, "a", is_solid[0])?.shape, read_shape(&b, "b", is_solid[1])?.shape);
    let (shape_a, motions_a) = motions_of(&motion_a, "motion_a")?;
    let (shape_b, motions_b) = motions_of(&motion_b, "motion_b")?;
    let broadcast = poses::broadcast(py, (&shape_a, "motion_a"), (&shape_b, "motion_b"))?;
    // Only the first pose of a motion can be invalid for a round shape: the motion itself is rigid.
    for (shape, motions, lead, name) in [(&a, &motions_a, &shape_a, "motion_a"), (&b, &motions_b, &shape_b, "motion_b")]
    {
        // A mesh accepts any motion.
        let refusing = if shape.as_mesh().is_none() { motions.as_slice() } else { &[] };
        for (row, motion) in refusing.iter().enumerate() {
            shape.at(motion.at(0.0)).map_err(|error| {
                Fault::new(kind_and_place(&error).0, name, message(&error)).at(Broadcast::place(lead, row)).raised(py)
            })?;
        }
    }
    let shape = broadcast.shape().to_vec();
    let call = Call { rows: broadcast.rows(), is_brief: false, progress };
    let (impacts, _) = workers::execute(py, call, move |execution: Execution<'_>| -> Result<_, Stopped> {
        let sweep = Sweep::new().with_clearance(clearance);
        let sweep = if ignore_touch { sweep.ignoring_touch() } else { sweep };
        sweep.times_of_impact(&a, &b, [&motions_a, &motions_b], &broadcast, execution)
    })?;
    let impacts: Result<Vec<Impact>, InputError> = impacts.into_iter().collect();
    let impacts =
        impacts.map_err(|error| Fault::new(kind_and_place(&error).0, "motion", message(&error)).raised(py))?;
    places(py, &impacts, &shape)
}

/// Returns the two bounds of each time, then the point, the normal, the parts and the faces of each
/// first touch: NaN and -1 for an impact without one.
pub(crate) fn places<'py>(py: Python<'py>, impacts: &[Impact], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let vectors = |of: fn(&Touch) -> [f64; 3]| {
        let rows = impacts.iter().map(|impact| impact.touch.as_ref().map_or([f64::NAN; 3], of));
        row_array(py, rows.collect(), shape)
    };
    let numbers = |of: fn(&Touch) -> [Option<u32>; 2]| {
        let rows = impacts.iter().map(|impact| impact.touch.as_ref().map_or([None; 2], of));
        row_array(py, rows.map(|row| row.map(|number| number.map_or(-1, i64::from))).collect(), shape)
    };
    let (lower, upper) =
        (times(py, impacts, shape, |impact| impact.t_lower)?, times(py, impacts, shape, |impact| impact.t_upper)?);
    let answer = (
        lower,
        upper,
        vectors(|touch| touch.point)?,
        vectors(|touch| touch.normal)?,
        numbers(|touch| touch.parts.map(Some))?,
        numbers(|touch| touch.faces)?,
    );
    Ok(answer.into_pyobject(py)?.into_any())
}

fn times<'py>(
    py: Python<'py>,
    impacts: &[Impact],
    shape: &[usize],
    of: fn(&Impact) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    array(py, impacts.iter().map(of).collect(), shape)
}

/// Time of impact about which nothing is proved.
const SAFE: Impact = Impact { t_lower: 0.0, t_upper: f64::INFINITY, touch: None };

/// Returns the lower and the upper bound of each time, as two arrays.
pub(crate) fn bounds<'py>(py: Python<'py>, impacts: &[Impact], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let (lower, upper) =
        (times(py, impacts, shape, |impact| impact.t_lower)?, times(py, impacts, shape, |impact| impact.t_upper)?);
    Ok((lower, upper).into_pyobject(py)?.into_any())
}

/// Returns the two bounds of the time at which a vertex and a face first touch. Arguments are their
/// four corners at both ends of a linear motion, (..., 4, 3).
#[pyfunction]
pub(crate) fn vertex_face<'py>(t0: &Bound<'py, PyAny>, t1: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    features(t0, t1, sweep::vertex_face)
}

/// Returns the two bounds of the time at which two edges first touch. Arguments are their four ends
/// at both ends of a linear motion, (..., 4, 3).
#[pyfunction]
pub(crate) fn edge_edge<'py>(t0: &Bound<'py, PyAny>, t1: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    features(t0, t1, sweep::edge_edge)
}

type Corners = [[f64; 3]; 4];

fn features<'py>(
    t0: &Bound<'py, PyAny>,
    t1: &Bound<'py, PyAny>,
    ask: fn(&Corners, &Corners) -> Result<Impact, InputError>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = t0.py();
    let (shape_t0, corners_t0) = corners(t0, "t0")?;
    let (shape_t1, corners_t1) = corners(t1, "t1")?;
    let broadcast = poses::broadcast(py, (&shape_t0, "t0"), (&shape_t1, "t1"))?;
    let shape = broadcast.shape().to_vec();
    let rows = broadcast.rows();
    let call = Call { rows, is_brief: rows <= MAX_FEATURES_ON_CALLER, progress: false };
    let impacts = workers::rows(py, call, move |row| {
        let [at_t0, at_t1] = broadcast.sources(row);
        // The corners were validated when they were read.
        ask(&corners_t0[at_t0], &corners_t1[at_t1]).unwrap_or(SAFE)
    })?;
    bounds(py, &impacts, &shape)
}

/// Returns rows of four corners with their leading axes.
fn corners(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, Vec<Corners>)> {
    /// Exponent of the magnitude below which the proofs hold, 2^128.
    const EXPONENT: i32 = 128;
    let Points { mut shape, rows } = Points::read(value, name, EXPONENT)?;
    if shape.pop() != Some(4) {
        let message = "four corners are expected, (4, 3) or (..., 4, 3): a vertex and a face, or two edges";
        return Err(Fault::new("shape", name, message).raised(value.py()));
    }
    Ok((shape, rows.as_chunks::<4>().0.to_vec()))
}
