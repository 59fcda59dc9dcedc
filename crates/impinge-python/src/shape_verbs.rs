//! The verbs on two shapes in rows of poses, and rays against one.

use impinge::query::shapes::{self, Proximity, ShapeDistance};
use impinge::shape::PlacedShape;
use impinge::sweep::{Impact, time_of_impact_of_shapes};
use impinge::world::{Body, World};
use impinge::{InputError, partition};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::broadcast::Broadcast;
use crate::contacts;
use crate::distances::{UNKNOWN_DEPTH, penetration_columns};
use crate::errors::{Fault, kind_and_place, message};
use crate::motions::{bounds, motions_of};
use crate::poses::{OnError, Poses};
use crate::question::{Answers, Progress};
use crate::rays::Rays;
use crate::shapes::{Weighed, weighed};
use crate::verbs::yes_or_no;
use crate::workers::{self, Rows};
use crate::world_bodies::refused;

/// The most pairs of pieces, over all rows, for which a call may keep to the caller's thread.
const MOST_BRIEF_PAIRS: u128 = 1 << 10;

/// The most rays times pieces, likewise.
const MOST_BRIEF_RAYS: u64 = 1 << 12;

/// The most poses that are judged on the caller's thread.
const MOST_BRIEF_POSES: usize = 64;

/// The value of `impinge.Status` for a pose that a round shape does not stand.
const NOT_RIGID: u8 = 6;

/// Two shapes and the rows of poses at which they are asked about.
pub(crate) struct Question {
    a: Placed,
    b: Placed,
    rows: Broadcast,
    on_error: OnError,
    progress: bool,
    weight: u128,
}

/// A shape at each of its poses.
struct Placed {
    /// None where the pose is bad.
    placed: Vec<Option<PlacedShape>>,
    status: Option<Vec<u8>>,
}

impl<'py> FromPyObject<'_, 'py> for Question {
    type Error = PyErr;

    /// Reads and judges `(a, b, pose_a, pose_b, on_error, progress)`.
    ///
    /// # Errors
    /// `InputError` naming the argument, and the row and entry in it.
    fn extract(asked: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        type Asked<'py> =
            (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Progress);
        let py = asked.py();
        let (a, b, pose_a, pose_b, on_error, Progress(progress)): Asked<'py> = asked.extract()?;
        let (a, b) = (weighed(&a, "a")?, weighed(&b, "b")?);
        let on_error = OnError::read(&on_error)?;
        let poses_a = Poses::read(&pose_a, "pose_a", on_error)?;
        let poses_b = Poses::read(&pose_b, "pose_b", on_error)?;
        let rows = Broadcast::of(py, (&poses_a.shape, "pose_a"), (&poses_b.shape, "pose_b"))?;
        let weight = u128::from(a.weight.max(1)) * u128::from(b.weight.max(1)) * rows.rows as u128;
        let a = Placed::new(py, a, poses_a, "pose_a", on_error)?;
        let b = Placed::new(py, b, poses_b, "pose_b", on_error)?;
        Ok(Self { a, b, rows, on_error, progress, weight })
    }
}

impl Placed {
    fn new(py: Python<'_>, shape: Weighed, poses: Poses, name: &str, on_error: OnError) -> PyResult<Self> {
        let Poses { shape: lead, poses, mut status } = poses;
        let count = poses.len();
        let asked = Rows { count, brief: count <= MOST_BRIEF_POSES, progress: false };
        let none: Option<Result<PlacedShape, InputError>> = None;
        let made = workers::rows(py, asked, none, || (), move |(), row| Some(shape.shape.at(poses[row])))?;
        let mut placed = Vec::with_capacity(count);
        for (row, made) in made.into_iter().enumerate() {
            let is_bad = status.as_ref().is_some_and(|status| status[row] != 0);
            placed.push(match made {
                _ if is_bad => None,
                Some(Ok(made)) => Some(made),
                Some(Err(error)) if on_error == OnError::Raise => {
                    let (kind, at) = (kind_and_place(&error).0, Broadcast::place(&lead, row));
                    let hint = "round shapes want a rotation and a translation, within 1e-4";
                    let hint = if kind == "not-rigid" { Some(hint) } else { error.hint() };
                    return Err(Fault::new(kind, name, message(&error)).at(at).hint(hint).raised(py));
                }
                Some(Err(_)) | None => {
                    status.get_or_insert_with(|| vec![0; count])[row] = NOT_RIGID;
                    None
                }
            });
        }
        Ok(Self { placed, status })
    }
}

impl Question {
    /// Asks `ask` about each row, on all threads and without the interpreter; a row with a bad pose gets `safe`.
    fn answer<T: Clone + Send + Sync + 'static>(
        self,
        py: Python<'_>,
        safe: T,
        ask: impl Fn(&PlacedShape, &PlacedShape) -> T + Send + Sync + 'static,
    ) -> PyResult<Answers<T>> {
        let Self { a, b, rows, on_error, progress, weight } = self;
        let (count, shape) = (rows.rows, rows.shape.clone());
        let status = (on_error == OnError::Status).then(|| {
            let of = |placed: &Placed, at: usize| placed.status.as_ref().map_or(0, |status| status[at]);
            let both = |row| {
                let [at_a, at_b] = rows.sources(row);
                Some(of(&a, at_a)).filter(|&own| own != 0).unwrap_or_else(|| of(&b, at_b))
            };
            (0..count).map(both).collect::<Vec<u8>>()
        });
        let asked = Rows { count, brief: weight <= MOST_BRIEF_PAIRS, progress };
        let safely = safe.clone();
        let values = workers::rows(
            py,
            asked,
            safe,
            || (),
            move |(), row| {
                let [at_a, at_b] = rows.sources(row);
                match (&a.placed[at_a], &b.placed[at_b]) {
                    (Some(a), Some(b)) => ask(a, b),
                    _ => safely.clone(),
                }
            },
        )?;
        Ok(Answers::new(shape, values, status))
    }
}

/// `bool`, or an array of them; what is undecided counts as yes.
#[pyfunction]
pub(crate) fn shapes_intersect(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    let answers = question.answer(py, Proximity::Meets, shapes::proximity)?;
    yes_or_no(py, answers.judged(|&found| found == Proximity::Undecided, |found| found != Proximity::Apart))
}

/// `bool`, or an array of them; what is undecided counts as yes.
#[pyfunction]
pub(crate) fn shapes_within(py: Python<'_>, question: Question, clearance: f64) -> PyResult<Bound<'_, PyAny>> {
    let answers = question.answer(py, Proximity::Meets, move |a, b| shapes::nearness(a, b, clearance))?;
    yes_or_no(py, answers.judged(|&found| found == Proximity::Undecided, |found| found != Proximity::Apart))
}

/// Five columns: distance, lower and upper bound, (...), and points of a and of b, (..., 3), which are zero where there are
/// none.
#[pyfunction]
pub(crate) fn shape_distance(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    const SAFE: ShapeDistance =
        ShapeDistance { lower: 0.0, upper: 0.0, point_a: [0.0; 3], point_b: [0.0; 3], proximity: Proximity::Undecided };
    let answers = question.answer(py, SAFE, shapes::distance)?;
    let answers = answers.judged(|found| found.proximity == Proximity::Undecided, |found| found);
    answers.returned(py, |values, shape| {
        let numbers = |of: fn(&ShapeDistance) -> f64| array(py, values.iter().map(of).collect(), shape);
        let points = |of: fn(&ShapeDistance) -> [f64; 3]| row_array(py, values.iter().map(of).collect(), shape);
        let columns = (
            numbers(ShapeDistance::distance)?,
            numbers(|found| found.lower)?,
            numbers(|found| found.upper)?,
            points(|found| found.point_a)?,
            points(|found| found.point_b)?,
        );
        Ok(columns.into_pyobject(py)?.into_any())
    })
}

/// What `penetration_columns` makes of two shapes.
#[pyfunction]
pub(crate) fn shape_penetration(py: Python<'_>, question: Question) -> PyResult<Bound<'_, PyAny>> {
    let is_told = question.on_error == OnError::Status;
    let answers = question.answer(py, (Some(UNKNOWN_DEPTH), false), move |a, b| {
        let found = shapes::penetration(a, b);
        // Shapes that are deep in each other meet for certain.
        let may_touch = is_told && found.is_some_and(|found| found.lower == 0.0);
        (found, may_touch && shapes::proximity(a, b) == Proximity::Undecided)
    })?;
    penetration_columns(py, answers.judged(|found| found.1, |found| found.0))
}

/// The leading axes, and the columns of `contacts::columns`.
#[pyfunction]
pub(crate) fn shape_contacts(
    py: Python<'_>,
    question: Question,
    margin: f64,
    most_points: usize,
) -> PyResult<Bound<'_, PyAny>> {
    let options = shapes::ContactOptions { margin, most_points };
    let is_told = question.on_error == OnError::Status;
    let answers = question.answer(py, (Vec::new(), false), move |a, b| {
        let found = shapes::contacts_with(a, b, &options);
        let is_open = is_told && !found.is_empty() && shapes::nearness(a, b, margin) == Proximity::Undecided;
        (found, is_open)
    })?;
    let answers = answers.judged(|found| found.1, |found| found.0);
    answers.returned(py, |values, shape| {
        let columns = contacts::columns(py, values.iter().map(Vec::as_slice))?;
        Ok((shape, columns).into_pyobject(py)?.into_any())
    })
}

/// The shapes a and b, their motions, and whether to show how far the call is.
type Moving<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Progress);

/// The two bounds of the time, in two arrays.
#[pyfunction]
pub(crate) fn shape_time_of_impact<'py>(py: Python<'py>, moving: Moving<'py>) -> PyResult<Bound<'py, PyAny>> {
    let (a, b, motion_a, motion_b, Progress(progress)) = moving;
    let (a, b) = (weighed(&a, "a")?.shape, weighed(&b, "b")?.shape);
    let (shape_a, motions_a) = motions_of(&motion_a, "motion_a")?;
    let (shape_b, motions_b) = motions_of(&motion_b, "motion_b")?;
    let rows = Broadcast::of(py, (&shape_a, "motion_a"), (&shape_b, "motion_b"))?;
    // Only where a motion starts may its pose be none for a round shape: it goes on rigidly.
    for (shape, motions, lead, name) in [(&a, &motions_a, &shape_a, "motion_a"), (&b, &motions_b, &shape_b, "motion_b")]
    {
        for (row, motion) in motions.iter().enumerate() {
            shape.at(motion.at(0.0)).map_err(|error| {
                Fault::new(kind_and_place(&error).0, name, message(&error)).at(Broadcast::place(lead, row)).raised(py)
            })?;
        }
    }
    let shape = rows.shape.clone();
    let asked = Rows { count: rows.rows, brief: false, progress };
    let safe: Result<Impact, InputError> = Ok(Impact { t_lower: 0.0, t_upper: f64::INFINITY });
    let impacts = workers::rows(
        py,
        asked,
        safe,
        || (),
        move |(), row| {
            let [at_a, at_b] = rows.sources(row);
            time_of_impact_of_shapes(&a, &b, &motions_a[at_a], &motions_b[at_b])
        },
    )?;
    let impacts: Result<Vec<Impact>, InputError> = impacts.into_iter().collect();
    let impacts =
        impacts.map_err(|error| Fault::new(kind_and_place(&error).0, "motion", message(&error)).raised(py))?;
    bounds(py, &impacts, &shape)
}

/// Whether each ray meets the shape, where, (...), on which face of a mesh, (...), and in which point, (..., 3).
#[pyfunction]
pub(crate) fn shape_ray_cast<'py>(
    shape: &Bound<'py, PyAny>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, rays) = (shape.py(), Rays::read(origins, directions)?);
    let Weighed { shape, weight } = weighed(shape, "shape")?;
    let mut world = World::new();
    world.insert(Body::new(shape)).map_err(|error| refused(&error, "shape", 0).at(Vec::new()).raised(py))?;
    let (lead, brief) = (rays.lead().to_vec(), weight.saturating_mul(rays.len() as u64) <= MOST_BRIEF_RAYS);
    let found = rays.ask_each(py, brief, None, move |origin, direction| {
        Ok(world.ray_cast(&partition::Ray::new(origin, direction, f64::INFINITY)?, |_| true))
    })?;
    let columns = (
        array(py, found.iter().map(Option::is_some).collect(), &lead)?,
        array(py, found.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect(), &lead)?,
        array(py, found.iter().map(|hit| hit.and_then(|hit| hit.face).map_or(-1, i64::from)).collect(), &lead)?,
        row_array(py, found.iter().map(|hit| hit.map_or([0.0; 3], |hit| hit.point)).collect(), &lead)?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}
