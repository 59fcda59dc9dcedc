//! BSP trees over the faces of a mesh, for many points and rays.

use std::sync::Arc;

use impinge::mesh::SolidBsp;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::mesh::mesh_of;
use crate::points::Points;
use crate::rays::{self, Rays};
use crate::workers::{self, Call};

/// The most points or rays for which a call keeps to the caller's thread.
const MOST_BRIEF: usize = 64;

/// What `impinge.SolidBsp` holds.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct SolidBspCore(Arc<SolidBsp>);

#[pymethods]
impl SolidBspCore {
    #[new]
    fn new(mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
        Ok(Self(Arc::new(workers::run(py, move |_| SolidBsp::build(&mesh))?)))
    }

    /// Cells, and planes from the root to the deepest one.
    fn size(&self) -> (usize, usize) {
        (self.0.cells(), self.0.depth())
    }

    /// (...) booleans.
    fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, tree) = (points.py(), self.0.clone());
        // In this range, no point is refused.
        let Points { shape, rows } = Points::read(points, "points", 128)?;
        let call = Call { rows: rows.len(), is_brief: rows.len() <= MOST_BRIEF, progress: false };
        let found =
            workers::rows(py, call, move |row| tree.contains(rows[row]).map(impinge::mesh::Containment::is_contained))?;
        let found = found.into_iter().collect::<Result<Vec<bool>, _>>();
        array(py, found.map_err(|error| PyRuntimeError::new_err(error.to_string()))?, &shape)
    }

    /// As `rays::ray_cast`.
    fn ray_cast<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, tree, rays) = (origins.py(), self.0.clone(), Rays::read(origins, directions)?);
        let (shape, brief) = (rays.lead().to_vec(), rays.len() <= MOST_BRIEF);
        let found = rays.ask_each(py, brief, move |origin, direction| {
            Ok(tree.ray_cast(&impinge::mesh::Ray::new(origin, direction)?))
        })?;
        rays::first_hits(py, found, &shape)
    }
}
