//! Many parts at once: every configuration of an assembly.

use impinge::Pose;
use impinge::budget::Stopped;
use impinge::query::batch::{Answers, Broadcast, Execution, Poses};
use impinge::scene::{Configurations, ConfigurationsError, FoundPair, PartId, Question, Scene, Stop};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::arrays::{array, ragged, row_array};
use crate::errors::Fault;
use crate::poses;
use crate::question::{Progress, wants_status, with_status};
use crate::shapes::read_shape;
use crate::workers::{self, Call};

/// A part as Python passes it: its name, its mesh or shape, whether a mesh is solid, and its poses.
pub(crate) type Part<'py> = (String, Bound<'py, PyAny>, bool, Bound<'py, PyAny>);

/// A scene, and the poses of its parts.
pub(crate) struct MovedScene {
    pub(crate) scene: Scene,
    pub(crate) moves: Vec<(PartId, Poses)>,
}

/// Pairs of indices of parts that are ignored, (k, 2).
pub(crate) struct Ignored<'py>(PyReadonlyArray2<'py, u32>);

/// Question about each pair of parts: its name and a clearance in world units.
pub(crate) struct QuestionOption(pub(crate) Question);

impl MovedScene {
    /// Reads the parts and their poses, and the pairs of indices of parts that are ignored.
    ///
    /// # Errors
    /// `InputError` if a part is not a mesh or shape, or if its poses are not an array of matrices.
    pub(crate) fn read(py: Python<'_>, parts: &[Part<'_>], ignored: Option<&Ignored<'_>>) -> PyResult<Self> {
        let mut scene = Scene::new();
        let mut moves = Vec::with_capacity(parts.len());
        for (name, thing, is_solid, given) in parts {
            let part = scene.add(name.clone(), &read_shape(thing, name, *is_solid)?.shape, Pose::IDENTITY);
            let part = part.map_err(|error| Fault::new("name", "parts", error.to_string()).raised(py))?;
            moves.push((part, poses::read(given, &argument(name))?));
        }
        ignored.map_or(Ok(()), |ignored| ignored.apply(&mut scene))?;
        Ok(Self { scene, moves })
    }
}

impl Ignored<'_> {
    /// Excludes the pairs from the checks of a scene.
    pub(crate) fn apply(&self, scene: &mut Scene) -> PyResult<()> {
        let ids: Vec<PartId> = scene.parts().collect();
        for [a, b] in self.0.as_slice()?.as_chunks().0 {
            scene.ignore(ids[*a as usize], ids[*b as usize]);
        }
        Ok(())
    }
}

impl<'py> FromPyObject<'_, 'py> for Ignored<'py> {
    type Error = PyErr;

    fn extract(pairs: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(pairs.extract()?))
    }
}

impl<'py> FromPyObject<'_, 'py> for QuestionOption {
    type Error = PyErr;

    fn extract(option: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (name, clearance): (String, f64) = option.extract()?;
        Ok(Self(match &name[..] {
            "penetrates" => Question::Penetrates,
            "within" => Question::Within(clearance),
            _ => Question::Intersects,
        }))
    }
}

/// Returns the configurations of a scene. The poses fit, as [`check_poses`] has found.
pub(crate) fn configurations<'s>(scene: &'s Scene, moves: &[(PartId, Poses)]) -> Configurations<'s> {
    let mut configurations = scene.configurations();
    for (part, poses) in moves {
        _ = configurations.set(*part, poses.clone());
    }
    configurations
}

/// Returns for each configuration the pairs of parts that intersect, penetrate or come within a
/// clearance in world units. Pairs of indices into `parts` that are `ignored` are skipped.
///
/// The result is the leading axes, the offsets of the configurations, (n + 1,), and the pairs of
/// indices of all configurations, (k, 2).
#[pyfunction]
pub(crate) fn check_scene<'py>(
    py: Python<'py>,
    parts: Vec<Part<'py>>,
    ignored: Ignored<'py>,
    question: QuestionOption,
    first: bool,
    on_error: &Bound<'py, PyAny>,
    progress: Progress,
) -> PyResult<Bound<'py, PyAny>> {
    let (wants_status, Progress(progress)) = (wants_status(on_error)?, progress);
    let QuestionOption(question) = question;
    let MovedScene { scene, moves } = MovedScene::read(py, &parts, Some(&ignored))?;
    let rows = check_poses(py, &scene, &moves, wants_status)?;
    let stop = if first { Stop::First } else { Stop::All };
    let call = Call { rows, is_brief: false, progress };
    let work = move |execution: Execution<'_>| -> Result<Answers<Vec<FoundPair>>, Stopped> {
        scene.check(question, stop, &configurations(&scene, &moves), execution)
    };
    let (Answers { shape, values, status }, _) = workers::execute(py, call, work)?;
    let numbers = |pair: &FoundPair| pair.parts.map(|part| part.index() as u32);
    let (offsets, pairs) = ragged(values.iter().map(|pairs| pairs.iter().map(numbers).collect()).collect());
    let (places, count) = (offsets.len(), pairs.len());
    let answer = (&shape[..], array(py, offsets, &[places])?, row_array(py, pairs, &[count])?);
    with_status(py, answer.into_pyobject(py)?.into_any(), wants_status.then_some(status), &shape)
}

/// Returns the name of the argument with the poses of a part.
fn argument(name: &str) -> String {
    format!("poses[{name:?}]")
}

/// Returns the number of configurations, after it checks the poses.
///
/// # Errors
/// `InputError` if leading axes do not broadcast, or if a pose is invalid and the caller does not
/// want a status.
pub(crate) fn check_poses(
    py: Python<'_>,
    scene: &Scene,
    moves: &[(PartId, Poses)],
    wants_status: bool,
) -> PyResult<usize> {
    let mut shape = Vec::new();
    let mut configurations = scene.configurations();
    for (part, poses) in moves {
        let name = argument(scene.name(*part));
        let common = Broadcast::new(&shape, poses.shape()).map_err(|_| {
            let message =
                format!("leading axes {:?} do not broadcast with {shape:?}, those of the other parts", poses.shape());
            Fault::new("shape", &name, message).raised(py)
        })?;
        shape = common.shape().to_vec();
        let refused = |error: ConfigurationsError| PyMemoryError::new_err(error.to_string());
        configurations.set(*part, poses.clone()).map_err(refused)?;
    }
    match configurations.first_fault() {
        Some((part, row, error)) if !wants_status => {
            let (_, poses) = &moves[part.index()];
            Err(poses::fault(error, &argument(scene.name(part)), Broadcast::place(poses.shape(), row)).raised(py))
        }
        _ => Ok(configurations.rows()),
    }
}
