//! Many parts at once: every configuration of an assembly.

use impinge::Pose;
use impinge::query::batch::{Answers, Broadcast, Execution, Poses, Stopped};
use impinge::scene::{ConfigurationsError, FoundPair, PartId, Question, Scene, Stop};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::arrays::{array, ragged, row_array};
use crate::errors::Fault;
use crate::poses;
use crate::question::{Progress, tells_status, with_status};
use crate::shapes::weighed;
use crate::workers::{self, Call};

/// A part as Python names it: its name, its mesh or shape, whether a mesh is solid, and its poses.
type Part<'py> = (String, Bound<'py, PyAny>, bool, Bound<'py, PyAny>);

/// Asks of each configuration which pairs of parts intersect, penetrate or come within a clearance; pairs of places in `parts` that
/// are `ignored` are not asked about.
///
/// The leading axes, the offsets of each configuration, (n + 1,), and the pairs of places of all, (k, 2).
#[pyfunction]
pub(crate) fn check_scene<'py>(
    py: Python<'py>,
    parts: Vec<Part<'py>>,
    ignored: Vec<(usize, usize)>,
    question: (String, f64),
    first: bool,
    on_error: &Bound<'py, PyAny>,
    progress: Progress,
) -> PyResult<Bound<'py, PyAny>> {
    let (tells_status, Progress(progress)) = (tells_status(on_error)?, progress);
    let question = match (&question.0[..], question.1) {
        ("penetrates", _) => Question::Penetrates,
        ("within", clearance) => Question::Within(clearance),
        _ => Question::Intersects,
    };
    let mut scene = Scene::new();
    let mut moves = Vec::with_capacity(parts.len());
    for (name, thing, is_solid, given) in &parts {
        let part = scene.add(name.clone(), &weighed(thing, name, *is_solid)?.shape, Pose::IDENTITY);
        let part = part.map_err(|error| Fault::new("name", "parts", error.to_string()).raised(py))?;
        moves.push((part, poses::read(given, &argument(name))?));
    }
    let ids: Vec<PartId> = scene.parts().collect();
    for (a, b) in ignored {
        scene.ignore(ids[a], ids[b]);
    }
    let rows = judge(py, &scene, &moves, tells_status)?;
    let stop = if first { Stop::First } else { Stop::All };
    let call = Call { rows, is_brief: false, progress };
    let work = move |execution: Execution<'_>| -> Result<Answers<Vec<FoundPair>>, Stopped> {
        let mut configurations = scene.configurations();
        for (part, poses) in &moves {
            // They fitted when they were judged.
            _ = configurations.set(*part, poses.clone());
        }
        scene.check(question, stop, &configurations, execution)
    };
    let Answers { shape, values, status } = workers::execute(py, call, work)?;
    let numbers = |pair: &FoundPair| pair.parts.map(|part| part.index() as u32);
    let (offsets, pairs) = ragged(values.iter().map(|pairs| pairs.iter().map(numbers).collect()).collect());
    let (places, count) = (offsets.len(), pairs.len());
    let answer = (&shape[..], array(py, offsets, &[places])?, row_array(py, pairs, &[count])?);
    with_status(py, answer.into_pyobject(py)?.into_any(), tells_status.then_some(status), &shape)
}

/// The argument in which a part has its poses.
fn argument(name: &str) -> String {
    format!("poses[{name:?}]")
}

/// Returns the number of configurations.
///
/// # Errors
/// `InputError` if leading axes do not broadcast, or if a pose is invalid and the caller does not ask for a status.
fn judge(py: Python<'_>, scene: &Scene, moves: &[(PartId, Poses)], tells_status: bool) -> PyResult<usize> {
    let mut shape = Vec::new();
    let mut configurations = scene.configurations();
    for (part, poses) in moves {
        let name = argument(scene.name(*part));
        let common = Broadcast::new(&shape, poses.shape()).map_err(|_| {
            let message = format!("leading axes {:?} do not broadcast with {shape:?}, the others'", poses.shape());
            Fault::new("shape", &name, message).raised(py)
        })?;
        shape = common.shape().to_vec();
        let refused = |error: ConfigurationsError| PyMemoryError::new_err(error.to_string());
        configurations.set(*part, poses.clone()).map_err(refused)?;
    }
    match configurations.first_fault() {
        Some((part, row, error)) if !tells_status => {
            let (_, poses) = &moves[part.index()];
            Err(poses::fault(error, &argument(scene.name(part)), Broadcast::place(poses.shape(), row)).raised(py))
        }
        _ => Ok(configurations.rows()),
    }
}
