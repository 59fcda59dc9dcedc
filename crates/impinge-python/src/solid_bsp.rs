//! BSP trees over the faces of a mesh, for queries of many points and rays.

use std::sync::Arc;

use impinge::mesh::SolidBsp;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::mesh::mesh_of;
use crate::points::Points;
use crate::rays::{Hits, Rays};
use crate::workers::{self, Call};

/// Maximum number of points or rays of a call that runs on the caller's thread.
const MAX_QUERIES_ON_CALLER: usize = 64;

/// Contents of `impinge.SolidBsp`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct SolidBspCore(Arc<SolidBsp>);

#[pymethods]
impl SolidBspCore {
    #[new]
    fn new(mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
        Ok(Self(Arc::new(workers::run(py, move |_| SolidBsp::build(&mesh))?)))
    }

    /// Returns the number of cells, and the number of planes from the root to the deepest cell.
    fn size(&self) -> (usize, usize) {
        (self.0.cells(), self.0.depth())
    }

    /// Reports whether the mesh contains each point of the mesh frame, as booleans of shape (...).
    fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, tree) = (points.py(), self.0.clone());
        // In this range every point is valid.
        let Points { shape, rows } = Points::read(points, "points", 128)?;
        let call = Call { rows: rows.len(), is_brief: rows.len() <= MAX_QUERIES_ON_CALLER, progress: false };
        let found =
            workers::rows(py, call, move |row| tree.contains(rows[row]).map(impinge::mesh::Containment::is_contained))?;
        let found = found.into_iter().collect::<Result<Vec<bool>, _>>();
        array(py, found.map_err(|error| PyRuntimeError::new_err(error.to_string()))?, &shape)
    }

    /// Returns the first hit of each ray, as `rays::ray_cast` does.
    fn ray_cast<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, tree, rays) = (origins.py(), self.0.clone(), Rays::read(origins, directions)?);
        let (shape, brief) = (rays.lead().to_vec(), rays.len() <= MAX_QUERIES_ON_CALLER);
        let found = rays.ask_each(py, brief, move |origin, direction| {
            Ok(tree.ray_cast(&impinge::mesh::Ray::new(origin, direction)?))
        })?;
        Hits::of(&found).first(py, &shape)
    }
}
