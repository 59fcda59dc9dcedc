//! Rays against one shape.

use impinge::partition;
use impinge::world::{Body, World};
use pyo3::prelude::*;

use crate::arrays::{numbers, row_array};
use crate::rays::Rays;
use crate::shapes::{WeighedShape, read_shape};
use crate::world_bodies::refused;

/// Maximum number of rays times pieces of a call that runs on the caller's thread.
const MAX_WORK_ON_CALLER: u64 = 1 << 12;

/// Returns whether each ray hits the shape, (...), the ray parameter t, (...), the face if the
/// shape is a mesh, else -1, (...), and the point, (..., 3). Rays and points are in the frame of
/// the shape.
#[pyfunction]
pub(crate) fn shape_ray_cast<'py>(
    shape: &Bound<'py, PyAny>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, rays) = (shape.py(), Rays::read(origins, directions)?);
    let WeighedShape { shape, weight } = read_shape(shape, "shape", false)?;
    let mut world = World::new();
    world.insert(Body::new(shape)).map_err(|error| refused(&error, "shape", 0).at(Vec::new()).raised(py))?;
    let (lead, brief) = (rays.lead().to_vec(), weight.saturating_mul(rays.len() as u64) <= MAX_WORK_ON_CALLER);
    let found = rays.ask_each(py, brief, move |origin, direction| {
        Ok(world.ray_cast(&partition::Ray::new(origin, direction, f64::INFINITY)?, |_| true))
    })?;
    let columns = (
        numbers(py, found.iter().map(Option::is_some).collect(), &lead)?,
        numbers(py, found.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect(), &lead)?,
        numbers(py, found.iter().map(|hit| hit.and_then(|hit| hit.face).map_or(-1, i64::from)).collect(), &lead)?,
        row_array(py, found.iter().map(|hit| hit.map_or([0.0; 3], |hit| hit.point)).collect(), &lead)?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}
