//! Many meshes at once: every configuration of an assembly, pair by pair.

use std::sync::Arc;

use impinge::{Mesh, Pose, query};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::broadcast::Broadcast;
use crate::errors::Fault;
use crate::mesh::mesh_of;
use crate::poses::{OnError, Poses};
use crate::question::{Progress, with_status};
use crate::workers::{self, Rows};

/// A part as Python names it: its name, its mesh and its poses.
type Part<'py> = (String, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Asks of each configuration which of `pairs`, places in `parts`, meet.
///
/// With `first`, the number of the first pair that meets in each configuration, or -1: (...). Otherwise whether each
/// pair meets: (..., p).
#[pyfunction]
pub(crate) fn check_scene<'py>(
    py: Python<'py>,
    parts: Vec<Part<'py>>,
    pairs: Vec<(usize, usize)>,
    first: bool,
    on_error: &Bound<'py, PyAny>,
    progress: Progress,
) -> PyResult<Bound<'py, PyAny>> {
    let (on_error, Progress(progress)) = (OnError::read(on_error)?, progress);
    let scene = Arc::new(Scene::read(py, &parts, pairs, on_error)?);
    let (shape, rows, pairs) = (scene.shape.clone(), scene.rows, scene.pairs.len());
    let status = (on_error == OnError::Status).then(|| (0..rows).map(|row| scene.status(row)).collect::<Vec<u8>>());

    let still: Vec<Option<bool>> = {
        let scene = scene.clone();
        let rows = Rows { count: pairs, brief: false, progress: false };
        workers::rows(py, rows, None, || (), move |(), pair| scene.still(pair))?
    };
    let meets = move |row: usize, pair: usize| still[pair].unwrap_or_else(|| scene.meets(row, pair));
    let answer = if first {
        let ask = move |(): &mut (), row| (0..pairs).find(|&pair| meets(row, pair)).map_or(-1, |pair| pair as i64);
        array(py, workers::rows(py, Rows { count: rows, brief: false, progress }, -1, || (), ask)?, &shape)?
    } else {
        let answers = rows.checked_mul(pairs).ok_or_else(|| PyMemoryError::new_err("too many configurations"))?;
        let asked = Rows { count: answers, brief: false, progress };
        let found = workers::rows(py, asked, true, || (), move |(), at| meets(at / pairs, at % pairs))?;
        array(py, found, &[&shape[..], &[pairs]].concat())?
    };
    with_status(py, answer, status, &shape)
}

struct Scene {
    meshes: Vec<Mesh>,
    poses: Vec<Poses>,
    pairs: Vec<(usize, usize)>,
    /// The leading axes of the configurations, and their number.
    shape: Vec<usize>,
    rows: usize,
    /// Which of a part's poses, the second operand, each configuration takes.
    places: Vec<Broadcast>,
}

impl Scene {
    fn read(py: Python<'_>, parts: &[Part<'_>], pairs: Vec<(usize, usize)>, on_error: OnError) -> PyResult<Self> {
        let mut meshes = Vec::with_capacity(parts.len());
        let mut poses = Vec::with_capacity(parts.len());
        let mut shape = Vec::new();
        for (name, mesh, given) in parts {
            meshes.push(mesh_of(mesh, name)?);
            let read = Poses::read(given, &format!("poses[{name:?}]"), on_error)?;
            let Some(common) = Broadcast::new(&shape, &read.shape) else {
                let message = format!("leading axes {:?} do not broadcast with {shape:?}, the others'", read.shape);
                return Err(Fault::new("shape", &format!("poses[{name:?}]"), message).raised(py));
            };
            shape = common.shape;
            poses.push(read);
        }
        let place = |poses: &Poses| Broadcast::new(&shape, &poses.shape);
        let places: Option<Vec<Broadcast>> = poses.iter().map(place).collect();
        let places = places.ok_or_else(|| PyMemoryError::new_err("too many configurations"))?;
        let rows = places.first().map_or(1, |place| place.rows);
        Ok(Self { meshes, poses, pairs, shape, rows, places })
    }

    /// The status of a configuration: that of the first of its parts with a bad pose.
    fn status(&self, row: usize) -> u8 {
        let of = |part: usize| {
            self.poses[part].status.as_ref().map_or(0, |status| status[self.places[part].sources(row)[1]])
        };
        (0..self.poses.len()).map(of).find(|&status| status != 0).unwrap_or(0)
    }

    /// The answer of a pair that is the same in all configurations.
    fn still(&self, pair: usize) -> Option<bool> {
        let (a, b) = self.pairs[pair];
        let stands =
            |part: usize| matches!(self.poses[part], Poses { ref poses, status: None, .. } if poses.len() == 1);
        (stands(a) && stands(b)).then(|| self.ask(a, b, self.poses[a].poses[0], self.poses[b].poses[0]))
    }

    /// Whether a pair meets; where a pose of either part is bad, the safe answer.
    fn meets(&self, row: usize, pair: usize) -> bool {
        let (a, b) = self.pairs[pair];
        let [at_a, at_b] = [a, b].map(|part| self.places[part].sources(row)[1]);
        let is_bad = |part: usize, at: usize| self.poses[part].status.as_ref().is_some_and(|status| status[at] != 0);
        is_bad(a, at_a) || is_bad(b, at_b) || self.ask(a, b, self.poses[a].poses[at_a], self.poses[b].poses[at_b])
    }

    fn ask(&self, a: usize, b: usize, world_from_a: Pose, world_from_b: Pose) -> bool {
        query::intersects(self.meshes[a].at(world_from_a), self.meshes[b].at(world_from_b))
    }
}
