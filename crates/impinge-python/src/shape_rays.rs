//! Rays against one shape.

use impinge::partition;
use impinge::world::{Body, World};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::rays::Rays;
use crate::shapes::{Weighed, weighed};
use crate::world_bodies::refused;

/// The most rays times pieces for which a call may keep to the caller's thread.
const MOST_BRIEF_RAYS: u64 = 1 << 12;

/// Whether each ray meets the shape, where, (...), on which face of a mesh, (...), and in which point, (..., 3).
#[pyfunction]
pub(crate) fn shape_ray_cast<'py>(
    shape: &Bound<'py, PyAny>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, rays) = (shape.py(), Rays::read(origins, directions)?);
    let Weighed { shape, weight } = weighed(shape, "shape", false)?;
    let mut world = World::new();
    world.insert(Body::new(shape)).map_err(|error| refused(&error, "shape", 0).at(Vec::new()).raised(py))?;
    let (lead, brief) = (rays.lead().to_vec(), weight.saturating_mul(rays.len() as u64) <= MOST_BRIEF_RAYS);
    let found = rays.ask_each(py, brief, move |origin, direction| {
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
