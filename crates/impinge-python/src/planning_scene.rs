//! The obstacles of a planning scene.

use std::path::PathBuf;

use impinge::Shape;
use impinge::scene::PartId;
use impinge_files::{Limits, PlanningScene, PlanningSceneOptions, load_planning_scene};
use pyo3::prelude::*;

use crate::arrays::row_array;
use crate::errors::load_error;
use crate::motions::matrix;
use crate::workers;

/// Obstacles of a file, with their shapes built.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct PlanningSceneFile {
    asked: Asked,
    loaded: PlanningScene,
}

/// Arguments of the constructor, of which a pickle consists.
type Asked = (PathBuf, Vec<(String, PathBuf)>, Option<String>, Option<u64>, Option<u64>);

#[pymethods]
impl PlanningSceneFile {
    /// Reads a file. `packages` are names with folders, and `frame` is the frame of the scene.
    #[new]
    #[pyo3(signature = (path, packages, frame, max_bytes, max_triangles))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        packages: Vec<(String, PathBuf)>,
        frame: Option<String>,
        max_bytes: Option<u64>,
        max_triangles: Option<u64>,
    ) -> PyResult<Self> {
        let mut limits = Limits::default();
        (limits.max_bytes, limits.max_triangles) = (max_bytes, max_triangles);
        let asked = (path.clone(), packages.clone(), frame.clone(), max_bytes, max_triangles);
        let options = PlanningSceneOptions { packages, frame, limits };
        let loaded = workers::run(py, move |_| load_planning_scene(&path, &options))?;
        Ok(Self { asked, loaded: loaded.map_err(|error| load_error(py, &error))? })
    }

    fn __getnewargs__(&self) -> Asked {
        self.asked.clone()
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        self.parts().map(|part| self.loaded.scene.name(part)).collect()
    }

    /// Returns the poses of the parts, (n, 4, 4).
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let matrices: Vec<[f64; 16]> = self.parts().map(|part| matrix(self.loaded.scene.pose(part))).collect();
        let count = matrices.len();
        row_array(py, matrices, &[count])?.call_method1("reshape", (count, 4, 4))
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.loaded.warnings.iter().map(ToString::to_string).collect()
    }
}

impl PlanningSceneFile {
    fn parts(&self) -> impl Iterator<Item = PartId> {
        self.loaded.scene.parts()
    }

    /// Returns the shape of a part, or `None` if there is no such part.
    pub(crate) fn shape(&self, part: usize) -> Option<&Shape> {
        Some(self.loaded.scene.shape(self.parts().nth(part)?))
    }
}
