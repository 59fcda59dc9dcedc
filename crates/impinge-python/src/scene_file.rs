//! The parts of a file: shared meshes, poses and details.

use std::path::PathBuf;

use impinge::{Mesh, Positions};
use impinge_files::{Format, Limits, SceneModel, SceneOptions, ScenePart, Unit, Warning, load_scene};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::errors::load_error;
use crate::mesh::MeshBase;
use crate::model::unit_of;
use crate::workers;

/// The parts of a file, with their meshes built.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct SceneFile {
    meshes: Vec<SharedMesh>,
    parts: Vec<ScenePart>,
    unit: Option<Unit>,
    format: Format,
    warnings: Vec<Warning>,
}

/// A mesh that parts share.
struct SharedMesh {
    mesh: Mesh,
    is_double: bool,
    /// For each face, the index of its polygon.
    sources: Vec<u32>,
}

/// Key, type, path and further properties of a part.
type Details = (String, String, Vec<String>, Vec<(String, String)>);

#[pymethods]
impl SceneFile {
    /// Reads a file and builds its meshes, each of them once. `units` are that of the scene and
    /// that of the numbers in the file. Lengths are converted, and then `origin` is subtracted.
    /// `names` is the path of a file with names.
    #[new]
    #[pyo3(signature = (path, units, origin, names, max_bytes=None, max_triangles=None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        units: (Option<&str>, Option<&str>),
        origin: Option<[f64; 3]>,
        names: Option<PathBuf>,
        max_bytes: Option<u64>,
        max_triangles: Option<u64>,
    ) -> PyResult<Self> {
        let mut limits = Limits::default();
        (limits.max_bytes, limits.max_triangles) = (max_bytes, max_triangles);
        let options =
            SceneOptions { unit: unit_of(py, units.0)?, file_unit: unit_of(py, units.1)?, origin, names, limits };
        let loaded = workers::run(py, move |_| {
            let mut model = load_scene(path, &options)?;
            let kept = |mesh: &mut impinge_files::SceneMesh| {
                (matches!(mesh.positions, Positions::F64(_)), std::mem::take(&mut mesh.sources))
            };
            let kept: Vec<(bool, Vec<u32>)> = model.meshes.iter_mut().map(kept).collect();
            Ok((model.take_meshes()?, kept, model))
        })?;
        let (meshes, kept, model) = loaded.map_err(|error| load_error(py, &error))?;
        let SceneModel { parts, unit, warnings, format, .. } = model;
        let shared = |(mesh, (is_double, sources))| SharedMesh { mesh, is_double, sources };
        let meshes = meshes.into_iter().zip(kept).map(shared).collect();
        Ok(Self { meshes, parts, unit, format, warnings })
    }

    /// Returns the meshes, each with the polygon of each face, (m,).
    #[getter]
    fn meshes<'py>(&self, py: Python<'py>) -> PyResult<Vec<(MeshBase, Bound<'py, PyAny>)>> {
        let mesh = |shared: &SharedMesh| {
            let sources = array(py, shared.sources.clone(), &[shared.sources.len()])?;
            Ok((MeshBase::in_precision(&shared.mesh, shared.is_double), sources))
        };
        self.meshes.iter().map(mesh).collect()
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        self.parts.iter().map(|part| &*part.name).collect()
    }

    /// Returns the index of the mesh of each part.
    #[getter]
    fn mesh_of(&self) -> Vec<usize> {
        self.parts.iter().map(|part| part.mesh).collect()
    }

    /// Returns the poses of the parts, (n, 4, 4).
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let matrix = |part: &ScenePart| {
            let (linear, translation) = (part.world_from_part.linear(), part.world_from_part.translation());
            let row = |k: usize| [linear[k][0], linear[k][1], linear[k][2], translation[k]];
            [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
        };
        let rows = self.parts.iter().flat_map(matrix);
        row_array(py, rows.collect(), &[self.parts.len(), 4])
    }

    /// Returns key, type, path and further properties of each part.
    #[getter]
    fn details(&self) -> Vec<Details> {
        let details = |part: &ScenePart| {
            let impinge::scene::Details { key, kind, path, extras } = part.details.clone();
            (key, kind, path, extras)
        };
        self.parts.iter().map(details).collect()
    }

    #[getter]
    fn format(&self) -> String {
        self.format.to_string()
    }

    #[getter]
    fn unit(&self) -> Option<&'static str> {
        self.unit.map(Unit::symbol)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.iter().map(Warning::to_string).collect()
    }
}
