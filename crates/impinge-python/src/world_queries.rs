//! Queries of a world by rays, boxes, points and shapes.

use impinge::partition::Ray;
use impinge::query::batch::Broadcast;
use impinge::world::{BodyHit, BodyRayHit, RayOptions, Traits, World};
use impinge::{InputError, Pose};
use pyo3::prelude::*;

use crate::arrays::{array, ragged, row_array};
use crate::boxes::Boxes;
use crate::errors::{Fault, kind_and_place, message};
use crate::points::Points;
use crate::poses;
use crate::rays::Rays;
use crate::shapes::read_shape;
use crate::workers::{self, Call};
use crate::world::WorldCore;

/// Exponent of the magnitude below which coordinates must be, 2^128.
const EXPONENT: i32 = 128;

/// Rays as origins, directions, the reach of all, and whether they pass through backs of faces.
type RayArguments<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, f64, bool);

/// Returns whether each ray in the world frame hits a body, (...), and the columns of the hits.
/// Rays hit bodies on `layers`, up to `reach`.
#[pyfunction]
pub(crate) fn world_ray_cast<'py>(
    world: &Bound<'py, WorldCore>,
    rays: RayArguments<'py>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let py = world.py();
    let (found, shape) = cast(world, rays, move |world, ray, options| world.ray_cast_with(ray, options, on(layers)))?;
    let hit = array(py, found.iter().map(Option::is_some).collect(), &shape)?;
    Ok((hit, columns(py, found, &shape)?).into_pyobject(py)?.into_any())
}

/// Returns the offsets of the hits of each ray, columns with the hits of all rays, (k,), and the
/// leading axes.
#[pyfunction]
pub(crate) fn world_ray_cast_all<'py>(
    world: &Bound<'py, WorldCore>,
    rays: RayArguments<'py>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let py = world.py();
    let (found, shape) =
        cast(world, rays, move |world, ray, options| world.ray_cast_all_with(ray, options, on(layers)))?;
    let (offsets, hits) = ragged(found);
    let (places, count) = (offsets.len(), hits.len());
    let hits = columns(py, hits.into_iter().map(Some).collect(), &[count])?;
    Ok((array(py, offsets, &[places])?, hits, shape).into_pyobject(py)?.into_any())
}

/// Returns a filter for the bodies on some layers.
pub(crate) fn on(layers: u32) -> impl Fn(&Traits) -> bool {
    move |traits| traits.layers.on & layers != 0
}

/// Returns the results of `ask` for all rays, and the leading axes.
fn cast<'py, T: Send + 'static>(
    world: &Bound<'py, WorldCore>,
    (origins, directions, reach, culls_back_faces): RayArguments<'py>,
    ask: impl Fn(&World, &Ray, RayOptions) -> T + Send + Sync + 'static,
) -> PyResult<(Vec<T>, Vec<usize>)> {
    let (py, turn) = (world.py(), world.get().turn(world.py())?);
    if reach.is_nan() || reach < 0.0 {
        let kind = if reach.is_nan() { "non-finite" } else { "negative" };
        return Err(Fault::new(kind, "reach", format!("must be at least zero, not {reach}")).raised(py));
    }
    let rays = Rays::read(&origins, &directions)?;
    let lead = rays.lead().to_vec();
    let found = rays.ask_each(py, false, move |origin, direction| {
        let ray = Ray::new(origin, direction, reach)?;
        Ok(ask(&turn.read(), &ray, RayOptions { culls_back_faces }))
    })?;
    Ok((found, lead))
}

/// Returns the ray parameter t, (...), the body, (...), the point, (..., 3), the normal, (..., 3),
/// the part, (...), and the face, (...). A part or a face of -1, and NaN, stand for a missing one.
fn columns<'py>(py: Python<'py>, hits: Vec<Option<BodyRayHit>>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let t = hits.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect();
    let body = hits.iter().map(|hit| hit.map_or(0, |hit| hit.body.to_bits())).collect();
    let point = hits.iter().map(|hit| hit.map_or([0.0; 3], |hit| hit.point)).collect();
    let face = hits.iter().map(|hit| hit.and_then(|hit| hit.face).map_or(-1, i64::from)).collect();
    let normal = hits.iter().map(|hit| hit.and_then(|hit| hit.normal).unwrap_or([f64::NAN; 3])).collect();
    let part = hits.iter().map(|hit| hit.map_or(-1, |hit| i64::from(hit.part))).collect();
    let columns = (
        array(py, t, shape)?,
        array(py, body, shape)?,
        row_array(py, point, shape)?,
        row_array(py, normal, shape)?,
        array(py, part, shape)?,
        array(py, face, shape)?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}

/// Returns the offsets of the bodies found for each row, (n + 1,), handles, (k,), and the leading
/// axes.
pub(crate) fn found<'py>(py: Python<'py>, hits: Vec<Vec<BodyHit>>, shape: Vec<usize>) -> PyResult<Bound<'py, PyAny>> {
    let (offsets, hits) = ragged(hits);
    let (places, count) = (offsets.len(), hits.len());
    let bodies = array(py, hits.into_iter().map(|hit| hit.body.to_bits()).collect(), &[count])?;
    Ok((array(py, offsets, &[places])?, bodies, shape).into_pyobject(py)?.into_any())
}

/// Returns the results of `ask` for all rows.
///
/// # Errors
/// `InputError` for the first row of the argument that is out of range.
pub(crate) fn ask<T: Send + Sync + 'static, A: Send + 'static>(
    world: &Bound<'_, WorldCore>,
    argument: &str,
    shape: &[usize],
    rows: Vec<T>,
    ask: impl Fn(&World, &T) -> Result<A, InputError> + Send + Sync + 'static,
) -> PyResult<Vec<A>> {
    let (py, turn) = (world.py(), world.get().turn(world.py())?);
    let call = Call { rows: rows.len(), is_brief: false, progress: false };
    let found = workers::rows(py, call, move |row| ask(&turn.read(), &rows[row]))?;
    let checked = found.into_iter().enumerate().map(|(row, found)| {
        found.map_err(|error| {
            let at = Broadcast::place(shape, row);
            Fault::new(kind_and_place(&error).0, argument, message(&error)).at(at).hint(error.hint()).raised(py)
        })
    });
    checked.collect()
}

/// Returns the bodies that contain each point of the world frame, (..., 3), as `found` makes them.
#[pyfunction]
pub(crate) fn world_at_points<'py>(
    world: &Bound<'py, WorldCore>,
    points: &Bound<'py, PyAny>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let Points { shape, rows } = Points::read(points, "points", EXPONENT)?;
    let hits = ask(world, "points", &shape, rows, move |world, &point| world.at_point(point, on(layers)))?;
    found(world.py(), hits, shape)
}

/// Returns the bodies whose boxes overlap each box in the world frame, as `found` makes them. Lower
/// and upper corners have shape (..., 3).
#[pyfunction]
pub(crate) fn world_in_boxes<'py>(
    world: &Bound<'py, WorldCore>,
    low: &Bound<'py, PyAny>,
    high: &Bound<'py, PyAny>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let Boxes { shape, rows } = Boxes::read(low, Some(high), EXPONENT)?;
    let hits = ask(world, "high", &shape, rows, move |world, bounds| Ok(world.overlapping_boxes(bounds, on(layers))))?;
    found(world.py(), hits, shape)
}

/// Returns the bodies that intersect a shape at each pose, (..., 4, 4), as `found` makes them.
/// Undecided bodies are included.
#[pyfunction]
pub(crate) fn world_overlapping<'py>(
    world: &Bound<'py, WorldCore>,
    shape: &Bound<'py, PyAny>,
    poses: &Bound<'py, PyAny>,
    layers: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let probe = read_shape(shape, "shape", false)?.shape;
    let (shape, poses) = poses::read_all(poses, "pose")?;
    let hits =
        ask(world, "pose", &shape, poses, move |world, pose: &Pose| world.overlapping(&probe, *pose, on(layers)))?;
    found(world.py(), hits, shape)
}
