//! Queries of a world by moving shapes and by distances.

use impinge::Pose;
use impinge::query::{Distance, Proximity};
use impinge::sweep::{Impact, Motion, Sweep};
use impinge::world::{BodyDistance, BodyId, BodyImpact, World};
use pyo3::prelude::*;

use crate::arrays::{array, ragged};
use crate::distances;
use crate::motions::{motions_of, places};
use crate::poses;
use crate::shapes::read_shape;
use crate::world::WorldCore;
use crate::world_bodies::{Handles, ids, refused};
use crate::world_queries::{ask, found, on};

/// A shape, its motion, the clearance, and whether contact at the start is ignored.
type Moving<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, f64, bool);

/// Returns the body that a shape first touches on each of its motions, (...), which is 0 if it
/// touches none, and the impacts as `motions::places` returns them.
#[pyfunction]
pub(crate) fn world_shape_cast<'py>(
    world: &Bound<'py, WorldCore>,
    moving: Moving<'py>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let py = world.py();
    let (found, shape) =
        cast(world, moving, move |world, (shape, motion), sweep| world.shape_cast(shape, motion, sweep, on(layers)))?;
    let bodies = found.iter().map(|found| found.map_or(0, |found| found.body.to_bits())).collect();
    let impacts: Vec<Impact> = found.iter().map(|found| found.map_or(Impact::NEVER, |found| found.impact)).collect();
    Ok((array(py, bodies, &shape)?, places(py, &impacts, &shape)?).into_pyobject(py)?.into_any())
}

/// Returns the offsets of the bodies that a shape touches on each motion, the bodies, (k,), their
/// impacts as `motions::places` returns them, and the leading axes.
#[pyfunction]
pub(crate) fn world_shape_cast_all<'py>(
    world: &Bound<'py, WorldCore>,
    moving: Moving<'py>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let py = world.py();
    let (found, shape) = cast(world, moving, move |world, (shape, motion), sweep| {
        world.shape_cast_all(shape, motion, sweep, on(layers))
    })?;
    let (offsets, hits) = ragged(found);
    let (ends, count) = (offsets.len(), hits.len());
    let bodies = hits.iter().map(|found: &BodyImpact| found.body.to_bits()).collect();
    let impacts: Vec<Impact> = hits.iter().map(|found| found.impact).collect();
    let columns = (array(py, bodies, &[count])?, places(py, &impacts, &[count])?);
    Ok((array(py, offsets, &[ends])?, columns, shape).into_pyobject(py)?.into_any())
}

/// Returns the results of `of` for a shape and each of its motions, and the leading axes.
fn cast<A: Send + 'static>(
    world: &Bound<'_, WorldCore>,
    (shape, motion, clearance, ignore_touch): Moving<'_>,
    of: impl Fn(&World, (&impinge::Shape, &Motion), Sweep<'_>) -> Result<A, impinge::InputError> + Send + Sync + 'static,
) -> PyResult<(Vec<A>, Vec<usize>)> {
    let moving = read_shape(&shape, "shape", false)?.shape;
    let (lead, motions) = motions_of(&motion, "motion")?;
    let found = ask(world, "motion", &lead, motions, move |world, motion| {
        let sweep = Sweep::new().with_clearance(clearance);
        of(world, (&moving, motion), if ignore_touch { sweep.ignoring_touch() } else { sweep })
    })?;
    Ok((found, lead))
}

/// Returns the body that is nearest to a shape at each pose, (...), which is 0 if none is within
/// the limit, and the distances as `distances::columns` returns them, infinite if there is no body.
#[pyfunction]
pub(crate) fn world_nearest<'py>(
    world: &Bound<'py, WorldCore>,
    probe: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    limit: f64,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    const NONE: Distance =
        Distance { lower: f64::INFINITY, upper: f64::INFINITY, witness: None, proximity: Proximity::Apart };
    let py = world.py();
    let shape = read_shape(&probe.0, "shape", false)?.shape;
    let (lead, poses) = poses::read_all(&probe.1, "pose")?;
    let found =
        ask(world, "pose", &lead, poses, move |world, pose: &Pose| world.nearest(&shape, *pose, limit, on(layers)))?;
    let body = |found: &Option<BodyDistance>| found.map_or(0, |found| found.body.to_bits());
    let bodies = array(py, found.iter().map(body).collect(), &lead)?;
    let distances: Vec<Distance> = found.iter().map(|found| found.map_or(NONE, |found| found.distance)).collect();
    Ok((bodies, distances::columns(py, &distances, &lead)?).into_pyobject(py)?.into_any())
}

/// Returns the bodies within a clearance of a shape at each pose, (..., 4, 4), as
/// `world_queries::found` makes them. Undecided bodies are included.
#[pyfunction]
pub(crate) fn world_within<'py>(
    world: &Bound<'py, WorldCore>,
    probe: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    clearance: f64,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let shape = read_shape(&probe.0, "shape", false)?.shape;
    let (lead, poses) = poses::read_all(&probe.1, "pose")?;
    let hits =
        ask(world, "pose", &lead, poses, move |world, pose: &Pose| world.within(&shape, *pose, clearance, on(layers)))?;
    found(world.py(), hits, lead)
}

/// Returns the distances of pairs of bodies, whose handles alternate, as `distances::columns`
/// returns them, (n,).
#[pyfunction]
pub(crate) fn world_distances<'py>(world: &Bound<'py, WorldCore>, pairs: &Handles<'py>) -> PyResult<Bound<'py, PyAny>> {
    let (py, ids) = (world.py(), ids(pairs)?);
    let rows: Vec<[BodyId; 2]> = ids.as_chunks().0.to_vec();
    let shape = [rows.len()];
    let found = ask(world, "pairs", &shape, rows, |world, &[a, b]| Ok(world.distance(a, b)))?;
    let checked = found.into_iter().enumerate();
    let found: PyResult<Vec<Distance>> =
        checked.map(|(row, found)| found.map_err(|error| refused(&error, "pairs", row).raised(py))).collect();
    let found = found?;
    distances::columns(py, &found, &shape)
}
